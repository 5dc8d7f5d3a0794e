/* Two tables: of large cells, which say what they say or that something is near; then small ones are asked. A slot is
 * one word, a part of the cell's mixed key that with its place says which it is, and the value: whoever finds none puts
 * in the same. */
#include "cells.h"

#include "cone.h"
#include "lanes.h"
#include "vicinity.h"

#include "../base/memory.h"
#include "../base/vec3.h"
#include "../lookup/lookup.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { LARGE, SMALL, LEVELS };
enum { LARGER_BITS = 3, LARGER = 1 << LARGER_BITS, PROBES = 8 };
enum { STEPS = PM__CONE_STEPS };
enum { KEY_BITS = PM__CELL_BITS, HALF = PM__CELL_HALF };

/* Of a word: a tag of the cell, then its value and one, so that no word in use is 0. Values are floats without sign and
 * without the last bits of their mantissa, right to 2.4e-7. Place and tag together are 58 bits of the largest table:
 * that of a million cells any two are taken for one has a chance of 2e-6. */
enum { VALUE_BITS = 28, CUT_BITS = 3 };

_Static_assert(PM__CELLS_AT_ONCE == (int)PM__LANE_POINTS, "as many are looked at");

/* Words of a line of the cache. */
enum { LINE_BITS = 3, LINE = 1 << LINE_BITS };

/* Something is near, and what could not be taken for it: the largest value. */
static const uint32_t near_by = (1u << VALUE_BITS) - 2, largest = (255u << (VALUE_BITS - 8)) - 1;

typedef struct table {
    double size;     /* map units */
    int bits;        /* 2^bits slots */
    _Atomic uint64_t *slots;
} table;

struct pm__cells {
    const pm_map *map;
    pm__cell_value value;
    const void *context;
    float reach2;          /* map units squared */
    pm__vicinity vicinity; /* where anything is within it */
    pm__cell_frame frame;  /* of small cells */
    const pm__lanes *lanes;
    table tables[LEVELS];
};

/* ---- Cells ------------------------------------------------------------------------------------- */

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

static inline uint32_t corner_of(const uint32_t cell[3])
{
    return (cell[0] & 1) << 2 | (cell[1] & 1) << 1 | (cell[2] & 1);
}

/* Where the eight stand. */
static size_t line_of(const table *t, uint64_t mixed)
{
    return (size_t)(mixed >> (64 - t->bits + LINE_BITS)) << LINE_BITS;
}

/* The bits behind those that say where it stands. */
static uint64_t tag_of(const table *t, uint64_t mixed)
{
    return mixed << (t->bits - LINE_BITS) >> VALUE_BITS;
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

/* Rounded to what a word holds. */
static uint32_t code_of(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    const uint32_t rounded = (bits + (1u << (CUT_BITS - 1))) >> CUT_BITS;
    return rounded < largest ? rounded : largest;
}

static float value_of(uint32_t code)
{
    const uint32_t bits = code << CUT_BITS;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
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
    return code_of(cells->value(cells->context, found.number, fmax(0.0, off) * pm_map_unit(cells->map)));
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

/* What the word says of the cell with this tag, less one. */
static uint32_t code_in(uint64_t word)
{
    return (uint32_t)(word & ((1u << VALUE_BITS) - 1)) - 1;
}

/* Where the table has no room the cell is asked about each time. */
static uint32_t look_up(pm__cells *cells, int level, const uint32_t cell[3], uint32_t cone)
{
    const table *const t = &cells->tables[level];
    const uint64_t key = pm__cell_key(cell[0], cell[1], cell[2], cone);
    const uint64_t mixed = pm__cell_mixed(cell[0], cell[1], cell[2], cone), tag = tag_of(t, mixed);
    const size_t first = line_of(t, mixed) + corner_of(cell), mask = ((size_t)1 << t->bits) - 1;
    for (size_t i = 0; i < PROBES; i++) {
        _Atomic uint64_t *const at = &t->slots[(first + i * LINE) & mask];
        uint64_t word = atomic_load_explicit(at, memory_order_relaxed);
        if (!word) {
            const uint64_t own = tag << VALUE_BITS | (ask_cell(cells, level, key) + 1);
            if (atomic_compare_exchange_strong_explicit(at, &word, own, memory_order_relaxed, memory_order_relaxed))
                word = own;
        }
        if (word >> VALUE_BITS == tag)
            return code_in(word);
    }
    return ask_cell(cells, level, key);
}

/* Small cells are asked only where the large one has said that something is near: what is known of one is the answer.
 * Eight of them along each axis are a large one, counted from the same middle. */
static uint32_t answer_new(pm__cells *cells, const uint32_t cell[3], uint32_t cone)
{
    uint32_t large[3];
    for (int axis = 0; axis < 3; axis++)
        large[axis] = (cell[axis] >> LARGER_BITS) + HALF - (HALF >> LARGER_BITS);
    const uint32_t code = look_up(cells, LARGE, large, cone);
    return code == near_by ? look_up(cells, SMALL, cell, cone) : code;
}

/* Far off each place is asked about for itself. */
static uint32_t answer_far(pm__cells *cells, const pm__cell_points *points, size_t i)
{
    float place[3];
    for (int axis = 0; axis < 3; axis++)
        place[axis] = pm__in_frame(cells->map, axis, points->position[axis][i]);
    return ask_map(cells, SMALL, place, points->cone[i]);
}

static uint32_t answer(pm__cells *cells, const pm__cell_points *points, size_t i)
{
    const table *const t = &cells->tables[SMALL];
    const uint32_t cell[3] = {points->cell[0][i], points->cell[1][i], points->cell[2][i]};
    const uint64_t mixed = points->mixed[i];
    const uint64_t word =
        atomic_load_explicit(&t->slots[line_of(t, mixed) + corner_of(cell)], memory_order_relaxed);
    if (points->is_far[i])
        return answer_far(cells, points, i);
    if (word && word >> VALUE_BITS == tag_of(t, mixed))
        return code_in(word);
    return answer_new(cells, cell, points->cone[i]);
}

/* ---- Points ------------------------------------------------------------------------------------ */

static void take_points(const float (*positions)[3], const float (*normals)[3], size_t count, pm__cell_points *points)
{
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) {
            points->position[a][i] = positions[i][a];
            points->normal[a][i] = normals[i][a];
        }
    for (int a = 0; a < 3; a++)
        for (size_t i = count; i < PM__CELLS_AT_ONCE; i++)
            points->position[a][i] = points->normal[a][i] = 0.0f;
}

/* Lines are fetched for all points before any is looked at. */
void pm__cells_find(pm__cells *cells, const float (*positions)[3], const float (*normals)[3], size_t count,
                    float *values)
{
    const table *const t = &cells->tables[SMALL];
    const unsigned char *const marked = cells->vicinity.marked;
    pm__cell_points points;
    take_points(positions, normals, count, &points);
    cells->lanes->cut_cells(&cells->frame, &points);
    for (size_t i = 0; i < count; i++)
        if (points.voxel[i] >= 0)
            __builtin_prefetch(&t->slots[line_of(t, points.mixed[i])]);
    for (size_t i = 0; i < count; i++) {
        const bool is_any = points.voxel[i] >= 0 && (!marked || marked[points.voxel[i]]);
        values[i] = value_of(is_any ? answer(cells, &points, i) : 0);
    }
}

/* ---- Creation ---------------------------------------------------------------------------------- */

static pm_status create_table(double size, int bits, table *t)
{
    const size_t slots = (size_t)1 << bits;
    *t = (table){.size = size, .bits = bits, .slots = pm__alloc(slots, sizeof *t->slots)};
    for (size_t i = 0; t->slots && i < slots; i++)
        atomic_init(&t->slots[i], 0);
    return t->slots ? PM_OK : PM_ENOMEM;
}

static void cut_space(pm__cells *cells, double size)
{
    const pm__vicinity *const vicinity = &cells->vicinity;
    pm__cell_frame *const frame = &cells->frame;
    *frame = (pm__cell_frame){.inverse_unit = cells->map->inverse_unit, .limit = pm__frame_limit,
                              .per_edge = vicinity->per_edge, .per_size = (float)(1.0 / size)};
    for (int axis = 0; axis < 3; axis++) {
        frame->centre[axis] = cells->map->centre[axis];
        frame->low[axis] = vicinity->low[axis];
    }
    cells->lanes = pm__lanes_choose();
}

pm_status pm__cells_create(const pm_map *map, double reach, double size, pm__cell_value value, const void *context,
                           pm__cells **cells)
{
    enum { LEAST_BITS = 15, MOST_BITS = 22, FOR_EACH = 32 };
    int bits = LEAST_BITS;
    while (bits < MOST_BITS && (size_t)1 << bits < FOR_EACH * pm_map_count(map))
        bits++;
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
        status = create_table(LARGER * small, bits - 2, &made->tables[LARGE]);
    if (status == PM_OK)
        status = create_table(small, bits, &made->tables[SMALL]);
    if (status != PM_OK) {
        pm__cells_destroy(made);
        return status;
    }
    cut_space(made, small);
    *cells = made;
    return PM_OK;
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
