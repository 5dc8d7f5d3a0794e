/* [C02] 5.5.4: photons inside the convex hull in full, those on its boundary by a share, over the hull's area. */
#include "judge.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct corner {
    long double x, y;
    uint32_t index;
} corner;

static long double turn(const corner *a, const corner *b, long double x, long double y)
{
    return (b->x - a->x) * (y - a->y) - (b->y - a->y) * (x - a->x);
}

static int by_place(const void *left, const void *right)
{
    const corner *const a = left, *const b = right;
    if (a->x != b->x)
        return a->x < b->x ? -1 : 1;
    return a->y < b->y ? -1 : a->y > b->y;
}

/* Two directions at right angles in the plane: crosses with the axis that the normal is least along. */
static void span(const float normal[3], long double s[3], long double t[3])
{
    long double n[3], length = 0;
    int least = 0;
    for (int a = 0; a < 3; a++) {
        n[a] = (long double)normal[a];
        length += n[a] * n[a];
        least = fabsl(n[a]) < fabsl(n[least]) ? a : least;
    }
    long double axis[3] = {0, 0, 0}, across = 0;
    axis[least] = 1;
    for (int a = 0; a < 3; a++)
        n[a] /= sqrtl(length);
    for (int a = 0; a < 3; a++) {
        const int b = (a + 1) % 3, c = (a + 2) % 3;
        s[a] = n[b] * axis[c] - n[c] * axis[b];
        across += s[a] * s[a];
    }
    for (int a = 0; a < 3; a++)
        s[a] /= sqrtl(across);
    for (int a = 0; a < 3; a++)
        t[a] = n[(a + 1) % 3] * s[(a + 2) % 3] - n[(a + 2) % 3] * s[(a + 1) % 3];
}

static void project(const pm__judge_request *request, const pm__nears *set, corner *points)
{
    long double s[3], t[3];
    span(request->query->normal, s, t);
    for (size_t i = 0; i < set->count; i++) {
        const uint32_t index = set->near[i].index;
        points[i] = (corner){0, 0, index};
        for (int a = 0; a < 3; a++) {
            const long double d = (long double)request->photons[index].position[a] -
                                  (long double)request->query->position[a];
            points[i].x += s[a] * d;
            points[i].y += t[a] * d;
        }
    }
    qsort(points, set->count, sizeof *points, by_place);
}

/* One side of the hull behind the corners that are there: from left to right below, or back above. */
static size_t add_side(const corner *points, size_t count, bool back, corner *hull, size_t first)
{
    size_t top = first;
    for (size_t step = 0; step < count; step++) {
        const corner *const p = &points[back ? count - 1 - step : step];
        while (top > first + 1 && turn(&hull[top - 2], &hull[top - 1], p->x, p->y) <= 0)
            top--;
        if (top == first || by_place(&hull[top - 1], p) != 0)
            hull[top++] = *p;
    }
    return top - 1; /* its last is the other side's first */
}

typedef struct shape {
    corner *hull;
    size_t corners;
    long double area, products, width2; /* products: the sum of the magnitudes of the area's terms */
    long double blur;                   /* a turn of no more may be of either sign */
} shape;

static void find_area(shape *s, const corner *points, size_t count)
{
    long double low = INFINITY, high = -INFINITY;
    s->area = s->products = 0;
    for (size_t i = 0; i < s->corners; i++) {
        const corner *const a = &s->hull[i], *const b = &s->hull[(i + 1) % s->corners], *const o = &s->hull[0];
        s->area += turn(o, a, b->x, b->y) / 2;
        s->products += hypotl(a->x, a->y) * hypotl(b->x, b->y) / 2;
    }
    for (size_t i = 0; i < count; i++) {
        low = fminl(low, points[i].y);
        high = fmaxl(high, points[i].y);
    }
    const long double width = fmaxl(points[count - 1].x - points[0].x, high - low);
    s->width2 = width * width;
}

/* Is the point on the boundary? *clear: beyond doubt. */
static bool on_boundary(const shape *s, const corner *p, bool *clear)
{
    bool is_corner = false;
    long double least = INFINITY;
    for (size_t i = 0; i < s->corners; i++) {
        is_corner |= by_place(&s->hull[i], p) == 0;
        least = fminl(least, turn(&s->hull[i], &s->hull[(i + 1) % s->corners], p->x, p->y));
    }
    if (is_corner)
        return true;
    *clear &= !(s->blur > 0 && fabsl(least) <= s->blur);
    return least <= 0;
}

static bool holds_query(const shape *s, bool *clear)
{
    long double least = INFINITY;
    for (size_t i = 0; i < s->corners; i++)
        least = fminl(least, turn(&s->hull[i], &s->hull[(i + 1) % s->corners], 0, 0));
    *clear &= !(s->blur > 0 && fabsl(least) <= s->blur);
    return least >= 0;
}

static bool along_axis(const float normal[3])
{
    return (normal[0] != 0.0f) + (normal[1] != 0.0f) + (normal[2] != 0.0f) == 1;
}

/* A corner is one beyond doubt where it sticks out; one that hardly does may count as boundary or not, as points beside
 * an edge may. */
static bool corners_stick_out(const shape *s)
{
    for (size_t i = 0; i < s->corners; i++) {
        const corner *const a = &s->hull[i], *const c = &s->hull[(i + 2) % s->corners];
        const corner *const b = &s->hull[(i + 1) % s->corners];
        if (s->blur > 0 && turn(a, b, c->x, c->y) <= s->blur)
            return false;
    }
    return true;
}

static void sum_up(const pm__judge_request *request, const pm__nears *set, const corner *points, const shape *s,
                   pm__judged *judged)
{
    const double share = pm__spec_value(request->spec, "boundary", 0);
    const bool inside = holds_query(s, &judged->clear);
    const bool zero = pm__spec_value(request->spec, "outside", 0) == 1.0 && !inside;
    judged->clear &= corners_stick_out(s);
    for (size_t i = 0; i < set->count; i++) {
        const long double w = on_boundary(s, &points[i], &judged->clear) ? (long double)share : 1;
        for (int c = 0; c < 3; c++) {
            const long double flux = (long double)request->photons[points[i].index].power[c];
            judged->value[c] += zero ? 0 : w * flux / s->area;
            judged->magnitude[c] += w * fabsl(flux) / s->area * fmaxl(1, s->products / s->area);
        }
    }
}

/* The library calls flat what is no wider than the rounding of its offsets: photonmap.h, EDEGENERATE. */
static const long double flat = 0x1p-23L;

void pm__judge_hull(const pm__judge_request *request, const pm__nears *set, pm__judged *judged)
{
    corner *const points = calloc(set->count + 1, sizeof *points);
    shape s = {.hull = calloc(2 * set->count + 2, sizeof *s.hull)};
    judged->status = points && s.hull ? PM_EDEGENERATE : PM_ENOMEM;
    if (points && s.hull && set->count >= 3) {
        project(request, set, points);
        s.corners = add_side(points, set->count, false, s.hull, 0);
        s.corners = add_side(points, set->count, true, s.hull, s.corners);
        if (s.corners >= 3) {
            find_area(&s, points, set->count);
            s.blur = s.width2 * (request->rounds ? 1e-5L : along_axis(request->query->normal) ? 0 : 1e-12L);
            judged->clear &= !(fabsl(s.area / (flat * s.width2) - 1) < 0.5L);
            if (s.area > flat * s.width2) {
                judged->status = PM_OK;
                sum_up(request, set, points, &s, judged);
            }
        }
    }
    free(points);
    free(s.hull);
}
