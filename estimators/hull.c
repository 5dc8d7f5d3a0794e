/* The convex hull estimate, [C02] 5.5.4 (errata 8, 9): the flux of the photons inside the hull and a share of those
 * on its boundary, over the hull's area. The hull follows the lit surface, so edges do not darken.
 *
 * For random photons the share must be 0 (theorem T1); the course's 20 % suits stratified ones. A lookup that is cut
 * by its radius uses the hull of what was found.
 *
 * Method. Offsets are projected on the tangent plane. The extreme photons in eight directions span an octagon;
 * whatever lies strictly inside it is inside the hull, and a disc inside the octagon settles most of that by one
 * comparison. The few photons left are sorted, and Andrew's monotone chains found among them ("Another efficient
 * algorithm for convex hulls in two dimensions", 1979). O(k), and O(m^1.5) at worst for the m that are left.
 *
 * Which side of a line a point lies on comes out exactly whenever the differences of coordinates are exact in double
 * (see turn): under a normal along an axis always for floats within 28 binary orders of each other. Then collinear
 * and coinciding photons are counted as such; other normals round the projections by some 1e-16. */
#include "../src/base/vec3.h"
#include "kernel.h"

enum { BOUNDARY, OUTSIDE };
enum { KEEP, ZERO };

static const pm__param params[] = {
    {"boundary", PM__REAL, 0.2, 0, 1, "", NULL,
     "share of the boundary's photons that counts: 0 is unbiased for random photons, 0.2 suits stratified ones"},
    {"outside", PM__CHOICE, KEEP, 0, 0, "", "keep|zero", "the estimate where the query point is outside the hull"}};

typedef struct point {
    double x, y;
} point;

typedef struct node {
    point at;
    uint32_t photon;
    bool boundary;
} node;

/* Working memory: nodes, then the chain's stack. */
enum { SCRATCH_PER_PHOTON = sizeof(node) + sizeof(size_t) };

enum { DIRECTIONS = 8 };

/* The distinct extreme points, counterclockwise, and a disc inside their polygon (inner2 < 0: none). */
typedef struct octagon {
    point corner[DIRECTIONS];
    size_t count;
    double width; /* of the bounding box, the larger */
    point centre;
    double inner2;
} octagon;

static bool same(point a, point b)
{
    return a.x == b.x && a.y == b.y;
}

/* Is c strictly left of the line from a to b? Never wrongly yes if differences are exact: rounding is monotone, so
 * unequal rounded products are in the order of the exact ones. */
static inline bool is_left(point a, point b, point c)
{
    return (b.x - a.x) * (c.y - a.y) > (b.y - a.y) * (c.x - a.x);
}

/* Twice the area of a, b, c, positive counterclockwise; its sign is exact if differences are exact: where the rounded
 * products are equal the errors of their rounding, which fma gives exactly, decide. */
static inline double turn(point a, point b, point c)
{
    const double abx = b.x - a.x, aby = b.y - a.y, acx = c.x - a.x, acy = c.y - a.y;
    const double left = abx * acy, right = aby * acx;
    if (left != right)
        return left - right;
    return fma(abx, acy, -left) - fma(aby, acx, -right);
}

static void project(const pm__lookup *lookup, node *nodes)
{
    const pm__neighbors *set = &lookup->sets[0];
    double n[3] = {(double)lookup->normal[0], (double)lookup->normal[1], (double)lookup->normal[2]}, s[3], t[3];
    pm__normalize(n);
    pm__basis(n, s, t);
    for (size_t i = 0; i < set->count; i++) {
        const double o[3] = {(double)set->offset[i][0], (double)set->offset[i][1], (double)set->offset[i][2]};
        nodes[i] = (node){.at = {pm__dot(s, o), pm__dot(t, o)}, .photon = (uint32_t)i};
    }
}

/* One scan for the points farthest along x, x+y, y, y-x and against them. */
static void find_corners(const node *nodes, size_t count, octagon *o)
{
    double high[4], low[4];
    size_t highest[4] = {0}, lowest[4] = {0};
    for (int d = 0; d < 4; d++) {
        high[d] = -INFINITY;
        low[d] = INFINITY;
    }
    for (size_t i = 0; i < count; i++) {
        const point p = nodes[i].at;
        const double along[4] = {p.x, p.x + p.y, p.y, p.y - p.x};
        for (int d = 0; d < 4; d++) {
            if (along[d] > high[d]) {
                high[d] = along[d];
                highest[d] = i;
            }
            if (along[d] < low[d]) {
                low[d] = along[d];
                lowest[d] = i;
            }
        }
    }
    o->count = 0;
    o->width = fmax(high[0] - low[0], high[2] - low[2]);
    for (int d = 0; d < DIRECTIONS; d++) {
        const point p = nodes[d < 4 ? highest[d] : lowest[d - 4]].at;
        if (!o->count || !(same(p, o->corner[o->count - 1]) || same(p, o->corner[0])))
            o->corner[o->count++] = p;
    }
}

static void find_inner_disc(octagon *o)
{
    double x = 0.0, y = 0.0, inner = INFINITY;
    for (size_t i = 0; i < o->count; i++) {
        x += o->corner[i].x;
        y += o->corner[i].y;
    }
    o->centre = (point){x / (double)o->count, y / (double)o->count};
    for (size_t i = 0; i < o->count; i++) {
        const point a = o->corner[i], b = o->corner[(i + 1) % o->count];
        inner = fmin(inner, turn(a, b, o->centre) / hypot(b.x - a.x, b.y - a.y));
    }
    inner *= 1.0 - 1e-9; /* its own rounding */
    o->inner2 = o->count > 2 && inner > 0.0 ? inner * inner : -1.0;
}

/* Strictly inside? */
static bool is_inside(const octagon *o, point p)
{
    const double x = p.x - o->centre.x, y = p.y - o->centre.y;
    if (x * x + y * y < o->inner2)
        return true;
    point a = o->corner[o->count - 1];
    for (size_t i = 0; i < o->count; i++) {
        if (!is_left(a, o->corner[i], p))
            return false;
        a = o->corner[i];
    }
    return true;
}

static void add_flux(const pm__neighbors *set, size_t photon, double sum[3])
{
    for (int c = 0; c < 3; c++)
        sum[c] += (double)set->flux[photon][c];
}

/* Adds the flux of photons inside to sum and moves the others to the front; returns how many they are. */
static size_t discard_inside(const pm__neighbors *set, const octagon *o, node *nodes, double sum[3])
{
    size_t left = 0;
    for (size_t i = 0; i < set->count; i++)
        if (is_inside(o, nodes[i].at))
            add_flux(set, nodes[i].photon, sum);
        else
            nodes[left++] = nodes[i];
    return left;
}

static bool before(point a, point b)
{
    return a.x < b.x || (a.x == b.x && a.y < b.y);
}

/* By x, then y. Shell's method: in place, and quick for the few dozen nodes that there are. */
static void sort(node *nodes, size_t count)
{
    size_t gap = 1;
    while (gap < count / 3)
        gap = 3 * gap + 1;
    for (; gap; gap /= 3)
        for (size_t i = gap; i < count; i++) {
            const node moved = nodes[i];
            size_t j = i;
            for (; j >= gap && before(moved.at, nodes[j - gap].at); j -= gap)
                nodes[j] = nodes[j - gap];
            nodes[j] = moved;
        }
}

/* The lower chain, or from the right end back to the left one the upper: marks its nodes, those on its edges too, and
 * returns twice the area between it and the chord, *outside set where the query point is beyond it. Of nodes that
 * coincide only the first takes part. */
static double chain(node *nodes, size_t count, bool upper, size_t *stack, bool *outside)
{
    size_t top = 0;
    for (size_t step = 0; step < count; step++) {
        const size_t i = upper ? count - 1 - step : step;
        if (i && same(nodes[i].at, nodes[i - 1].at))
            continue;
        while (top > 1 && turn(nodes[stack[top - 2]].at, nodes[stack[top - 1]].at, nodes[i].at) < 0.0)
            top--;
        stack[top++] = i;
    }
    double area = 0.0;
    for (size_t i = 0; i < top; i++) {
        const point b = nodes[stack[i]].at, a = nodes[stack[i ? i - 1 : 0]].at;
        nodes[stack[i]].boundary = true;
        area += turn(nodes[stack[0]].at, a, b);
        *outside |= turn(a, b, (point){0.0, 0.0}) < 0.0;
    }
    return area;
}

static pm_status estimate(const double *values, const pm__lookup *lookup, double result[3])
{
    const pm__neighbors *set = &lookup->sets[0];
    if (set->count < 3)
        return PM_EDEGENERATE;
    if (!lookup->scratch || lookup->scratch_size / SCRATCH_PER_PHOTON < set->count)
        return PM_EINVAL;
    node *const nodes = lookup->scratch;
    octagon o;
    double inside[3] = {0.0, 0.0, 0.0}, rim[3] = {0.0, 0.0, 0.0};
    project(lookup, nodes);
    find_corners(nodes, set->count, &o);
    if (o.count < 2)
        return PM_EDEGENERATE;
    find_inner_disc(&o);
    const size_t count = discard_inside(set, &o, nodes, inside);
    sort(nodes, count);

    bool outside = false;
    size_t *const stack = (size_t *)(void *)(nodes + set->count);
    double area = chain(nodes, count, false, stack, &outside);
    area = 0.5 * (area + chain(nodes, count, true, stack, &outside));
    /* The offsets' own rounding to float gives a straight line of photons up to this much. */
    if (!(area > 0x1p-23 * o.width * o.width))
        return PM_EDEGENERATE;
    for (size_t i = 0; i < count; i++) {
        if (i && same(nodes[i].at, nodes[i - 1].at))
            nodes[i].boundary = nodes[i - 1].boundary;
        add_flux(set, nodes[i].photon, nodes[i].boundary ? rim : inside);
    }
    const double divisor = area * lookup->unit * lookup->unit;
    for (int c = 0; c < 3; c++)
        result[c] = outside && values[OUTSIDE] == ZERO ? 0.0 : (inside[c] + values[BOUNDARY] * rim[c]) / divisor;
    return PM_OK;
}

/* Theorem T1; three photons have none inside. With outside=zero T1 leaves the chance that the hull of k-1 points around
 * the query holds it, which is Wendel's (1962) 1 - (k-1)/2^(k-2) wherever opposite directions are equally likely. */
static double uniform_mean(const double *values, size_t k, int dimensions)
{
    (void)dimensions;
    if (values[BOUNDARY] != 0.0)
        return NAN;
    if (k < 4)
        return 0.0;
    return values[OUTSIDE] == KEEP ? 1.0 : 1.0 - ((double)k - 1.0) * exp2(2.0 - (double)k);
}

static bool holds_at_edges(const double *values)
{
    return values[OUTSIDE] == KEEP;
}

const pm__estimator pm__estimator_hull = {
    .entry = {.name = "hull",
              .summary = "photons in their convex hull over its area: no dark edges; boundary=0 for random photons",
              .citation = "course 43, 5.5.4",
              .params = params,
              .param_count = 2},
    .needs = PM__OFFSETS,
    .dimensions = 4,
    .min_k = 3,
    .scratch_per_photon = SCRATCH_PER_PHOTON,
    .estimate = estimate,
    .uniform_mean = uniform_mean,
    .holds_at_edges = holds_at_edges,
};
