/* The loops of lanes.h, once for each width: included by a file that the Makefile compiles for it. */
#include "cone.h"
#include "lanes.h"
#include "vicinity.h"

#include <math.h>
#include <string.h>

enum { COUNT = PM__LANE_POINTS };

/* ---- Classes of normals ------------------------------------------------------------------------- */

/* pm__cone_at of all. */
typedef struct cones {
    int32_t second[COUNT], third[COUNT]; /* 1: the normal is longest along that axis */
    float longest[COUNT];
    uint32_t face[COUNT], u[COUNT], v[COUNT];
} cones;

static inline void cut_normals(const float (*normal)[COUNT], cones *c)
{
    for (int i = 0; i < COUNT; i++) {
        const float x = normal[0][i], y = normal[1][i], z = normal[2][i];
        const float ax = fabsf(x), ay = fabsf(y), az = fabsf(z), step = 1.0f / PM__CONE_STEPS;
        const int32_t third = az > (ay > ax ? ay : ax) ? 1 : 0, second = ay > ax ? 1 - third : 0;
        const float longest = third ? z : second ? y : x;
        const float u = third ? x : second ? z : y, v = third ? y : second ? x : z;
        const float scale = 1.0f / fabsf(longest), own_u = u * scale, own_v = v * scale;
        c->second[i] = second;
        c->third[i] = third;
        c->longest[i] = longest;
        c->face[i] = (uint32_t)(4 * third + 2 * second) + (uint32_t)(longest < 0.0f ? 1 : 0);
        c->u[i] = (uint32_t)(own_u >= -step ? 1 : 0) + (uint32_t)(own_u > step ? 1 : 0);
        c->v[i] = (uint32_t)(own_v >= -step ? 1 : 0) + (uint32_t)(own_v > step ? 1 : 0);
    }
}

static inline void number_cones(const cones *c, uint32_t *numbers)
{
    for (int i = 0; i < COUNT; i++)
        numbers[i] = (c->face[i] * PM__CONE_STEPS + c->u[i]) * PM__CONE_STEPS + c->v[i];
}

/* ---- Cells -------------------------------------------------------------------------------------- */

static inline void begin_cells(pm__cell_points *p)
{
    for (int i = 0; i < COUNT; i++) {
        const float sum = fabsf(p->normal[0][i]) + fabsf(p->normal[1][i]) + fabsf(p->normal[2][i]);
        const float all = p->position[0][i] + p->position[1][i] + p->position[2][i];
        p->voxel[i] = ((sum > 0.0f) & (sum < INFINITY) & (fabsf(all) < INFINITY)) ? 0 : -1;
        p->is_far[i] = 0;
    }
}

/* Whole cells of one axis, and voxels: `voxel` is at * PM__VOXELS + this one's, or stays below 0. */
static inline void cut_axis(const pm__cell_frame *f, int axis, pm__cell_points *p)
{
    static const float most = (float)PM__CELL_HALF;
    static const double last = 2.0 * PM__CELL_HALF - 1.0;
    const double centre = f->centre[axis], unit = f->inverse_unit, limit = f->limit;
    const float low = f->low[axis], per_edge = f->per_edge, per_size = f->per_size;
    float places[COUNT];
    for (int i = 0; i < COUNT; i++) {
        const double framed = ((double)p->position[axis][i] - centre) * unit;
        const double above = framed > -limit ? framed : -limit;
        places[i] = (float)(above < limit ? above : limit);
    }
    for (int i = 0; i < COUNT; i++) {
        const float cells = places[i] * per_size;
        const double from_low = (double)cells + (double)PM__CELL_HALF; /* above 0 what is cut off is the floor */
        const double above_least = from_low > 0.0 ? from_low : 0.0;
        const int32_t is_out = cells >= -most && cells < most ? 0 : 1;
        const double counted = above_least < last ? above_least : last;
        p->cell[axis][i] = is_out ? 0 : (uint32_t)(int32_t)counted;
        p->is_far[i] |= is_out;
    }
    for (int i = 0; i < COUNT; i++) {
        const float x = (places[i] - low) * per_edge;
        const float in_least = x > 0.0f ? x : 0.0f, in = in_least < (float)PM__VOXELS ? in_least : 0.0f;
        const int32_t before = p->voxel[i], here = before * PM__VOXELS + (int32_t)in;
        p->voxel[i] = x >= 0.0f && x < (float)PM__VOXELS && before >= 0 ? here : -1;
    }
}

static void cut_cells(const pm__cell_frame *frame, pm__cell_points *p)
{
    cones c;
    cut_normals((const float(*)[COUNT])p->normal, &c);
    number_cones(&c, p->cone);
    begin_cells(p);
    for (int axis = 2; axis >= 0; axis--)
        cut_axis(frame, axis, p);
    for (int i = 0; i < COUNT; i++)
        p->mixed[i] = pm__cell_mixed(p->cell[0][i], p->cell[1][i], p->cell[2][i], p->cone[i]);
}

/* ---- Plots -------------------------------------------------------------------------------------- */

/* Where the points lie, in edges of squares. */
typedef struct cuts {
    int32_t level[COUNT];
    float fill[COUNT];                      /* of the required density in the middle of the level */
    float x[COUNT], y[COUNT], along[COUNT]; /* from the corner, offset included */
    int32_t cells[2][COUNT];
} cuts;

static inline float two_to(int32_t exponent)
{
    const uint32_t bits = (uint32_t)(127 + exponent) << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return power;
}

static inline void find_levels(const pm__plot_frame *f, const pm__plot_points *p, cuts *at)
{
    const float usual = f->usual;
    const int32_t least = f->least, most = f->most;
    for (int i = 0; i < COUNT; i++) {
        const float ratio = p->required[i] / usual;
        uint32_t bits;
        memcpy(&bits, &ratio, sizeof bits);
        const int32_t up = ((int32_t)(bits >> 23) - 126) >> 1, own = PM__PLOT_USUAL - up;
        const int32_t above = own > least ? own : least;
        bits -= (uint32_t)(2 * up) << 23;
        memcpy(&at->fill[i], &bits, sizeof bits);
        at->level[i] = above < most ? above : most;
    }
}

static inline void find_places(const pm__plot_frame *f, const pm__plot_points *p, const cones *c, cuts *at)
{
    const float low0 = f->low[0], low1 = f->low[1], low2 = f->low[2], per_edge = f->per_edge, off = f->offset;
    for (int i = 0; i < COUNT; i++) {
        const float scale = per_edge * two_to(PM__PLOT_USUAL - at->level[i]), offset = off * scale;
        const float d0 = (p->position[0][i] - low0) * scale, d1 = (p->position[1][i] - low1) * scale;
        const float d2 = (p->position[2][i] - low2) * scale;
        const int32_t second = c->second[i], third = c->third[i];
        const float w = third ? d2 : second ? d1 : d0, x = third ? d0 : second ? d2 : d1;
        const float y = third ? d1 : second ? d0 : d2;
        const float on_u = (float)((int32_t)c->u[i] - 1) * (2.0f / PM__CONE_STEPS);
        const float on_v = (float)((int32_t)c->v[i] - 1) * (2.0f / PM__CONE_STEPS);
        at->x[i] = x + offset;
        at->y[i] = y + offset;
        at->along[i] = (c->longest[i] < 0.0f ? -w : w) + on_u * x + on_v * y + offset;
    }
}

/* In [0, most]. */
static inline float bounded(float x, float most)
{
    const float above = x > 0.0f ? x : 0.0f;
    return above < most ? above : most;
}

static inline void make_keys(const uint32_t *cone, const pm__plot_points *p, cuts *at, uint64_t *keys)
{
    static const float most = (float)((1 << PM__PLOT_ACROSS_BITS) - 1), last = (float)((1 << PM__PLOT_ALONG_BITS) - 1);
    static const float half = (float)(1 << (PM__PLOT_ALONG_BITS - 1));
    uint32_t along[COUNT];
    for (int i = 0; i < COUNT; i++) {
        at->x[i] = bounded(at->x[i], most);
        at->y[i] = bounded(at->y[i], most);
        at->cells[0][i] = (int32_t)at->x[i];
        at->cells[1][i] = (int32_t)at->y[i];
        along[i] = (uint32_t)(int32_t)bounded(at->along[i] + half, last);
    }
    for (int i = 0; i < COUNT; i++) {
        const uint64_t x = (uint64_t)(uint32_t)at->cells[0][i], y = (uint64_t)(uint32_t)at->cells[1][i];
        const uint64_t class = ((uint64_t)(uint32_t)at->level[i] << PM__PLOT_CONE_BITS | (cone[i] + 1)) << 1;
        keys[i] = (((class | p->important[i]) << PM__PLOT_ACROSS_BITS | x) << PM__PLOT_ACROSS_BITS | y)
                      << PM__PLOT_ALONG_BITS | along[i];
    }
}

static inline void find_shards(const pm__plot_frame *f, const cuts *at, pm__plot_points *p)
{
    const int32_t common = f->common;
    for (int i = 0; i < COUNT; i++) {
        p->at[0][i] = (int32_t)(at->x[i] * 256.0f) - at->cells[0][i] * 256;
        p->at[1][i] = (int32_t)(at->y[i] * 256.0f) - at->cells[1][i] * 256;
    }
    for (int i = 0; i < COUNT; i++) {
        const int32_t level = at->level[i], up = level < common ? common - level : 0;
        const uint64_t x = (uint64_t)(uint32_t)(at->cells[0][i] >> up), y = (uint64_t)(uint32_t)(at->cells[1][i] >> up);
        const uint64_t class = p->key[i] >> PM__PLOT_IMPORTANT_AT & 0x7e;
        p->shard[i] = (uint32_t)(pm__plot_hash(x << 32 | y << 8 | class) >> (64 - PM__PLOT_SHARD_BITS));
    }
}

/* The next level that each is nearer to: none in the middle of its own, and only one of the same shard. */
static inline void go_beside(const pm__plot_frame *f, cuts *at, uint64_t *is_any)
{
    const int32_t least = f->least, common = f->common;
    for (int i = 0; i < COUNT; i++) {
        const float fill = at->fill[i];
        const int32_t level = at->level[i], next = fill > 1.0f ? level - 1 : level + 1;
        const int32_t is_middle = fill < PM__PLOT_MIDDLE ? (fill * PM__PLOT_MIDDLE > 1.0f ? 1 : 0) : 0;
        const int32_t is_in = (next >= least ? 1 : 0) & (next <= common ? 1 : 0) & (level <= common ? 1 : 0);
        is_any[i] = (uint64_t)(uint32_t)(is_in & (1 - is_middle));
        at->level[i] = next;
    }
}

static inline void find_areas(const pm__plot_frame *f, const cuts *at, const cones *c, pm__plot_points *p)
{
    static const float less = PM__PLOT_LESS;
    const float usual = f->area;
    for (int i = 0; i < COUNT; i++) {
        const float area = usual * two_to(2 * (at->level[i] - PM__PLOT_USUAL)) / fabsf(c->longest[i]);
        p->area[i] = area;
        p->wanted[i] = p->required[i] * area * less;
    }
}

static void cut_plots(const pm__plot_frame *frame, pm__plot_points *p)
{
    cones c;
    cuts at;
    cut_normals((const float(*)[COUNT])p->normal, &c);
    uint32_t cone[COUNT];
    uint64_t is_any[COUNT], others[COUNT];
    number_cones(&c, cone);
    find_levels(frame, p, &at);
    find_places(frame, p, &c, &at);
    make_keys(cone, p, &at, p->key);
    find_shards(frame, &at, p);
    find_areas(frame, &at, &c, p);
    go_beside(frame, &at, is_any);
    find_places(frame, p, &c, &at);
    make_keys(cone, p, &at, others);
    for (int i = 0; i < COUNT; i++)
        p->beside[i] = others[i] & -is_any[i];
}
