#include "wide.h"
#include "structure.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "../base/vec3.h"

#include <stdlib.h>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

enum { PARALLEL_STEPS = 7, PARALLEL_MINIMUM = 16384, FAN = 16, NODES = 64 };

/* Photons to be split into children of FAN^height blocks each. */
typedef struct range {
    size_t first, count;
    int height;
} range;

typedef struct arranging {
    pm__item *items;
    range *ranges, *next; /* next NULL: split all the way down */
} arranging;

static size_t blocks_at(int height)
{
    return (size_t)1 << 4 * height;
}

static unsigned widest_axis(const pm__item *items, size_t count)
{
    float extent[4];
#ifdef __SSE2__
    /* The id rides along as a fourth lane that nobody looks at. */
    __m128 low = _mm_loadu_ps(items[0].position), high = low;
    for (size_t i = 1; i < count; i++) {
        const __m128 p = _mm_loadu_ps(items[i].position);
        low = _mm_min_ps(low, p);
        high = _mm_max_ps(high, p);
    }
    _mm_storeu_ps(extent, _mm_sub_ps(high, low));
#else
    for (int a = 0; a < 3; a++) {
        float low = items[0].position[a], high = low;
        for (size_t i = 1; i < count; i++) {
            low = items[i].position[a] < low ? items[i].position[a] : low;
            high = items[i].position[a] > high ? items[i].position[a] : high;
        }
        extent[a] = high - low;
    }
#endif
    unsigned axis = 0;
    for (unsigned a = 1; a < 3; a++)
        if (extent[a] > extent[axis])
            axis = a;
    return axis;
}

/* Splits between children so that the left ones are full. 0: a single block is left. */
static size_t split(const arranging *a, range *r)
{
    const size_t blocks = (r->count + PM__LANES - 1) / PM__LANES;
    if (blocks <= 1)
        return 0;
    while (blocks_at(r->height) >= blocks)
        r->height--;
    const size_t children = (blocks + blocks_at(r->height) - 1) / blocks_at(r->height);
    const size_t left = (children + 1) / 2 * blocks_at(r->height) * PM__LANES;
    pm__item *const items = a->items + r->first;
    pm__select_rank(items, r->count, left, widest_axis(items, r->count));
    return left;
}

static void arrange_all(const arranging *a, range r)
{
    for (size_t left = split(a, &r); left; left = split(a, &r)) {
        arrange_all(a, (range){r.first, left, r.height});
        r = (range){r.first + left, r.count - left, r.height};
    }
}

static void arrange_task(void *argument, size_t i)
{
    const arranging *const a = argument;
    range r = a->ranges[i];
    if (!a->next) {
        arrange_all(a, r);
        return;
    }
    const size_t left = r.count ? split(a, &r) : 0;
    a->next[2 * i] = (range){r.first, left ? left : r.count, r.height};
    a->next[2 * i + 1] = (range){r.first + left, left ? r.count - left : 0, r.height};
}

static void arrange_items(pm__item *items, size_t count, const pm_parallel *parallel, int height)
{
    range buffers[2][(size_t)1 << PARALLEL_STEPS];
    arranging a = {items, buffers[0], NULL};
    buffers[0][0] = (range){0, count, height};
    size_t ranges = 1;
    const bool steps = parallel && count >= PARALLEL_MINIMUM;
    for (int step = 0; steps && step < PARALLEL_STEPS; step++) {
        a.ranges = buffers[step & 1];
        a.next = buffers[~step & 1];
        pm__for(parallel, ranges, arrange_task, &a);
        ranges *= 2;
    }
    a.ranges = buffers[steps ? PARALLEL_STEPS & 1 : 0];
    a.next = NULL;
    pm__for(parallel, ranges, arrange_task, &a);
}

static void empty(pm__boxes *boxes, size_t lane)
{
    for (int a = 0; a < 3; a++) {
        boxes->low[a][lane] = INFINITY;
        boxes->high[a][lane] = -INFINITY;
    }
}

typedef struct boxing {
    pm__wide *wide;
    const pm__item *items;
    size_t count;
} boxing;

static void box_block(pm__boxes *boxes, size_t lane, const pm__item *items, size_t count)
{
    float low[3], high[3];
    for (int a = 0; a < 3; a++)
        low[a] = high[a] = items[0].position[a];
    for (size_t i = 1; i < count; i++)
        for (int a = 0; a < 3; a++) {
            const float x = items[i].position[a];
            low[a] = x < low[a] ? x : low[a];
            high[a] = x > high[a] ? x : high[a];
        }
    for (int a = 0; a < 3; a++) {
        boxes->low[a][lane] = low[a];
        boxes->high[a][lane] = high[a];
    }
}

/* The boxes of NODES nodes of level 0, those of their blocks. */
static void boxes_task(void *argument, size_t chunk)
{
    const boxing *const b = argument;
    for (size_t node = chunk * NODES; node < b->wide->nodes[0] && node < (chunk + 1) * NODES; node++)
        for (size_t lane = 0; lane < FAN; lane++) {
            const size_t first = (node * FAN + lane) * PM__LANES;
            const size_t left = first < b->count ? b->count - first : 0;
            if (left)
                box_block(&b->wide->level[0][node], lane, b->items + first, left < PM__LANES ? left : PM__LANES);
            else
                empty(&b->wide->level[0][node], lane);
        }
}

static void fill_level(pm__wide *wide, int level)
{
    for (size_t child = 0; child < wide->nodes[level] * FAN; child++) {
        pm__boxes *const boxes = &wide->level[level][child / FAN];
        empty(boxes, child % FAN);
        if (child >= wide->nodes[level - 1])
            continue;
        const pm__boxes *const below = &wide->level[level - 1][child];
        for (int a = 0; a < 3; a++)
            for (size_t lane = 0; lane < PM__LANES; lane++) {
                boxes->low[a][child % FAN] = fminf(boxes->low[a][child % FAN], below->low[a][lane]);
                boxes->high[a][child % FAN] = fmaxf(boxes->high[a][child % FAN], below->high[a][lane]);
            }
    }
}

static pm__wide *allocate(size_t count)
{
    pm__wide *const wide = calloc(1, sizeof *wide);
    if (!wide)
        return NULL;
    size_t total = 0, below = (count + PM__LANES - 1) / PM__LANES;
    do {
        below = below ? (below + FAN - 1) / FAN : 1;
        wide->nodes[wide->levels++] = below;
        total += below;
    } while (below > 1);
    wide->level[0] = pm__alloc(total, sizeof *wide->level[0]);
    if (!wide->level[0]) {
        free(wide);
        return NULL;
    }
    for (int t = 1; t < wide->levels; t++)
        wide->level[t] = wide->level[t - 1] + wide->nodes[t - 1];
    return wide;
}

static pm_status arrange(pm__item *items, size_t count, const pm_map_options *options, void **index)
{
    pm__wide *const wide = allocate(count);
    if (!wide)
        return PM_ENOMEM;
    arrange_items(items, count, options->parallel, wide->levels);
    boxing b = {wide, items, count};
    pm__for(options->parallel, (wide->nodes[0] + NODES - 1) / NODES, boxes_task, &b);
    for (int t = 1; t < wide->levels; t++)
        fill_level(wide, t);
    *index = wide;
    return PM_OK;
}

typedef struct facing_of {
    const pm_map *map;
    pm__facing *facing;
} facing_of;

/* Directions are needed at any length, so they are made unit here. One of length 0, or of so small or large a one that
 * products with it are rounded away, becomes 0, which is neither side: pm__in_front decides. */
static void facing_task(void *argument, size_t chunk)
{
    const facing_of *const f = argument;
    const size_t photons = NODES * FAN * PM__LANES, end = (chunk + 1) * photons;
    for (size_t i = chunk * photons; i < f->map->count && i < end; i++) {
        const float *const w = pm__direction(f->map, i);
        const float square = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
        double d[3] = {(double)w[0], (double)w[1], (double)w[2]};
        if (!(square > 1e-30f && square < 1e30f))
            d[0] = d[1] = d[2] = 0.0;
        else if (!(fabsf(square - 1.0f) < 1e-5f))
            (void)pm__normalize(d);
        for (int a = 0; a < 3; a++)
            f->facing[i / PM__LANES].axis[a][i % PM__LANES] = (int8_t)(127.0 * d[a] + (d[a] < 0.0 ? -0.5 : 0.5));
    }
}

static pm_status place(const pm_map *map, void *index, const uint32_t *numbers, const pm_parallel *parallel)
{
    (void)numbers;
    if (!pm__has_directions(map))
        return PM_OK;
    pm__wide *const wide = index;
    wide->facing = pm__alloc_zero(map->block_count, sizeof *wide->facing);
    if (!wide->facing)
        return PM_ENOMEM;
    facing_of f = {map, wide->facing};
    pm__for(parallel, (wide->nodes[0] + NODES - 1) / NODES, facing_task, &f);
    return PM_OK;
}

static void destroy(void *index)
{
    pm__wide *const wide = index;
    if (!wide)
        return;
    free(wide->level[0]);
    free(wide->facing);
    free(wide->hints.cells);
    free(wide);
}

static size_t bytes(const pm_map *map, const void *index)
{
    const pm__wide *const wide = index;
    size_t nodes = 0;
    for (int t = 0; t < wide->levels; t++)
        nodes += wide->nodes[t];
    return nodes * sizeof(pm__boxes) + wide->hints.count * sizeof(pm__hint) +
           map->block_count * (sizeof(pm__block) + (wide->facing ? sizeof(pm__facing) : 0));
}

const pm__structure pm__structure_wide = {PM__WIDE, arrange, place, destroy, bytes, true, 6.0, 0.0, 3.0};

pm_status pm__wide_check(const pm_map *map, pm_error *error)
{
    const pm__wide *const wide = pm__wide_of(map);
    for (size_t i = 0; i < map->count; i++) {
        float position[3];
        pm__position(map, i, position);
        size_t child = i / PM__LANES;
        for (int t = 0; t < wide->levels; t++, child /= FAN)
            for (int a = 0; a < 3; a++) {
                const pm__boxes *const boxes = &wide->level[t][child / FAN];
                if (!(boxes->low[a][child % FAN] <= position[a] && position[a] <= boxes->high[a][child % FAN]))
                    return pm__fail(error, PM_EBROKEN, "photon %zu lies outside its box of level %d", i, t);
            }
    }
    return PM_OK;
}
