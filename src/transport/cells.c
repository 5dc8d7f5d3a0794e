/* Two tables: of large cells, which say what they say or that something is near; then small ones are asked. A slot is
 * taken by its key; its value follows, and whoever comes in between finds the same value by itself. */
#include "cells.h"

#include "cone.h"
#include "vicinity.h"

#include "../base/memory.h"
#include "../base/vec3.h"
#include "../lookup/lookup.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { LARGE, SMALL, LEVELS };
enum { LARGER = 8, PROBES = 8 };
enum { STEPS = PM__CONE_STEPS };
enum { KEY_BITS = 19, HALF = 1 << (KEY_BITS - 1) }; /* cells on each side of the middle that keys tell apart */

/* Bits of no value. */
static const uint32_t unknown = UINT32_MAX, near_by = UINT32_MAX - 1;

typedef struct slot {
    _Atomic uint64_t key; /* 0: free */
    _Atomic uint32_t bits;
} slot;

typedef struct table {
    double size, per_size; /* map units */
    size_t mask;           /* slots - 1 */
    slot *slots;
} table;

struct pm__cells {
    const pm_map *map;
    pm__cell_value value;
    const void *context;
    float reach2;          /* map units squared */
    pm__vicinity vicinity; /* where anything is within it */
    table tables[LEVELS];
};

/* A point that is asked about. */
typedef struct asked {
    float place[3];       /* map units */
    uint32_t cone;
    uint64_t key[LEVELS]; /* of its cells; 0: too far off to be counted */
    bool is_any;          /* false: not finite, or nothing is near */
} asked;

/* ---- Cells ------------------------------------------------------------------------------------- */

static uint32_t cone_of(const float normal[3])
{
    const pm__cone cone = pm__cone_at(normal);
    return pm__cone_number(&cone);
}

static void middle_of(uint32_t cone, float normal[3])
{
    const int v = (int)(cone % STEPS), u = (int)(cone / STEPS % STEPS), face = (int)(cone / (STEPS * STEPS));
    const int axis = face / 2;
    double n[3];
    n[axis] = face % 2 ? -1.0 : 1.0;
    n[(axis + 1) % 3] = (double)(2 * (u - 1)) / STEPS;
    n[(axis + 2) % 3] = (double)(2 * (v - 1)) / STEPS;
    (void)pm__normalize(n);
    for (int i = 0; i < 3; i++)
        normal[i] = (float)n[i];
}

static uint64_t key_of(const table *t, const float place[3], uint32_t cone)
{
    uint64_t key = 1;
    for (int axis = 0; axis < 3; axis++) {
        const double at = (double)place[axis] * t->per_size + HALF; /* above 0 what is cut off is the floor */
        if (!(at >= 0.0 && at < 2.0 * HALF))
            return 0;
        key = key << KEY_BITS | (uint64_t)at;
    }
    return key << 6 | cone;
}

static size_t slot_of(uint64_t key)
{
    const uint64_t hash = key * 0x9e3779b97f4a7c15u;
    return (size_t)(hash ^ hash >> 29);
}

/* ---- What they say ----------------------------------------------------------------------------- */

static bool search(const pm__cells *cells, const float place[3], const float normal[3], float reach2,
                   pm_neighbor *found)
{
    pm__query query = {.k = 1, .prune_scale = 1.0f, .max_distance2 = reach2, .front_only = normal != NULL};
    memcpy(query.position, place, sizeof query.position);
    if (normal)
        memcpy(query.normal, normal, sizeof query.normal);
    return pm__run_search(cells->map, cells->map->search, &query, found, 1) > 0;
}

static uint32_t bits_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

/* Of a cell, or of a place for itself. Large cells far from all photons speak for themselves. */
static uint32_t ask_map(const pm__cells *cells, int level, const float place[3], uint32_t cone)
{
    float normal[3];
    pm_neighbor found;
    const float across = (float)(1.75 * cells->tables[LARGE].size);
    if (level == LARGE && search(cells, place, NULL, across * across, &found))
        return near_by;
    middle_of(cone, normal);
    if (!search(cells, place, normal, cells->reach2, &found))
        return 0;
    const double off = sqrt((double)found.distance2) - 0.5 * sqrt(3.0) * cells->tables[level].size;
    return bits_of(cells->value(cells->context, found.number, fmax(0.0, off) * pm_map_unit(cells->map)));
}

static uint32_t ask_cell(const pm__cells *cells, int level, uint64_t key)
{
    float middle[3];
    for (int i = 0; i < 3; i++) {
        const double cell = (double)(key >> (6 + KEY_BITS * (2 - i)) & (2 * HALF - 1)) - HALF;
        middle[i] = (float)((cell + 0.5) * cells->tables[level].size);
    }
    return ask_map(cells, level, middle, (uint32_t)(key & 63));
}

/* Where the table has no room the cell is asked about each time. */
static uint32_t look_up(pm__cells *cells, int level, const asked *point)
{
    const table *const t = &cells->tables[level];
    const uint64_t key = point->key[level];
    const size_t first = slot_of(key);
    if (!key)
        return ask_map(cells, SMALL, point->place, point->cone);
    for (size_t i = 0; i < PROBES; i++) {
        slot *const at = &t->slots[(first + i) & t->mask];
        uint64_t there = atomic_load_explicit(&at->key, memory_order_acquire);
        if (!there && atomic_compare_exchange_strong_explicit(&at->key, &there, key, memory_order_acq_rel,
                                                              memory_order_acquire))
            there = key;
        if (there != key)
            continue;
        uint32_t bits = atomic_load_explicit(&at->bits, memory_order_relaxed);
        if (bits == unknown) {
            bits = ask_cell(cells, level, key);
            atomic_store_explicit(&at->bits, bits, memory_order_relaxed);
        }
        return bits;
    }
    return ask_cell(cells, level, key);
}

/* ---- Points ------------------------------------------------------------------------------------ */

static asked ask(const pm__cells *cells, const float position[3], const float normal[3])
{
    asked point;
    float sum = 0.0f;
    for (int i = 0; i < 3; i++) {
        point.place[i] = pm__in_frame(cells->map, i, position[i]);
        sum += fabsf(normal[i]);
    }
    point.is_any = sum > 0.0f && sum < INFINITY && isfinite(position[0] + position[1] + position[2]) &&
                   pm__vicinity_holds(&cells->vicinity, point.place);
    if (!point.is_any)
        return point;
    point.cone = cone_of(normal);
    for (int level = 0; level < LEVELS; level++) {
        const table *const t = &cells->tables[level];
        point.key[level] = key_of(t, point.place, point.cone);
        __builtin_prefetch(&t->slots[slot_of(point.key[level]) & t->mask]);
    }
    return point;
}

/* Slots are fetched for all points before any is looked at. */
void pm__cells_find(pm__cells *cells, const float (*positions)[3], const float (*normals)[3], size_t count,
                    float *values)
{
    asked points[PM__CELLS_AT_ONCE];
    for (size_t i = 0; i < count; i++)
        points[i] = ask(cells, positions[i], normals[i]);
    for (size_t i = 0; i < count; i++) {
        uint32_t bits = points[i].is_any ? look_up(cells, LARGE, &points[i]) : 0;
        if (bits == near_by)
            bits = look_up(cells, SMALL, &points[i]);
        memcpy(&values[i], &bits, sizeof bits);
    }
}

/* ---- Creation ---------------------------------------------------------------------------------- */

static pm_status create_table(double size, size_t slots, table *t)
{
    *t = (table){.size = size, .per_size = 1.0 / size, .mask = slots - 1, .slots = pm__alloc(slots, sizeof *t->slots)};
    for (size_t i = 0; t->slots && i < slots; i++) {
        atomic_init(&t->slots[i].key, 0);
        atomic_init(&t->slots[i].bits, unknown);
    }
    return t->slots ? PM_OK : PM_ENOMEM;
}

pm_status pm__cells_create(const pm_map *map, double reach, double size, pm__cell_value value, const void *context,
                           pm__cells **cells)
{
    enum { LEAST_SLOTS = 1 << 14, MOST_SLOTS = 1 << 21 };
    size_t slots = LEAST_SLOTS;
    while (slots < MOST_SLOTS && slots < 16 * pm_map_count(map))
        slots *= 2;
    pm__cells *const made = pm__alloc_zero(1, sizeof *made);
    *cells = NULL;
    if (!made)
        return PM_ENOMEM;
    const double framed = reach * map->inverse_unit;
    const double small = ldexp(1.0, (int)rint(log2(fmin(fmax(size * map->inverse_unit, 1e-9), 1e9))));
    made->map = map;
    made->value = value;
    made->context = context;
    made->reach2 = (float)fmin(framed * framed, 1e37);
    pm_status status = pm__vicinity_create(map, sqrt((double)made->reach2), &made->vicinity);
    if (status == PM_OK)
        status = create_table(LARGER * small, slots / 4, &made->tables[LARGE]);
    if (status == PM_OK)
        status = create_table(small, slots, &made->tables[SMALL]);
    if (status == PM_OK)
        *cells = made;
    else
        pm__cells_destroy(made);
    return status;
}

void pm__cells_destroy(pm__cells *cells)
{
    if (!cells)
        return;
    for (int level = 0; level < LEVELS; level++)
        free(cells->tables[level].slots);
    pm__vicinity_free(&cells->vicinity);
    free(cells);
}
