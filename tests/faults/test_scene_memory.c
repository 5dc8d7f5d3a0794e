/* Scenes, photons, policies, images and methods when memory runs out at any moment: one allocation after the other
 * refused. */
#include "../../cases/scenes/list.h"
#include "../../src/image/image.h"
#include "../../src/image/png.h"
#include "../../src/methods/progressive/progressive.h"
#include "../../src/methods/render.h"
#include "../policies.h"
#include "allocation.h"

#include <OpenEXR/openexr.h>
#include <string.h>

/* ---- Scenes ------------------------------------------------------------------------------------ */

static pm_status open_stage(void *context, uint64_t *digest, pm_error *error)
{
    pm__stage stage = {0};
    const pm_status status = pm__stage_open(context, NULL, 8, 8, &stage, error);
    if (status == PM_OK) {
        const size_t objects = pm__scene_object_count(stage.scene), lights = pm__scene_light_count(stage.scene);
        pm__digest(digest, &objects, sizeof objects);
        pm__digest(digest, &lights, sizeof lights);
        for (size_t i = 0; i < objects; i++) {
            const pm__object object = pm__scene_object(stage.scene, i);
            pm__digest(digest, object.low, sizeof object.low + sizeof object.high);
        }
    }
    pm__stage_close(&stage);
    return status;
}

/* Every scene that there is, with its defaults. */
START_TEST(scenes)
{
    pm__all_below = 20; /* some are cut into thousands of triangles */
    for (size_t i = 0; i < pm__scene_cases.count; i++) {
        pm__spec spec;
        pm__spec_default(pm__scene_cases.entries[i], &spec);
        pm__each_refusal(spec.entry->name, open_stage, &spec);
    }
}
END_TEST

/* ---- Photons ----------------------------------------------------------------------------------- */

static pm_status shoot(void *context, uint64_t *digest, pm_error *error)
{
    pm__photon_set set;
    const pm_status status = pm__shoot(context, &set, error);
    PM_MUST(status == PM_OK || (!set.photons && !set.normals && !set.count));
    pm__digest(digest, set.photons, set.count * sizeof *set.photons);
    pm__photon_set_free(&set);
    return status;
}

static pm_status shoot_shadows(void *context, uint64_t *digest, pm_error *error)
{
    pm__photon_set set;
    unsigned char *shadow = NULL;
    const pm_status status = pm__shoot_shadows(context, 0, &set, &shadow, error);
    PM_MUST(status == PM_OK || (!set.photons && !shadow));
    pm__digest(digest, shadow, status == PM_OK ? set.count : 0);
    pm__photon_set_free(&set);
    free(shadow);
    return status;
}

static pm_status project(void *context, uint64_t *digest, pm_error *error)
{
    pm__projection *made = NULL;
    const pm_status status = pm__projection_create(context, true, &made, error);
    PM_MUST(status == PM_OK || !made);
    const double share = made ? pm__projection_share(made, 0) : 0.0;
    pm__digest(digest, &share, sizeof share);
    pm__projection_destroy(made);
    return status;
}

START_TEST(photons)
{
    policed p = policed_room();
    pm__shoot_config config = {.scene = p.scene, .seed = 3, .count = 300, .emitted = true, .normals = true};
    pm__each_refusal("photons emitted", shoot, &config);
    pm__each_refusal("shadow photons", shoot_shadows, &config);
    config.emitted = false;
    pm__each_refusal("photons stored", shoot, &config);
    pm__each_refusal("a projection map", project, p.scene);
    policed_free(&p);
}
END_TEST

static pm_status find_importance(void *context, uint64_t *digest, pm_error *error)
{
    pm__importance *made = NULL;
    const pm_status status = pm__importance_create(context, &made, error);
    PM_MUST(status == PM_OK || !made);
    const double mean = made ? pm__importance_mean(made, PM__GLOBAL_MAP) : 0.0;
    pm__digest(digest, &mean, sizeof mean);
    pm__importance_destroy(made);
    return status;
}

START_TEST(importance)
{
    static const pm__view view = {{0.0, 0.0, 0.4}, {0.3, 0.0, -0.9}, {0.0, 1.0, 0.0}, 0.5};
    policed p = policed_room();
    pm__camera camera;
    pm_error error;
    PM_CHECK_OK(pm__camera_init(&view, 16, 16, &camera, &error), error);
    pm__importance_config config = {.scene = p.scene, .camera = &camera, .width = 16, .height = 16, .paths = 256,
                                    .bounces = 1, .nearest = 20, .share = 0.5, .outlier = 100.0, .seed = 17};
    for (int measure = PM__OF_SCREEN; measure <= PM__OF_BOTH; measure++) {
        config.measure = (pm__measure)measure;
        pm__each_refusal("importance", find_importance, &config);
    }
    policed_free(&p);
}
END_TEST

static pm_status store(void *context, uint64_t *digest, pm_error *error)
{
    pm__stored_photons set;
    const pm_status status = pm__store_photons(context, &set, error);
    PM_MUST(status == PM_OK || (!set.photons && !set.normals && !set.count));
    pm__digest(digest, set.photons, set.count * sizeof *set.photons);
    pm__stored_photons_free(&set);
    return status;
}

START_TEST(policies)
{
    policed p = policed_room();
    for (size_t i = 0; i < pm__policies.count; i++)
        for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
            pm__all_below = kind == PM__CAUSTIC_MAP ? 20 : 250; /* with a projection map, which takes its time */
            pm__each_part = kind == PM__CAUSTIC_MAP ? 8 : 80;
            pm__spec spec;
            pm__spec_default(pm__policies.entries[i], &spec);
            pm__storing_config config = {.scene = p.scene, .kind = (pm__map_kind)kind, .policy = &spec,
                                         .importance = p.importance, .seed = 5, .emitted = 60, .stored = SIZE_MAX};
            pm__each_refusal(spec.entry->name, store, &config);
        }
    policed_free(&p);
}
END_TEST

/* ---- Methods ----------------------------------------------------------------------------------- */

static pm_status render(void *context, uint64_t *digest, pm_error *error)
{
    pm__render_result result;
    const pm_status status = pm__render(context, &result, error);
    for (size_t i = 0; i < result.count && status == PM_OK; i++) {
        const pm__image *const image = &result.images[i].radiance;
        pm__digest(digest, image->values, image->width * image->height * 3 * sizeof *image->values);
    }
    pm__render_free(&result);
    return status;
}

static void check_render(const char *scene, const char *method, bool aov)
{
    pm_error error;
    pm__spec of_scene, of_method;
    pm_estimator *estimators[2] = {NULL, NULL};
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, scene, &of_scene, &error), error);
    PM_CHECK_OK(pm__spec_parse(&pm__methods, method, &of_method, &error), error);
    PM_CHECK_OK(pm_estimator_create("disc", &estimators[0], &error), error);
    PM_CHECK_OK(pm_estimator_create("precomputed", &estimators[1], &error), error);
    pm__render_config config = {.scene = &of_scene, .method = &of_method,
                                .estimators = (const pm_estimator *const *)estimators, .estimator_count = 2, .k = 5,
                                .radius = INFINITY, .photons = 40, .width = 4, .height = 4, .spp = 1,
                                .trials = aov ? 2 : 1, .seed = 1, .aov = aov};
    pm__each_refusal(method, render, &config);
    pm_estimator_destroy(estimators[0]);
    pm_estimator_destroy(estimators[1]);
}

START_TEST(renders)
{
    check_render("scene:plate", "visualize", true);
    check_render("scene:cornell", "visualize", false);
    check_render("scene:cornell", "path", true);
    pm__all_below = 20; /* projection maps */
    pm__each_part = 4;
    check_render("scene:water", "full", false);
}
END_TEST

static bool by_photons; /* photons seek the points, not points photons */

static pm_status progress(void *context, uint64_t *digest, pm_error *error)
{
    pm__progressive_config *const config = context;
    double radiance[16][3];
    pm__progression all = {0};
    pm_status status = pm__progression_open(config, &all, error);
    if (status != PM_OK)
        return status;
    all.meeting.by_photons = by_photons;
    pm__run run = {0};
    status = pm__run_begin(&all, 0, &run, error);
    if (status == PM_OK) {
        for (int pass = 0; pass < 3 && status == PM_OK; pass++)
            status = pm__run_pass(&run, error);
        if (status == PM_OK)
            status = pm__run_read(&run, radiance, error);
        pm__run_end(&run);
    }
    pm__progression_close(&all);
    if (status == PM_OK)
        pm__digest(digest, radiance, sizeof radiance);
    return status;
}

START_TEST(progressive_methods)
{
    pm_error error;
    pm__spec scene, method;
    pm_estimator *disc;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, "scene:plate", &scene, &error), error);
    PM_CHECK_OK(pm_estimator_create("disc", &disc, &error), error);
    for (size_t i = 0; i < pm__progressives.count; i++)
        for (int estimates = 0; estimates < 2; estimates++) {
            pm__spec_default(pm__progressives.entries[i], &method);
            pm__progressive_config config = {.scene = &scene, .width = 4, .height = 4, .method = &method,
                                             .estimator = disc, .alpha = 0.667, .k = 5, .photons = 50,
                                             .seed = 1, .estimates = estimates == 1};
            const pm__progressive *const of = (const pm__progressive *)(const void *)method.entry;
            const bool can = !estimates || (of->averages && of->averages(method.values));
            for (by_photons = false; can; by_photons = true) {
                pm__each_refusal(method.entry->name, progress, &config);
                if (by_photons || !of->summed)
                    break;
            }
        }
    pm_estimator_destroy(disc);
}
END_TEST

/* ---- Images ------------------------------------------------------------------------------------ */

static char bytes[1 << 16];
static size_t size;

static pm_status write_exr(void *context, uint64_t *digest, pm_error *error)
{
    static const pm__attribute attributes[] = {{"command", "photonbench", 0.0}, {"seed", NULL, 1.0}};
    FILE *const file = __real_fopen("/dev/null", "wb");
    (void)digest;
    const pm_status status = pm__exr_write(file, context, false, attributes, 2, error);
    (void)fclose(file);
    return status;
}

static pm_status read_exr(void *context, uint64_t *digest, pm_error *error)
{
    pm__image image;
    (void)context;
    const pm_status status = pm__exr_read_memory(bytes, size, "image", &image, error);
    PM_MUST(status == PM_OK || !image.values);
    pm__digest(digest, image.values, image.width * image.height * (size_t)image.channels * sizeof *image.values);
    pm__image_free(&image);
    return status;
}

START_TEST(images)
{
    pm__image image;
    pm_error error;
    PM_CHECK_OK(pm__image_create(20, 40, 3, &image, &error), error);
    for (size_t i = 0; i < 20 * 40 * 3; i++)
        image.values[i] = (float)i;
    exr_set_default_memory_routines(__wrap_malloc, __wrap_free);
    pm__each_refusal("writing EXR", write_exr, &image);
    exr_set_default_memory_routines(NULL, NULL);
    FILE *const file = tmpfile();
    PM_CHECK_OK(pm__exr_write(file, &image, false, NULL, 0, &error), error);
    rewind(file);
    size = fread(bytes, 1, sizeof bytes, file);
    (void)fclose(file);
    pm__each_refusal("reading EXR", read_exr, NULL);
    pm__image_free(&image);
}
END_TEST

PM_TEST_MAIN("memory of scenes", scenes, photons, importance, policies, renders, progressive_methods, images)
