#include "lights.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FEW = 4, GRID = 40 }; /* so few lights are all asked; paths across and down */
enum { SEARCHED = 8 };        /* points of a pixel across and down */
static const double least_share = 0.001; /* of the light found: what a light must give to be asked everywhere */
static const double least_way = 1e-4;    /* of the light */

static double ask(pm__eye *eye, const pm__light *light, double radiance[3])
{
    pm__eye_lit lit;
    double sum = 0.0;
    if (!pm__eye_sample(eye, light, &lit) || pm__eye_blocked(eye, &lit))
        return 0.0;
    for (int b = 0; b < 3; b++) {
        radiance[b] += lit.radiance[b];
        sum += lit.radiance[b];
    }
    return sum;
}

/* Where a path stands, and where it comes to from there. */
static void try_path(const pm__lights *lights, pm__eye *eye, double *found)
{
    double unused[3] = {0.0, 0.0, 0.0};
    bool stands = pm__eye_follow(eye);
    for (int i = 0; i < 2 && stands; i++) {
        for (size_t l = 0; l < lights->count; l++)
            found[l] += ask(eye, lights->list[l], unused);
        stands = pm__eye_bounce(eye) && pm__eye_follow(eye);
    }
}

/* Those that matter come first; the order is otherwise kept. */
static pm_status sort_lights(pm__lights *lights, const double *found)
{
    const pm__light **const sorted = pm__alloc(lights->count, sizeof *sorted);
    double all = 0.0;
    size_t count = 0;
    if (!sorted)
        return PM_ENOMEM;
    for (size_t l = 0; l < lights->count; l++)
        all += found[l];
    for (size_t l = 0; l < lights->count; l++)
        if (found[l] > least_share * all)
            sorted[count++] = lights->list[l];
    lights->always = count;
    for (size_t l = 0; l < lights->count; l++)
        if (!(found[l] > least_share * all))
            sorted[count++] = lights->list[l];
    free(lights->list);
    lights->list = sorted;
    return PM_OK;
}

pm_status pm__lights_choose(const pm__scene *scene, const pm__camera *camera, size_t width, size_t height,
                            uint64_t seed, pm__lights *lights)
{
    const size_t count = pm__scene_light_count(scene);
    *lights = (pm__lights){pm__alloc(count, sizeof *lights->list), count, count};
    double *const found = pm__alloc_zero(count, sizeof *found);
    pm_status status = lights->list && found ? PM_OK : PM_ENOMEM;
    for (size_t l = 0; l < count && status == PM_OK; l++)
        lights->list[l] = pm__scene_light_at(scene, l);
    if (count > FEW && status == PM_OK) {
        for (uint64_t i = 0; i < (uint64_t)GRID * GRID; i++) {
            const pm__eye_numbers numbers = pm__eye_numbers_of(seed, 0, 0, i);
            pm__eye eye;
            pm__eye_through(&eye, scene, camera, &numbers, ((double)(i % GRID) + 0.5) * (double)width / GRID,
                            ((double)(i / GRID) + 0.5) * (double)height / GRID);
            try_path(lights, &eye, found);
        }
        status = sort_lights(lights, found);
    }
    free(found);
    if (status != PM_OK)
        pm__lights_free(lights);
    return status;
}

void pm__lights_free(pm__lights *lights)
{
    free(lights->list);
    *lights = (pm__lights){0};
}

void pm__lights_add(const pm__lights *lights, pm__eye *eye, double radiance[3])
{
    const size_t others = lights->count - lights->always;
    for (size_t l = 0; l < lights->always; l++)
        (void)ask(eye, lights->list[l], radiance);
    if (!others)
        return;
    double u[3], one[3] = {0.0, 0.0, 0.0};
    pm__eye_uniform(&eye->numbers, u);
    const size_t turn = (size_t)(u[0] * (double)others);
    (void)ask(eye, lights->list[lights->always + turn], one);
    for (int b = 0; b < 3; b++)
        radiance[b] += (double)others * one[b];
}

/* ---- Lamps in the picture ---------------------------------------------------------------------- */

static void add_seen(void *context, const pm__eye *eye, bool reached)
{
    double *const seen = context;
    (void)reached;
    for (int b = 0; b < 3; b++)
        seen[b] += eye->emitted[b];
}

void pm__lamps_seen(const pm__scene *scene, const pm__camera *camera, double x, double y, double seen[3])
{
    const pm__eye_numbers none = pm__eye_numbers_of(0, 0, 0, 0); /* chance is left out */
    pm__eye eye;
    seen[0] = seen[1] = seen[2] = 0.0;
    pm__eye_through(&eye, scene, camera, &none, x, y);
    pm__eye_follow_all(&eye, least_way, add_seen, seen);
}

bool pm__lamps_edge(const pm__scene *scene, const pm__camera *camera, size_t x, size_t y)
{
    double first[3], seen[3];
    for (int i = 0; i < SEARCHED * SEARCHED; i++) {
        pm__lamps_seen(scene, camera, (double)x + (i % SEARCHED + 0.5) / SEARCHED,
                       (double)y + (i / SEARCHED + 0.5) / SEARCHED, i ? seen : first);
        if (i && memcmp(first, seen, sizeof seen) != 0)
            return true;
    }
    return false;
}
