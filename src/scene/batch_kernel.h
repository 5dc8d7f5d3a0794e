/* The loops of batch.h in the width PM__LANES, which the Makefile compiles this for. What is written for one photon is
 * done to PM__LANES at once: no branches, and each does what pm__shape_meet, pm__shape_settle and pm__scatter do. */
#include "batch.h"

#include "../base/random_lanes.h"
#include "query.h"
#include "wave.h"

/* All of them, to whole registers. */
static inline size_t whole(const pm__batch *b)
{
    return (b->count + 7) / 8 * 8;
}

static void draw(pm__batch *b, uint64_t seed, uint32_t trial, uint32_t block, double u[3][PM__BATCH])
{
    pm__random_triples(seed, PM__FOR_TRACING, trial, block, b->number, b->count, u[0], PM__BATCH);
}

/* ---- Rays --------------------------------------------------------------------------------------- */

/* What is not finite reaches nowhere. */
static void begin(pm__batch *b)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
        double sum = 0.0;
        for (int axis = 0; axis < 3; axis++)
            sum += b->origin[axis][i] - b->origin[axis][i] + b->direction[axis][i];
        b->distance[i] = sum - sum == 0.0 ? (double)INFINITY : -1.0;
        b->place[i] = PM__MOST_KEPT;
    }
}

static void meet_flat(pm__batch *b, const pm__shape *shape, int64_t number, int64_t place)
{
    const size_t count = whole(b);
    const bool is_disc = shape->kind == PM__SHAPE_DISC;
    const double reach = shape->radius + shape->slack, square = is_disc ? reach * reach : (double)INFINITY;
    const double none[3] = {0.0, 0.0, 0.0};
    const double *const u = is_disc ? none : shape->dual[0], *const v = is_disc ? none : shape->dual[1];
    const double margin[2] = {is_disc ? 0.0 : shape->margin[0], is_disc ? 0.0 : shape->margin[1]};
    const double n[3] = {shape->normal[0], shape->normal[1], shape->normal[2]};
    const double c[3] = {shape->centre[0], shape->centre[1], shape->centre[2]};
    const double u0 = u[0], u1 = u[1], u2 = u[2], v0 = v[0], v1 = v[1], v2 = v[2];
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
        const double dx = b->direction[0][i], dy = b->direction[1][i], dz = b->direction[2][i];
        double x = b->origin[0][i] - c[0], y = b->origin[1][i] - c[1], z = b->origin[2][i] - c[2];
        const double t = -(n[0] * x + n[1] * y + n[2] * z) / (n[0] * dx + n[1] * dy + n[2] * dz);
        x += t * dx;
        y += t * dy;
        z += t * dz;
        const double along = u0 * x + u1 * y + u2 * z, across = v0 * x + v1 * y + v2 * z;
        const bool met = (t > 0.0) & (t < b->distance[i]) & (along >= -margin[0]) & (along <= 1.0 + margin[0]) &
                         (across >= -margin[1]) & (across <= 1.0 + margin[1]) & (x * x + y * y + z * z <= square) &
                         (b->from[i] != number);
        b->distance[i] = met ? t : b->distance[i];
        b->place[i] = met ? place : b->place[i];
    }
}

/* The two ends of a line within a circle or sphere, as round_roots of shapes.c has them. */
typedef struct chord {
    double first, second;
    double apart; /* where a ray that leaves the shape meets it again */
    bool is_met;  /* not looked at for such a ray */
} chord;

PM__INLINE chord chord_of(double radius, const double to[3], const double d[3])
{
    const double along = pm__dot(to, d);
    const double off[3] = {to[0] - along * d[0], to[1] - along * d[1], to[2] - along * d[2]};
    const double square = pm__dot(off, off), miss = sqrt(square);
    const double discriminant = (radius - miss) * (radius + miss);
    const double far = along + copysign(sqrt(discriminant), along), from_centre = sqrt(pm__dot(to, to));
    const double ratio = (from_centre - radius) * (from_centre + radius) / far, other = far != 0.0 ? ratio : 0.0;
    return (chord){.first = far < other ? far : other,
                   .second = far < other ? other : far,
                   .apart = 2.0 * along,
                   .is_met = (discriminant >= 0.0) & (square <= 1.001 * radius * radius)};
}

PM__INLINE void take(pm__batch *b, size_t i, bool met, double t, int64_t place)
{
    b->distance[i] = met ? t : b->distance[i];
    b->place[i] = met ? place : b->place[i];
}

PM__INLINE void meet_sphere_by(pm__batch *b, size_t i, const pm__shape *shape, int64_t number, int64_t place)
{
    const double d[3] = {b->direction[0][i], b->direction[1][i], b->direction[2][i]}, *const c = shape->centre;
    const double to[3] = {c[0] - b->origin[0][i], c[1] - b->origin[1][i], c[2] - b->origin[2][i]};
    const chord through = chord_of(shape->radius, to, d);
    const double outer = through.first > 0.0 ? through.first : through.second;
    const bool leaves = b->from[i] == number, again = leaves & (through.apart > shape->slack);
    const double t = leaves ? through.apart : outer;
    take(b, i, (t > 0.0) & (t < b->distance[i]) & (again | (!leaves & through.is_met)), t, place);
}

/* Not where rays run almost along the axis: returns whether that is so. */
PM__INLINE bool meet_cylinder_by(pm__batch *b, size_t i, const pm__shape *shape, int64_t number, int64_t place)
{
    const double dx = b->direction[0][i], dy = b->direction[1][i], square = dx * dx + dy * dy + 0.0 * 0.0;
    const double speed = sqrt(square), plan[3] = {dx / speed, dy / speed, 0.0};
    const double to[3] = {shape->centre[0] - b->origin[0][i], shape->centre[1] - b->origin[1][i], 0.0};
    const chord through = chord_of(shape->radius, to, plan);
    const bool leaves = b->from[i] == number, again = leaves & (through.apart > shape->slack);
    const bool is_near = (square > 1e-200) & (square < 1e200), passes = !leaves & through.is_met;
    const double root[2] = {leaves ? through.apart : through.first, through.second};
    double t[2];
    bool met[2];
    for (int k = 0; k < 2; k++) {
        t[k] = root[k] / speed;
        const double x = root[k] * plan[0] - to[0], z = b->origin[2][i] + t[k] * b->direction[2][i];
        met[k] = (t[k] > 0.0) & (t[k] < b->distance[i]) & (z >= shape->low - shape->slack) &
                 (z <= shape->high + shape->slack) & (x >= shape->from * shape->radius - shape->slack);
    }
    const bool first = met[0] & (again | passes), second = met[1] & passes;
    take(b, i, is_near & (first | second), first ? t[0] : t[1], place);
    return !is_near;
}

static void meet_sphere(pm__batch *b, const pm__shape *shape, int64_t number, int64_t place)
{
    const size_t count = whole(b);
    const pm__shape sphere = *shape;
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        meet_sphere_by(b, i, &sphere, number, place);
}

static bool meet_cylinder(pm__batch *b, const pm__shape *shape, int64_t number, int64_t place)
{
    const size_t count = whole(b);
    const pm__shape cylinder = *shape;
    uint64_t left = 0;
#pragma omp simd reduction(| : left)
    for (size_t i = 0; i < count; i++)
        left |= meet_cylinder_by(b, i, &cylinder, number, place);
    return left;
}

/* Rays that march over a wave together: enough to hide what a step waits for, few enough that none waits for many. */
enum { PM__MARCHING = 32 };

typedef struct marches {
    _Alignas(64) double climb[PM__MARCHING], lift[PM__MARCHING], bend[PM__MARCHING], turns[PM__MARCHING];
    double last[PM__MARCHING], tolerance[PM__MARCHING], least[PM__MARCHING];
    double t[PM__MARCHING], height[PM__MARCHING], sine[PM__MARCHING], cosine[PM__MARCHING], side[PM__MARCHING];
    uint64_t goes_on[PM__MARCHING], is_root[PM__MARCHING];
} marches;

PM__INLINE uint64_t begin_march(const pm__batch *b, size_t i, const pm__shape *shape, int64_t number, size_t j,
                                marches *all)
{
    const double o[3] = {b->origin[0][i], b->origin[1][i], b->origin[2][i]};
    const double d[3] = {b->direction[0][i], b->direction[1][i], b->direction[2][i]};
    pm__above over;
    const pm__march m = pm__wave_begin(shape, o, d, b->distance[i], b->from[i] == number, &over);
    all->climb[j] = over.climb;
    all->lift[j] = over.lift;
    all->bend[j] = over.bend;
    all->turns[j] = over.turns;
    all->last[j] = over.last;
    all->tolerance[j] = over.tolerance;
    all->least[j] = over.least;
    all->t[j] = m.t;
    all->height[j] = m.height;
    all->sine[j] = m.sine;
    all->cosine[j] = m.cosine;
    all->side[j] = m.side;
    all->goes_on[j] = m.goes_on;
    all->is_root[j] = 0;
    return m.goes_on;
}

/* What goes on no longer is computed with, and stays. */
PM__INLINE uint64_t march_on(size_t j, double amplitude, marches *all)
{
    const pm__above over = {.climb = all->climb[j], .lift = all->lift[j], .bend = all->bend[j], .turns = all->turns[j],
                            .last = all->last[j], .tolerance = all->tolerance[j], .least = all->least[j]};
    pm__march m = {.t = all->t[j], .height = all->height[j], .sine = all->sine[j], .cosine = all->cosine[j],
                   .side = all->side[j]};
    pm__wave_step(&over, amplitude, &m);
    const bool goes = all->goes_on[j];
    all->t[j] = goes ? m.t : all->t[j];
    all->height[j] = m.height;
    all->sine[j] = m.sine;
    all->cosine[j] = m.cosine;
    all->side[j] = m.side;
    all->is_root[j] = goes ? m.is_root : all->is_root[j];
    all->goes_on[j] = goes ? m.goes_on : 0;
    return all->goes_on[j];
}

static void meet_wave(pm__batch *b, const pm__shape *shape, int64_t number, int64_t place)
{
    const size_t count = whole(b);
    const pm__shape wave = *shape;
    marches all;
    for (size_t first = 0; first < count; first += PM__MARCHING) {
        const size_t some = count - first < PM__MARCHING ? count - first : PM__MARCHING;
        uint64_t any = 0;
#pragma omp simd reduction(| : any)
        for (size_t j = 0; j < some; j++)
            any |= begin_march(b, first + j, &wave, number, j, &all);
        while (any) {
            any = 0;
#pragma omp simd reduction(| : any)
            for (size_t j = 0; j < some; j++)
                any |= march_on(j, wave.amplitude, &all);
        }
#pragma omp simd
        for (size_t j = 0; j < some; j++)
            take(b, first + j, all.is_root[j] & (all.t[j] < b->distance[first + j]), all.t[j], place);
    }
}

/* The corners of a box, padded or not. */
typedef struct box {
    double low[3], high[3];
} box;

/* The distances at which the ray is within. rate: one over its direction. */
PM__INLINE void cross_box(const pm__batch *b, size_t i, const double rate[3], const box *around, double *enter,
                          double *leave)
{
    *enter = 0.0;
    *leave = b->distance[i];
    for (int axis = 0; axis < 3; axis++)
        pm__slab_cut(b->origin[axis][i], rate[axis], around->low[axis], around->high[axis], enter, leave);
}

/* Within the box of all shapes, padded or not. */
PM__INLINE void cut_at(pm__batch *b, size_t i, const box *padded, const box *all)
{
    double enter, leave, rate[3];
    bool is_within = true;
    for (int axis = 0; axis < 3; axis++) {
        is_within = is_within & (b->origin[axis][i] >= all->low[axis]) & (b->origin[axis][i] <= all->high[axis]);
        b->rate[axis][i] = rate[axis] = 1.0 / b->direction[axis][i];
    }
    cross_box(b, i, rate, padded, &enter, &leave);
    b->may[i] = (is_within | (enter <= leave)) & (b->distance[i] > 0.0);
    b->asks[i] = 0;
    b->enter[i] = is_within ? 0.0 : enter;
    b->leave[i] = is_within ? b->distance[i] : leave;
}

/* may_meet of rays.c. */
PM__INLINE void ask_at(pm__batch *b, size_t i, const box *around, const double *along, const pm__held *held)
{
    double enter, leave;
    const double rate[3] = {b->rate[0][i], b->rate[1][i], b->rate[2][i]};
    cross_box(b, i, rate, around, &enter, &leave);
    const bool is_on = (b->from[i] >= held->first) & (b->from[i] < held->end);
    const bool is_off = is_on & (fabs(along[i]) > held->steep);
    b->asks[i] |= b->may[i] & (enter <= leave) & !is_off;
}

static box padded_box(const double low[3], const double high[3], double padding)
{
    return (box){{low[0] - padding, low[1] - padding, low[2] - padding},
                 {high[0] + padding, high[1] + padding, high[2] + padding}};
}

static void cut(pm__batch *b, const pm__scene *scene)
{
    const size_t count = whole(b);
    const double padding = PM__PADDING * scene->extent;
    const box padded = padded_box(scene->low, scene->high, padding), all = padded_box(scene->low, scene->high, 0.0);
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        cut_at(b, i, &padded, &all);
    for (size_t k = 0; k < scene->held_count; k++) {
        const pm__held held = scene->held[k];
        const box around = padded_box(held.low, held.high, padding);
        const double *const along = b->direction[held.axis];
#pragma omp simd
        for (size_t i = 0; i < count; i++)
            ask_at(b, i, &around, along, &held);
    }
}

/* Of round shapes, whose plane is none, the position is left to be moved onto the shape. */
static void settle(pm__batch *b, const pm__few *few)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
        const int64_t at = b->place[i];
        double position[3], off = 0.0;
        for (int axis = 0; axis < 3; axis++) {
            position[axis] = b->origin[axis][i] + b->distance[i] * b->direction[axis][i];
            off += (position[axis] - few->corner[axis][at]) * few->normal[axis][at];
        }
        for (int axis = 0; axis < 3; axis++) {
            b->normal[axis][i] = few->normal[axis][at];
            b->position[axis][i] = position[axis] - off * few->normal[axis][at];
        }
        b->shape[i] = few->shape[at];
        b->material[i] = few->material[at];
    }
}

/* Onto spheres and cylinders, as settle_round of shapes.c. */
PM__INLINE void settle_round_at(pm__batch *b, size_t i, const pm__few *few)
{
    const int64_t at = b->place[i];
    const double radius = few->radius[at], sign = few->sign[at];
    const bool is_round = radius > 0.0, is_sphere = few->axes[at] > 2;
    double position[3], normal[3];
    for (int axis = 0; axis < 3; axis++) {
        position[axis] = b->position[axis][i];
        normal[axis] = axis < 2 || is_sphere ? position[axis] - few->centre[axis][at] : 0.0;
    }
    const double length = sqrt(pm__dot(normal, normal));
    for (int axis = 0; axis < 3; axis++) {
        const double up = normal[axis] / length, on = few->centre[axis][at] + radius * up;
        const double facing = axis < 2 || is_sphere ? sign * up : up;
        b->position[axis][i] = is_round && (axis < 2 || is_sphere) ? on : position[axis];
        b->normal[axis][i] = is_round ? facing : b->normal[axis][i];
    }
}

static void settle_round(pm__batch *b, const pm__few *few)
{
    const size_t count = whole(b);
#pragma omp simd
    for (size_t i = 0; i < count; i++)
        settle_round_at(b, i, few);
}

/* Onto a wave, those that have met it. */
static void settle_wave(pm__batch *b, const pm__shape *shape, int64_t place)
{
    const size_t count = whole(b);
    const pm__shape wave = *shape;
#pragma omp simd
    for (size_t i = 0; i < count; i++) {
        const bool is_its = b->place[i] == place;
        double position[3] = {b->position[0][i], b->position[1][i], b->position[2][i]}, normal[3];
        pm__wave_settle(&wave, position, normal);
        b->position[2][i] = is_its ? position[2] : b->position[2][i];
        for (int axis = 0; axis < 3; axis++)
            b->normal[axis][i] = is_its ? normal[axis] : b->normal[axis][i];
    }
}
