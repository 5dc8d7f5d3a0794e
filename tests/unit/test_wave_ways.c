/* Ways to, from and between points on the wave: blocked where the straight line crosses it in between. Against the
 * height of the line over the wave in long double, as products next to ends on the wave: with P at the start,
 * f(s) = s (z_Q - z_P) + 2 a sin(k (x_P + s dx / 2)) sin(k s dx / 2). */
#include "../shapes.h"

/* HALVINGS: of the first of the steps next to an end on the wave. */
enum { WAYS = 2000, STEPS = 200, HALVINGS = 30 };

typedef struct end {
    double at[3];
    bool is_on; /* the wave */
} end;

typedef enum verdict { OPEN, BLOCKED, UNSURE } verdict;

/* The second end as seen from the first, s of the way along: m over the wave. */
static long double height(const pm__shape *w, const end *p, const end *q, long double s)
{
    const long double a = (long double)w->amplitude, k = (long double)w->wavenumber, x = (long double)p->at[0];
    const long double dx = (long double)q->at[0] - x;
    const long double crossed = 2.0L * a * sinl(k * (x + 0.5L * s * dx)) * sinl(0.5L * k * s * dx);
    const long double level = (long double)w->centre[2] + a * cosl(k * x);
    const long double from = p->is_on ? 0.0L : (long double)p->at[2] - level;
    /* Ends on the wave are where it is, not where double puts them. */
    const long double rise = q->is_on ? -from - 2.0L * a * sinl(k * (x + 0.5L * dx)) * sinl(0.5L * k * dx)
                                      : (long double)q->at[2] - level - from;
    return from + s * rise + crossed;
}

/* Samples from the first end to the middle. */
static size_t sample(const pm__shape *w, const end *p, const end *q, long double at[], long double f[], bool sure[])
{
    size_t count = 0;
    for (int i = p->is_on ? -HALVINGS : 0; i <= STEPS / 2; i++) {
        const long double s = p->is_on && i < 1 ? ldexpl(1.0L, i - 1) / STEPS : (long double)i / STEPS;
        at[count] = s;
        f[count] = height(w, p, q, s);
        sure[count] = fabsl(f[count]) > (p->is_on ? 1e-14L * s : 1e-13L);
        count++;
    }
    return count;
}

/* Surely on both sides: blocked. Surely on one, and nowhere so near that it may dip in between, by an eighth of what
 * the second derivative allows: open. */
static verdict brute(const pm__shape *w, const end *p, const end *q)
{
    static long double at[2][STEPS + HALVINGS], f[2][STEPS + HALVINGS];
    static bool sure[2][STEPS + HALVINGS];
    const long double way = (long double)w->wavenumber * (long double)(q->at[0] - p->at[0]);
    const long double bend = fabsl((long double)w->amplitude) * way * way;
    const size_t count[2] = {sample(w, p, q, at[0], f[0], sure[0]), sample(w, q, p, at[1], f[1], sure[1])};
    bool over = false, under = false, may_dip = false;
    for (int half = 0; half < 2; half++)
        for (size_t i = 0; i < count[half]; i++) {
            const long double step = i ? at[half][i] - at[half][i - 1] : 0.0L;
            const long double least = i ? fminl(fabsl(f[half][i]), fabsl(f[half][i - 1])) : INFINITY;
            over = over || (sure[half][i] && f[half][i] > 0.0L);
            under = under || (sure[half][i] && f[half][i] < 0.0L);
            may_dip = may_dip || !sure[half][i] || least < 0.126L * bend * step * step;
        }
    if (over && under)
        return BLOCKED;
    return may_dip ? UNSURE : OPEN;
}

/* ---- Ends ----------------------------------------------------------------------------------------- */

static end on_wave(const pm__shape *w, double x, double y)
{
    end e = {.at = {x, y, 0.0}, .is_on = true};
    double up[3];
    pm__shape_settle(w, e.at, up);
    return e;
}

/* Well within the rim, so that what is met lies within it too. */
static end random_end(const pm__shape *w, uint32_t trial, uint64_t number, bool is_on)
{
    double u[3];
    pm__random_uniform(7, PM__FOR_TESTS, trial, number, u, 3);
    const double x = 1.6 * (2.0 * u[0] - 1.0), y = 1.2 * (2.0 * u[1] - 1.0);
    if (is_on)
        return on_wave(w, x, y);
    return (end){.at = {x, y, w->centre[2] + 2.5 * w->amplitude * (2.0 * u[2] - 1.0)}};
}

/* On the tangent of the wave at the first end, `away` m along x, raised by `lift`. */
static end tangent_end(const pm__shape *w, const end *p, double away, double lift)
{
    const double k = w->wavenumber, slope = -w->amplitude * k * sin(k * p->at[0]);
    return (end){.at = {p->at[0] + away, p->at[1] + 0.1 * away, p->at[2] + slope * away + lift}};
}

typedef struct tally {
    int open, blocked, unsure;
} tally;

static uint32_t shape_of(const end *e)
{
    return e->is_on ? 0 : PM__NO_SHAPE;
}

/* The same there and back. */
static void check_way(const pm__scene *scene, const pm__shape *w, const end *p, const end *q, tally *all)
{
    const verdict want = brute(w, p, q);
    const bool there = pm__scene_blocked(scene, p->at, shape_of(p), q->at, shape_of(q));
    const bool back = pm__scene_blocked(scene, q->at, shape_of(q), p->at, shape_of(p));
    *(want == OPEN ? &all->open : want == BLOCKED ? &all->blocked : &all->unsure) += 1;
    ck_assert_msg(want == UNSURE || (there == (want == BLOCKED) && back == there),
                  "from (%.17g, %.17g, %.17g)%s to (%.17g, %.17g, %.17g)%s: %s, but %d, and back %d", p->at[0],
                  p->at[1], p->at[2], p->is_on ? " on it" : "", q->at[0], q->at[1], q->at[2],
                  q->is_on ? " on it" : "", want == OPEN ? "open" : "blocked", there, back);
}

static void check_tally(const char *what, const tally *all)
{
    const int sum = all->open + all->blocked + all->unsure;
    ck_assert_msg(all->open > sum / 50 && all->blocked > sum / 50 && all->unsure < sum / 10,
                  "%s: %d open, %d blocked, %d unsure", what, all->open, all->blocked, all->unsure);
}

/* ---- Ways ----------------------------------------------------------------------------------------- */

static const double waves[][2] = {{0.12, 8.0}, {-0.3, 3.0}, {0.01, 20.0}};
enum { WAVES = 3 };

START_TEST(test_random_ways)
{
    for (size_t v = 0; v < WAVES; v++) {
        pm__shape w = wave(waves[v][0], waves[v][1]);
        pm__scene *const scene = scene_of(&w, 1);
        for (int kind = 0; kind < 4; kind++) {
            tally all = {0};
            for (uint64_t i = 0; i < WAYS; i++) {
                const end p = random_end(&w, 40, i, kind & 1), q = random_end(&w, 41, i, kind & 2);
                check_way(scene, &w, &p, &q, &all);
            }
            check_tally("random ways", &all);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Between near points on the wave, down to a tenth of a micrometre: over a crest the chord lies under the wave,
 * and is open. */
START_TEST(test_short_ways)
{
    pm__shape w = wave(0.12, 8.0);
    pm__scene *const scene = scene_of(&w, 1);
    tally all = {0};
    for (uint64_t i = 0; i < WAYS; i++) {
        double u[2];
        pm__random_uniform(7, PM__FOR_TESTS, 42, i, u, 2);
        const end p = random_end(&w, 43, i, true);
        const end q = on_wave(&w, p.at[0] + 0.1 * pow(10.0, -6.0 * u[0]), p.at[1] + 0.1 * (u[1] - 0.5));
        check_way(scene, &w, &p, &q, &all);
    }
    ck_assert_msg(all.open > WAYS / 2 && all.unsure < WAYS / 4, "%d open, %d unsure", all.open, all.unsure);
    pm__scene_destroy(scene);
}
END_TEST

/* Along the tangent at an end, a little above or below: what leaves the wave grazing it. */
START_TEST(test_grazing_ways)
{
    for (size_t v = 0; v < WAVES; v++) {
        pm__shape w = wave(waves[v][0], waves[v][1]);
        pm__scene *const scene = scene_of(&w, 1);
        tally all = {0};
        for (uint64_t i = 0; i < WAYS; i++) {
            double u[3];
            pm__random_uniform(7, PM__FOR_TESTS, 44, i, u, 3);
            const end p = on_wave(&w, 1.2 * (2.0 * u[0] - 1.0), 0.3);
            const double away = (i % 2 ? 1.0 : -1.0) * 0.01 * pow(30.0, u[1]);
            const end q = tangent_end(&w, &p, away, (i % 4 < 2 ? 1.0 : -1.0) * fabs(away) * pow(10.0, -10.0 * u[2]));
            check_way(scene, &w, &p, &q, &all);
        }
        check_tally("grazing ways", &all);
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Points as far before as behind where the wave is at its mean: it crosses the way between them there, in the very
 * middle, where the marches from both ends meet. */
START_TEST(test_crossed_in_the_middle)
{
    for (size_t v = 0; v < WAVES; v++) {
        pm__shape w = wave(waves[v][0], waves[v][1]);
        pm__scene *const scene = scene_of(&w, 1);
        const double half = 3.14159265358979323846 / w.wavenumber;
        for (int i = 1; i <= WAYS; i++) {
            const double node = (0.5 + (double)(i % 3 - 2)) * half, off = 0.95 * half * i / WAYS;
            const end p = on_wave(&w, node - off, 0.1), q = on_wave(&w, node + off, 0.1 + 0.2 * (i % 2));
            const bool there = pm__scene_blocked(scene, p.at, 0, q.at, 0);
            ck_assert_msg(there || off < 1e-3 * half, "%g m to either side of %g: open", off, node);
            ck_assert_msg(pm__scene_blocked(scene, q.at, 0, p.at, 0) == there, "%g m beside %g: back", off, node);
        }
        pm__scene_destroy(scene);
    }
}
END_TEST

/* Along a crest, a trough or a flank, x the same at both ends: the way lies in the wave, and comes to an end. */
START_TEST(test_ways_in_the_surface)
{
    pm__shape w = wave(0.12, 8.0);
    pm__scene *const scene = scene_of(&w, 1);
    for (int i = -10; i <= 10; i++) {
        const double x = i * 3.14159265358979323846 / 8.0 / 4.0;
        const end p = on_wave(&w, x, -1.0), q = on_wave(&w, x, 1.1);
        ck_assert(!pm__scene_blocked(scene, p.at, 0, q.at, 0));
        ck_assert(!pm__scene_blocked(scene, q.at, 0, p.at, 0));
        const end beside = {.at = {x, 1.1, q.at[2] + 0.01}};
        ck_assert(!pm__scene_blocked(scene, p.at, 0, beside.at, PM__NO_SHAPE));
        ck_assert(!pm__scene_blocked(scene, beside.at, PM__NO_SHAPE, p.at, 0));
    }
    pm__scene_destroy(scene);
}
END_TEST

PM_TEST_MAIN("wave ways", test_random_ways, test_short_ways, test_grazing_ways, test_crossed_in_the_middle,
             test_ways_in_the_surface)
