/* Image files of `storage`: densities as numbers (OpenEXR) and in false colour (PNG). */
#include "commands.h"
#include "file_names.h"
#include "storage_task.h"
#include "version.h"

#include "../base/memory.h"
#include "../image/false_colour.h"
#include "../image/png.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 400 };

static const struct {
    const char *suffix, *content;
} kinds[] = {
    [PM__REQUIRED_DENSITY] = {"required", "required density of photons, 1/m2"},
    [PM__ACTUAL_DENSITY] = {"actual", "density of stored photons, by the 20 nearest, 1/m2"},
    [PM__CONVERGENCE] = {"convergence", "C(x) = D_c / D_r (L_g / L_c)^3"},
};

/* NAME.SCENE.MAP[.POLICY].KIND.EXTENSION; NULL: out of memory. */
static char *path_of(const pm__storage_task *task, const pm__storage_scene *scene, const pm__density_image *image,
                     const char *extension)
{
    const char *const given = task->settings->output;
    char scene_name[PM__MAX_SPEC], policy[PM__MAX_SPEC] = "", *path = NULL;
    pm__safe_name(scene->scene, scene_name, sizeof scene_name);
    if (image->policy)
        pm__safe_name(image->policy, policy, sizeof policy);
    const int length = asprintf(&path, "%.*s.%s.%s%s%s.%s.%s", pm__stem_length(given), given, scene_name,
                                pm__map_names[image->map], *policy ? "." : "", policy, kinds[image->kind].suffix,
                                extension);
    return length < 0 ? NULL : path;
}

pm_status pm__storage_files_check(const pm__storage_task *task, pm_error *error)
{
    const pm__density_image any = {.kind = PM__ACTUAL_DENSITY};
    pm__sink sink;
    if (!task->settings->output)
        return PM_OK;
    char *const path = path_of(task, &task->scenes[0], &any, "exr");
    pm_status status = path ? pm__sink_open(path, &sink, error) : pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK)
        pm__sink_discard(&sink);
    free(path);
    return status;
}

/* Blue: as dense as required; green: other light hides the error; red: more photons are needed ([C02] 3; Suykens and
 * Willems 2000, figure 6). */
static pm_status colour_classes(const pm__density_image *image, pm__picture *picture, pm_error *error)
{
    static const uint8_t black[3] = {0, 0, 0}, blue[3] = {40, 80, 255}, green[3] = {0, 180, 0}, red[3] = {230, 0, 0};
    const size_t width = image->image.width, height = image->image.height;
    uint8_t(*const colours)[3] = pm__alloc(width * height, sizeof *colours);
    if (!colours)
        return pm__fail(error, PM_ENOMEM, "out of memory for a picture");
    for (size_t p = 0; p < width * height; p++) {
        const float c = image->image.values[p];
        memcpy(colours[p], isnan(c) ? black : image->reached.values[p] >= 1.0F ? blue : c > 1.0F ? green : red, 3);
    }
    const pm_status status = pm__colour_plain((const uint8_t(*)[3])colours, width, height, picture, error);
    free(colours);
    return status;
}

static pm_status colour(const pm__density_image *image, double low, double high, pm__picture *picture, char text[TEXT],
                        pm_error *error)
{
    if (image->kind == PM__CONVERGENCE) {
        (void)snprintf(text, TEXT, "%s. Blue: as dense as required; green: above 1; red: more photons are needed; "
                                   "black: no caustic", kinds[image->kind].content);
        return colour_classes(image, picture, error);
    }
    (void)snprintf(text, TEXT, "%s. Logarithmic, %g dark blue to %g red; dark grey: 0; black: nothing is seen",
                   kinds[image->kind].content, low, high);
    return pm__colour_scale(&image->image, low, high, picture, error);
}

static pm_status write_exr(FILE *file, const pm__storage_task *task, const pm__storage_scene *scene,
                           const pm__density_image *image, pm_error *error)
{
    char name[PM__MAX_SPEC], policy[PM__MAX_SPEC], seed[24];
    pm__spec_format(scene->scene, name, sizeof name);
    (void)snprintf(seed, sizeof seed, "%llu", (unsigned long long)task->settings->seed);
    pm__attribute list[8] = {{"software", "photonbench " PM_VERSION, 0.0},
                             {"command", task->settings->command_line, 0.0},
                             {"seed", seed, 0.0},
                             {"scene", name, 0.0},
                             {"map", pm__map_names[image->map], 0.0},
                             {"content", kinds[image->kind].content, 0.0}};
    size_t count = 6;
    if (image->policy) {
        pm__spec_format(image->policy, policy, sizeof policy);
        list[count++] = (pm__attribute){"policy", policy, 0.0};
    }
    return pm__exr_write(file, &image->image, false, list, count, error);
}

static pm_status write_png(FILE *file, const pm__storage_scene *scene, const pm__density_image *image, double low,
                           double high, pm_error *error)
{
    char name[PM__MAX_SPEC], text[TEXT];
    pm__picture picture = {0};
    pm__spec_format(scene->scene, name, sizeof name);
    pm_status status = colour(image, low, high, &picture, text, error);
    if (status == PM_OK)
        status = pm__png_write(file, (const uint8_t(*)[3])picture.pixels, picture.width, picture.height, name, text,
                               error);
    pm__picture_free(&picture);
    return status;
}

static pm_status write_image(const pm__storage_task *task, const pm__storage_scene *scene,
                             const pm__density_image *image, bool png, double low, double high, pm_error *error)
{
    pm__sink sink = {.wanted = false};
    char *const path = path_of(task, scene, image, png ? "png" : "exr");
    pm_status status = path ? pm__sink_open(path, &sink, error) : pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK) {
        FILE *const file = pm__sink_file(&sink);
        status = png ? write_png(file, scene, image, low, high, error) : write_exr(file, task, scene, image, error);
        if (status == PM_OK)
            status = pm__sink_close(&sink, error);
        else
            pm__sink_discard(&sink);
    }
    free(path);
    return status;
}

/* One scale for all densities of a map, so that they can be compared: that of the required one, else of the first. */
static void range_of(const pm__storage_result *r, pm__map_kind map, double *low, double *high)
{
    const pm__density_image *chosen = NULL;
    for (size_t i = 0; i < r->image_count; i++)
        if (r->images[i].map == map && r->images[i].kind != PM__CONVERGENCE &&
            (!chosen || r->images[i].kind == PM__REQUIRED_DENSITY))
            chosen = &r->images[i];
    *low = 1.0;
    *high = 10.0;
    if (chosen)
        pm__colour_range(&chosen->image, low, high);
}

pm_status pm__storage_files_write(const pm__storage_task *task, const pm__storage_scene *scene, pm_error *error)
{
    const pm__storage_result *const r = &scene->result;
    pm_status status = PM_OK;
    for (size_t i = 0; i < 2 * r->image_count && status == PM_OK; i++) {
        double low, high;
        range_of(r, r->images[i / 2].map, &low, &high);
        status = write_image(task, scene, &r->images[i / 2], i % 2, low, high, error);
    }
    return status;
}
