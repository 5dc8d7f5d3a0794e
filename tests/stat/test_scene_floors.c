/* Truths hold wherever a renderer may look, not only where probes lie: photons of a scene counted in the cells of its
 * floor, against the truth's integral; and the furnace, which may lose nothing.
 *
 * Counts are compared by Anscombe's 2 sqrt(n + 3/8), within 6.5 of its standard deviations: a false alarm once in 1e10
 * cells, of some 2000. */
#include "../test.h"

#include "../../cases/scenes/list.h"
#include "../../src/transport/trace.h"

#include <string.h>

enum { CELLS = 16, EMITTED = 300000 };

static const double pi = 3.14159265358979323846;

typedef struct patch {
    const char *spec;
    double x0, x1, y0, y1, z;
    int least; /* of cells that must have been compared: elsewhere the truth is too steep */
} patch;

static const patch patches[] = {
    {"scene:point-light", -4, 4, -4, 4, 0, 200},
    {"scene:rect-light:width=2,height=0.5", -1.75, 1.75, -1.25, 1.25, 0, 200},
    {"scene:glass-sphere", -2.5, 2.5, -2.5, 2.5, -2, 60},
    {"scene:glass-sphere:d=1.2", -2, 2, -2, 2, -1.2, 20},
    {"scene:nephroid", -3, 1.2, -1.6, 1.6, 0, 80},
    {"scene:nephroid:elevation=30,height=4", -3, 1.2, -1.6, 1.6, 0, 80},
    {"scene:cardioid", -0.7, 0.7, -0.7, 0.7, 0, 40},
    {"scene:plate", -4, 4, -4, 4, 0, 100},
    {"scene:water", -4, 4, -4, 4, 0, 100},
    {"scene:pool", -1.6, 1.6, -1.6, 1.6, 0, 60},
    {"scene:pool:d=2.5", -1.6, 1.6, -1.6, 1.6, 0, 40},
    {"scene:prism", 1.95, 2.4, -0.12, 0.12, 0, 20},
};

typedef struct tally {
    const patch *where;
    double (*count)[CELLS][CELLS]; /* [band]: photons */
    double power[3];               /* W, of each photon in the bands that it has: with all emitted */
    size_t stored;
} tally;

static bool store(void *context, uint64_t number, const pm__stored *photon)
{
    (void)number;
    tally *const t = context;
    const patch *const p = t->where;
    const double x = (photon->position[0] - p->x0) / (p->x1 - p->x0);
    const double y = (photon->position[1] - p->y0) / (p->y1 - p->y0);
    t->stored++;
    for (int b = 0; b < 3; b++) {
        if (!(photon->power[b] > 0.0))
            continue;
        t->power[b] = photon->power[b];
        if (x >= 0.0 && x < 1.0 && y >= 0.0 && y < 1.0)
            t->count[b][(int)(x * CELLS)][(int)(y * CELLS)] += 1.0;
    }
    return true;
}

/* The truth at (x, y) of the cell, each 0 to 1. */
static void truth_in(const pm__spec *spec, const patch *p, int i, int j, double x, double y, double bands[3])
{
    const pm__case *const c = (const pm__case *)(const void *)spec->entry;
    const double w = (p->x1 - p->x0) / CELLS, h = (p->y1 - p->y0) / CELLS;
    const pm__probe at = {.position = {p->x0 + w * (i + x), p->y0 + h * (j + y), p->z}, .normal = {0, 0, 1}};
    if (c->truth_bands)
        c->truth_bands(spec->values, &at, bands);
    else
        bands[0] = bands[1] = bands[2] = c->truth(spec->values, &at);
}

/* Power on the cell, W, by midpoints. */
static void integrate(const pm__spec *spec, const patch *p, int i, int j, int points, double power[3])
{
    const double area = (p->x1 - p->x0) * (p->y1 - p->y0) / (CELLS * CELLS);
    power[0] = power[1] = power[2] = 0.0;
    for (int a = 0; a < points; a++)
        for (int b = 0; b < points; b++) {
            double bands[3];
            truth_in(spec, p, i, j, (a + 0.5) / points, (b + 0.5) / points, bands);
            for (int band = 0; band < 3; band++)
                power[band] += bands[band] * area / (points * points);
        }
}

/* Light may end between a dark cell's points: then a corner has it. */
static bool is_dark(const pm__spec *spec, const patch *p, int i, int j, int band)
{
    bool dark = true;
    for (int corner = 0; corner < 4; corner++) {
        double bands[3];
        truth_in(spec, p, i, j, corner & 1, corner >> 1, bands);
        dark = dark && bands[band] == 0.0;
    }
    return dark;
}

/* 1 where the cell could be compared. */
static int check_cell(const tally *t, const pm__spec *spec, int band, int i, int j, double coarse, double fine)
{
    const double found = t->count[band][i][j], wanted = fine > 0.0 ? fine / t->power[band] * EMITTED : 0.0;
    const bool even = fabs(fine - coarse) <= 0.003 * fine;
    if (!even || (fine > 0.0 ? wanted < 20.0 : !is_dark(spec, t->where, i, j, band)))
        return 0;
    const double z = 2.0 * (sqrt(found + 0.375) - sqrt(wanted + 0.375)), slack = 0.003 * sqrt(wanted);
    ck_assert_msg(fabs(z) <= 6.5 + slack, "%s, band %d, cell %d %d: %g photons, %g expected", t->where->spec, band, i,
                  j, found, wanted);
    return 1;
}

static void trace_scene(const pm__case *c, const double *values, tally *t)
{
    pm__scene *scene = NULL;
    pm__paths *paths = NULL;
    pm_error error;
    PM_CHECK_OK(pm__paths_create(c->paths, &paths, &error), error);
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(c->build(values, scene, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    const pm__trace_config config = {.scene = scene, .paths = paths, .seed = 11};
    (void)pm__trace(&config, 0, EMITTED, store, t);
    pm__scene_destroy(scene);
    pm__paths_destroy(paths);
}

static void check_patch(const patch *where)
{
    static double count[3][CELLS][CELLS];
    pm__spec spec;
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__scene_cases, where->spec, &spec, &error), error);
    const pm__case *const c = (const pm__case *)(const void *)spec.entry;
    tally t = {.where = where, .count = count};
    memset(count, 0, sizeof count);
    trace_scene(c, spec.values, &t);
    ck_assert_msg(t.stored > 0, "%s: no photon came", where->spec);
    int compared = 0;
    for (int i = 0; i < CELLS; i++)
        for (int j = 0; j < CELLS; j++) {
            double coarse[3], fine[3];
            integrate(&spec, where, i, j, 4, coarse);
            integrate(&spec, where, i, j, 8, fine);
            for (int band = 0; band < (c->truth_bands ? 3 : 1); band++)
                compared += check_cell(&t, &spec, band, i, j, coarse[band], fine[band]);
        }
    ck_assert_msg(compared >= where->least, "%s: only %d cells", where->spec, compared);
}

START_TEST(floors_are_lit_as_the_truth_has_it)
{
    for (size_t i = 0; i < sizeof patches / sizeof *patches; i++)
        check_patch(&patches[i]);
}
END_TEST

/* ---- The furnace ---- */

static bool count_stored(void *context, uint64_t number, const pm__stored *photon)
{
    double *const sum = context;
    (void)number;
    *sum += photon->power[0];
    return true;
}

/* The power that the wall of the furnace gets, W, by photons emitted. */
static double trace_furnace(const pm__scene *scene, uint64_t photons)
{
    double sum = 0.0;
    const pm__trace_config config = {.scene = scene, .seed = 5};
    (void)pm__trace(&config, 0, photons, count_stored, &sum);
    return sum / (double)photons;
}

/* A white wall absorbs nothing, so each photon must come to the wall as often as it is let: a leak of 1e-5 a reflection
 * would stay unseen once in 1e8 runs. It would take 1e-4 of the light at albedo 0.9. */
START_TEST(furnace_loses_nothing)
{
    enum { PHOTONS = 2000 };
    const double centre[3] = {0, 0, 0};
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    const pm__light light = {.kind = PM__BALL, .power = {1, 1, 1}, .radius = 1.0 - 1e-9, .inward = true};
    pm__scene *scene = NULL;
    pm_error error;
    uint32_t material;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(pm__scene_material(scene, &white, &material, &error), error);
    PM_CHECK_OK(pm__scene_sphere(scene, material, centre, 1.0, true, &error), error);
    PM_CHECK_OK(pm__scene_light(scene, &light, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    PM_CHECK_NEAR(trace_furnace(scene, PHOTONS), PM__LONGEST_PATH, 1e-9 * PM__LONGEST_PATH);
    pm__scene_destroy(scene);
}
END_TEST

/* A photon of albedo 0.9 comes to the wall 10 times, of variance 90; 5 standard errors: a false alarm in 6e-7. With the
 * photons of a full check those are 0.1 %. */
START_TEST(furnace_has_its_light)
{
    const bool full = getenv("PM_FULL") != NULL;
    const uint64_t photons = full ? 22500000 : 400000;
    const double albedo = 0.9, area = 4.0 * pi;
    const pm__case *const c = &pm__case_scene_furnace;
    const pm__probe at = {.position = {0, 0, 1}, .normal = {0, 0, -1}};
    pm__scene *scene = NULL;
    pm_error error;
    PM_CHECK_OK(pm__scene_create(&scene, &error), error);
    PM_CHECK_OK(c->build(&albedo, scene, &error), error);
    PM_CHECK_OK(pm__scene_commit(scene, &error), error);
    const double found = trace_furnace(scene, photons) / area, wanted = c->truth(&albedo, &at);
    PM_CHECK_NEAR(found / wanted, 1.0, 5.0 * sqrt(albedo / (double)photons));
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("scene-floors", floors_are_lit_as_the_truth_has_it, furnace_loses_nothing, furnace_has_its_light)
