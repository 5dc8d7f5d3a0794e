/* The hull estimate against the definition of a hull: every line through two photons is tried, in whole numbers. */
#include "../neighborhood.h"

static hood h;
static stream random_numbers = {12, 0, 0};

typedef struct whole {
    long long x, y;
} whole;

static long long cross(whole a, whole b, whole c)
{
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

static bool equal(whole a, whole b)
{
    return a.x == b.x && a.y == b.y;
}

/* What the definition says of a set of points. */
typedef struct brute {
    bool boundary[HOOD_MAX];
    long long area2, width;
    bool outside; /* the origin */
} brute;

/* A point is on the boundary if some line through it and another has all points on one side. */
static void brute_hull(const whole *p, size_t n, brute *b)
{
    const whole origin = {0, 0};
    whole low = p[0], high = p[0];
    memset(b, 0, sizeof *b);
    for (size_t i = 0; i < n; i++) {
        low.x = p[i].x < low.x ? p[i].x : low.x;
        low.y = p[i].y < low.y ? p[i].y : low.y;
        high.x = p[i].x > high.x ? p[i].x : high.x;
        high.y = p[i].y > high.y ? p[i].y : high.y;
        bool new = true; /* of points that coincide the first stands for all in the area */
        for (size_t j = 0; j < i; j++)
            new &= !equal(p[i], p[j]);
        for (size_t j = 0; j < n; j++) {
            bool supports = !equal(p[i], p[j]), whole_edge = new;
            for (size_t k = 0; k < n && supports; k++) {
                const long long side = cross(p[i], p[j], p[k]);
                supports = side >= 0;
                /* Is k on the line, but before i or beyond j? */
                const long long dx = p[j].x - p[i].x, dy = p[j].y - p[i].y;
                const long long along = dx * (p[k].x - p[i].x) + dy * (p[k].y - p[i].y);
                whole_edge &= side != 0 || (along >= 0 && along <= dx * dx + dy * dy);
            }
            for (size_t k = 0; k < j && supports; k++)
                whole_edge &= !equal(p[k], p[j]);
            if (!supports)
                continue;
            b->boundary[i] = true;
            b->outside |= cross(p[i], p[j], origin) < 0;
            if (whole_edge)
                b->area2 += p[i].x * p[j].y - p[i].y * p[j].x;
        }
    }
    b->width = high.x - low.x > high.y - low.y ? high.x - low.x : high.y - low.y;
}

/* Checks both choices of `outside`; returns whether there was a hull. */
static bool check_hull(const whole *p, size_t n)
{
    static brute b;
    const subject keep = subject_of("hull:boundary=0.3"), zero = subject_of("hull:boundary=0.3,outside=zero");
    const double unit = exp2((double)below(&random_numbers, 9) - 4.0);
    hood_init(&h, 2);
    h.lookup.unit = unit;
    for (size_t i = 0; i < n; i++) {
        hood_add(&h, (double)p[i].x, (double)p[i].y);
        h.flux[i][0] = (float)(1 + below(&random_numbers, 1000));
    }
    brute_hull(p, n, &b);
    double flux = 0.0, result[3];
    for (size_t i = 0; i < n; i++)
        flux += (double)h.flux[i][0] * (b.boundary[i] ? 0.3 : 1.0);
    const double area = 0.5 * (double)b.area2 * unit * unit;
    const pm_status status = keep.estimator->estimate(keep.spec.values, &h.lookup, result);
    if (0.5 * (double)b.area2 <= 0x1p-23 * (double)b.width * (double)b.width) {
        ck_assert_int_eq(status, PM_EDEGENERATE);
        return false;
    }
    ck_assert_int_eq(status, PM_OK);
    PM_CHECK_NEAR(result[0] * area / flux, 1.0, 1e-13);
    PM_CHECK_NEAR(estimate_of(&zero, &h.lookup), b.outside ? 0.0 : result[0], 0.0);
    return true;
}

/* Coarse lattices are full of coinciding, collinear and cocircular points; fine ones have none. */
START_TEST(test_hull_on_lattices)
{
    static const size_t sides[] = {2, 3, 5, 11, 64, 1000, 1 << 20};
    static whole p[64];
    size_t hulls = 0, flat = 0;
    for (int trial = 0; trial < 6000; trial++) {
        const size_t side = sides[below(&random_numbers, 7)], n = 3 + below(&random_numbers, 45);
        const size_t squeeze = trial % 3 ? 1 : 1 + below(&random_numbers, 10);
        const long long shift = (long long)side / 2 - (trial % 2 ? (long long)below(&random_numbers, side) : 0);
        for (size_t i = 0; i < n; i++) {
            p[i].x = (long long)below(&random_numbers, side) - shift;
            p[i].y = (long long)below(&random_numbers, 1 + side / squeeze / squeeze) - shift;
        }
        if (check_hull(p, n))
            hulls++;
        else
            flat++;
    }
    ck_assert(hulls > 4000 && flat > 50);
}
END_TEST

/* Many points on the boundary at once: a parabola, a square's rim, a long line with one point aside. */
START_TEST(test_hull_all_boundary)
{
    static whole p[400];
    for (int i = 0; i < 300; i++)
        p[i] = (whole){i - 150, (long long)(i - 150) * (i - 150)};
    ck_assert(check_hull(p, 300));
    for (int i = 0; i < 300; i++) {
        const int along = i % 75;
        p[i] = i < 75    ? (whole){along, 0}
               : i < 150 ? (whole){75, along}
               : i < 225 ? (whole){75 - along, 75}
                         : (whole){0, 75 - along};
    }
    ck_assert(check_hull(p, 300));
    for (int i = 0; i < 299; i++)
        p[i] = (whole){3 * i - 100, 7 * i - 50};
    ck_assert(!check_hull(p, 299));
    p[299] = (whole){0, 100};
    ck_assert(check_hull(p, 300));
}
END_TEST

/* The middle point is off the line through the first two by an area of 1 among products of 2^57, where doubles are 16
 * apart: outside the triangle with the fourth on one side, inside with it on the other, never on the edge. */
START_TEST(test_hull_orientation_is_exact)
{
    const long long big = 1LL << 29;
    for (int mirror = 0; mirror < 2; mirror++)
        for (int side = -1; side <= 1; side += 2) {
            whole p[] = {{-big, 1}, {1, big}, {-big / 2, big / 2}, {side * big, -side * big}};
            ck_assert_int_eq(cross(p[0], p[1], p[2]), -1);
            for (int i = 0; i < 4 && mirror; i++)
                p[i] = (whole){p[i].y, p[i].x};
            ck_assert(check_hull(p, 4));
        }
}
END_TEST

PM_TEST_MAIN("hull against brute force", test_hull_on_lattices, test_hull_all_boundary,
             test_hull_orientation_is_exact)
