#include "workloads.h"

#include "../src/base/memory.h"
#include "../src/base/parallel.h"
#include "../src/base/vec3.h"

#include <stdlib.h>
#include <string.h>

enum { BLOCK = 4096, PHOTON_TRIAL = 0, QUERY_TRIAL = 1, JITTER_TRIAL = 2 };

void pm__cosine_direction(const double normal[3], const double u[2], double direction[3])
{
    double s[3], t[3];
    const double r = sqrt(u[0]), phi = 6.283185307179586 * u[1], z = sqrt(1.0 - u[0]);
    const double x = r * cos(phi), y = r * sin(phi);
    pm__basis(normal, s, t);
    for (int i = 0; i < 3; i++)
        direction[i] = x * s[i] + y * t[i] + z * normal[i];
}

static void draw_point(const pm__workload *workload, uint64_t seed, uint32_t trial, uint64_t number,
                       pm__workload_point *point)
{
    double u[PM__WORKLOAD_NUMBERS];
    pm__random_uniform(seed, PM__FOR_TIMING, trial, number, u, PM__WORKLOAD_NUMBERS);
    workload->draw(u, point);
}

/* One of the two lists in the making. */
typedef struct drawing {
    const pm__workload *workload;
    uint64_t seed;
    size_t count;
    pm_photon *photons;
    pm_surface_point *queries;
} drawing;

static void draw_photons(void *argument, size_t block)
{
    const drawing *const d = argument;
    const float power = (float)(1.0 / (double)d->count);
    for (size_t i = block * BLOCK; i < d->count && i < (block + 1) * BLOCK; i++) {
        pm__workload_point point;
        draw_point(d->workload, d->seed, PHOTON_TRIAL, i, &point);
        for (int a = 0; a < 3; a++) {
            d->photons[i].position[a] = (float)point.position[a];
            d->photons[i].direction[a] = (float)point.direction[a];
            d->photons[i].power[a] = power;
        }
    }
}

void pm__workload_photons(const pm__workload *workload, uint64_t seed, size_t count, const pm_parallel *parallel,
                          pm_photon *photons)
{
    drawing d = {workload, seed, count, photons, NULL};
    pm__for(parallel, (count + BLOCK - 1) / BLOCK, draw_photons, &d);
}

/* Moves a point on its surface. Every second one stays: a query right at a photon is a case of its own. */
static void jitter(double position[3], const double normal[3], double by, uint64_t seed, uint64_t number)
{
    double u[2], s[3], t[3];
    if (number % 2)
        return;
    pm__random_uniform(seed, PM__FOR_TIMING, JITTER_TRIAL, number, u, 2);
    pm__basis(normal, s, t);
    for (int i = 0; i < 3; i++)
        position[i] += by * ((2.0 * u[0] - 1.0) * s[i] + (2.0 * u[1] - 1.0) * t[i]);
}

static void store_query(const double position[3], const double normal[3], pm_surface_point *query)
{
    for (int a = 0; a < 3; a++) {
        query->position[a] = (float)position[a];
        query->normal[a] = (float)normal[a];
    }
}

static void draw_queries(void *argument, size_t block)
{
    const drawing *const d = argument;
    for (size_t i = block * BLOCK; i < d->count && i < (block + 1) * BLOCK; i++) {
        pm__workload_point point;
        draw_point(d->workload, d->seed, QUERY_TRIAL, i, &point);
        if (d->workload->query_jitter > 0.0)
            jitter(point.position, point.normal, d->workload->query_jitter, d->seed, i);
        store_query(point.position, point.normal, &d->queries[i]);
    }
}

void pm__workload_queries(const pm__workload *workload, uint64_t seed, size_t count, const pm_parallel *parallel,
                          pm_surface_point *queries)
{
    drawing d = {workload, seed, count, NULL, queries};
    pm__for(parallel, (count + BLOCK - 1) / BLOCK, draw_queries, &d);
}

/* The diagonal of the photons' bounding box, m. */
static double diagonal(const pm_photon *photons, size_t count)
{
    double sum = 0.0;
    for (int a = 0; a < 3 && count; a++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < count; i++) {
            low = fmin(low, (double)photons[i].position[a]);
            high = fmax(high, (double)photons[i].position[a]);
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

void pm__photon_queries(const pm_photon *photons, const float (*normals)[3], size_t photon_count, uint64_t seed,
                        size_t count, pm_surface_point *queries)
{
    /* About the distance of neighbours on a surface. */
    const double by = diagonal(photons, photon_count) / sqrt((double)photon_count + 1.0);
    for (size_t i = 0; i < count; i++) {
        double u[1], position[3] = {0.0, 0.0, 0.0}, normal[3] = {0.0, 0.0, 1.0};
        pm__random_uniform(seed, PM__FOR_TIMING, QUERY_TRIAL, i, u, 1);
        if (photon_count) {
            const size_t near = (size_t)(u[0] * (double)photon_count);
            for (int a = 0; a < 3; a++) {
                position[a] = (double)photons[near].position[a];
                normal[a] = normals ? (double)normals[near][a] : -(double)photons[near].direction[a];
            }
            if (!(pm__normalize(normal) > 0.0))
                normal[2] = 1.0;
            jitter(position, normal, by, seed, i);
        }
        store_query(position, normal, &queries[i]);
    }
}

typedef struct keyed {
    uint64_t code;
    pm_surface_point query;
} keyed;

/* The low 21 bits, each followed by two zeros. */
static uint64_t spread(uint64_t x)
{
    x = (x | x << 32) & 0x001f00000000ffffU;
    x = (x | x << 16) & 0x001f0000ff0000ffU;
    x = (x | x << 8) & 0x100f00f00f00f00fU;
    x = (x | x << 4) & 0x10c30c30c30c30c3U;
    return (x | x << 2) & 0x1249249249249249U;
}

static int compare_codes(const void *a, const void *b)
{
    const keyed *const x = a, *const y = b;
    if (x->code != y->code)
        return x->code < y->code ? -1 : 1;
    return memcmp(&x->query, &y->query, sizeof x->query); /* qsort is not stable */
}

pm_status pm__morton_order(pm_surface_point *queries, size_t count)
{
    keyed *const list = pm__alloc(count, sizeof *list);
    double low[3] = {INFINITY, INFINITY, INFINITY}, extent = 0.0;
    if (!list)
        return PM_ENOMEM;
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            low[a] = fmin(low[a], (double)queries[i].position[a]);
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            extent = fmax(extent, (double)queries[i].position[a] - low[a]);
    const double scale = extent > 0.0 ? (double)0x1fffff / extent : 0.0;
    for (size_t i = 0; i < count; i++) {
        uint64_t cell[3];
        for (int a = 0; a < 3; a++)
            cell[a] = (uint64_t)fmin(((double)queries[i].position[a] - low[a]) * scale, (double)0x1fffff);
        list[i] = (keyed){spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2, queries[i]};
    }
    qsort(list, count, sizeof *list, compare_codes);
    for (size_t i = 0; i < count; i++)
        queries[i] = list[i].query;
    free(list);
    return PM_OK;
}
