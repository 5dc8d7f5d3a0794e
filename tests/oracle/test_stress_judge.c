/* The judge of `stress` against the same formulas in 256 bits, on small sets: its own rounding, some 2^-60, must not
 * show in rows whose unit is 2^-53. Written apart from it: a hull's edges are pairs with all others to their left. */
#include "../../src/stress/hood.h"
#include "../../src/stress/judge.h"

#include "../../estimators/estimator.h"
#include "../test.h"

#include <mpfr.h>
#include <stdio.h>
#include <string.h>

enum { BITS = 256, MOST = 60 };

static pm_photon photons[PM__HOOD_MOST];
static pm__hood hood = {.photons = photons};

/* Numbers of 256 bits by slot, so that formulas stay short. */
typedef struct number {
    mpfr_t v;
} number;

static void from(mpfr_t out, double value)
{
    mpfr_set_d(out, value, MPFR_RNDN);
}

/* ---- Distances --------------------------------------------------------------------------------- */

static void square_of(mpfr_t out, size_t i)
{
    mpfr_t d;
    mpfr_init2(d, BITS);
    mpfr_set_zero(out, 1);
    for (int a = 0; a < 3; a++) {
        from(d, (double)hood.photons[i].position[a]);
        mpfr_sub_d(d, d, (double)hood.query.position[a], MPFR_RNDN);
        mpfr_sqr(d, d, MPFR_RNDN);
        mpfr_add(out, out, d, MPFR_RNDN);
    }
    mpfr_clear(d);
}

/* Indices by distance, then index: the k nearest, or all within the radius. */
static size_t nearest(number *d2, size_t order[MOST])
{
    size_t count = 0;
    for (size_t i = 0; i < hood.count; i++) {
        square_of(d2[i].v, i);
        size_t at = count++;
        for (; at > 0 && mpfr_less_p(d2[i].v, d2[order[at - 1]].v); at--)
            order[at] = order[at - 1];
        order[at] = i;
    }
    const double radius = (double)hood.query.max_radius;
    size_t wanted = 0;
    while (wanted < count && mpfr_cmp_d(d2[order[wanted]].v, radius * radius) <= 0 &&
           (!hood.query.k || wanted < hood.query.k))
        wanted++;
    return wanted;
}

/* ---- Weights ----------------------------------------------------------------------------------- */

typedef struct form {
    const char *name;
    char kind;     /* d, c, e, b, g */
    double k;      /* of the cone; of the Gaussian: the factor of beta */
    bool normed;   /* else the divisor is that of print, `printed` times the measure */
    double printed;
} form;

static const form forms[] = {{"disc", 'd', 0, true, 0},
                             {"cone:k=0.6", 'c', 0.6, true, 0},
                             {"cone:k=1.1", 'c', 1.1, true, 0},
                             {"epanechnikov", 'e', 0, true, 0},
                             {"biweight", 'b', 0, true, 0},
                             {"gaussian", 'g', 0.5, false, 1},
                             {"gaussian:form=pavicic", 'g', 1, false, 0},
                             {"gaussian:form=normalised", 'g', 0.5, true, 0}};

static void decimal(mpfr_t out, const char *text)
{
    (void)mpfr_set_str(out, text, 10, MPFR_RNDN);
}

/* w at t^2. */
static void weigh(const form *f, mpfr_t w, const mpfr_t t2)
{
    mpfr_t x, y;
    mpfr_inits2(BITS, x, y, (mpfr_ptr)0);
    mpfr_set_ui(w, 1, MPFR_RNDN);
    if (f->kind == 'c') {
        mpfr_sqrt(x, t2, MPFR_RNDN);
        mpfr_div_d(x, x, f->k, MPFR_RNDN);
        mpfr_ui_sub(w, 1, x, MPFR_RNDN);
        if (mpfr_sgn(w) < 0)
            mpfr_set_zero(w, 1);
    } else if (f->kind == 'e' || f->kind == 'b') {
        mpfr_ui_sub(w, 1, t2, MPFR_RNDN);
        if (f->kind == 'b')
            mpfr_sqr(w, w, MPFR_RNDN);
    } else if (f->kind == 'g') { /* alpha (1 - (1 - exp(-c t2)) / (1 - exp(-beta))) */
        decimal(y, "-1.953");
        mpfr_mul_d(x, y, f->k, MPFR_RNDN);
        mpfr_mul(x, x, t2, MPFR_RNDN);
        mpfr_expm1(x, x, MPFR_RNDN);
        mpfr_expm1(y, y, MPFR_RNDN);
        mpfr_div(x, x, y, MPFR_RNDN);
        mpfr_ui_sub(w, 1, x, MPFR_RNDN);
        decimal(y, "0.918");
        mpfr_mul(w, w, y, MPFR_RNDN);
    }
    mpfr_clears(x, y, (mpfr_ptr)0);
}

/* d times the integral of t^(d-1) w over [0, end]: Gauss and Legendre's three points in each of 4000 pieces, an error
 * of some (1/4000)^6 of the sixth derivative. A cone ends at k. */
static void integrate(const form *f, int d, mpfr_t sum)
{
    enum { PIECES = 4000 };
    const double end = f->kind == 'c' && f->k < 1.0 ? f->k : 1.0;
    mpfr_t t, w, node, part;
    mpfr_inits2(BITS, t, w, node, part, (mpfr_ptr)0);
    mpfr_set_zero(sum, 1);
    mpfr_set_ui(node, 3, MPFR_RNDN);
    mpfr_div_ui(node, node, 5, MPFR_RNDN);
    mpfr_sqrt(node, node, MPFR_RNDN);
    for (int i = 0; i < PIECES; i++)
        for (int n = -1; n <= 1; n++) {
            mpfr_mul_si(t, node, n, MPFR_RNDN);
            mpfr_add_ui(t, t, (unsigned long)(2 * i + 1), MPFR_RNDN);
            mpfr_div_ui(t, t, 2 * PIECES, MPFR_RNDN);
            mpfr_mul_d(t, t, end, MPFR_RNDN);
            mpfr_pow_ui(part, t, (unsigned long)(d - 1), MPFR_RNDN);
            mpfr_sqr(t, t, MPFR_RNDN);
            weigh(f, w, t);
            mpfr_mul(part, part, w, MPFR_RNDN);
            mpfr_mul_ui(part, part, n ? 5 : 8, MPFR_RNDN);
            mpfr_add(sum, sum, part, MPFR_RNDN);
        }
    mpfr_mul_d(sum, sum, end, MPFR_RNDN);
    mpfr_mul_ui(sum, sum, (unsigned long)d, MPFR_RNDN);
    mpfr_div_ui(sum, sum, 18UL * PIECES, MPFR_RNDN);
    mpfr_clears(t, w, node, part, (mpfr_ptr)0);
}

/* pi r2, or 4/3 pi r3. */
static void measure(mpfr_t out, const mpfr_t r2, int d)
{
    mpfr_t root;
    mpfr_init2(root, BITS);
    mpfr_const_pi(out, MPFR_RNDN);
    mpfr_mul(out, out, r2, MPFR_RNDN);
    if (d == 3) {
        mpfr_sqrt(root, r2, MPFR_RNDN);
        mpfr_mul(out, out, root, MPFR_RNDN);
        mpfr_mul_ui(out, out, 4, MPFR_RNDN);
        mpfr_div_ui(out, out, 3, MPFR_RNDN);
    }
    mpfr_clear(root);
}

static void divisor_of(const form *f, int d, const mpfr_t r2, mpfr_t out)
{
    mpfr_t norm;
    mpfr_init2(norm, BITS);
    if (f->normed || (d == 3 && f->printed == 0.0))
        integrate(f, d, norm);
    else if (f->printed > 0.0)
        from(norm, f->printed);
    else { /* pavicic: over r^2 alone */
        mpfr_const_pi(norm, MPFR_RNDN);
        mpfr_ui_div(norm, 1, norm, MPFR_RNDN);
    }
    measure(out, r2, d);
    mpfr_mul(out, out, norm, MPFR_RNDN);
    mpfr_clear(norm);
}

/* sum of w flux over the divisor; the k-th photon `last` times where the radius does not cut. */
static void estimate(const form *f, int d, double last, number *d2, mpfr_t sum)
{
    size_t order[MOST];
    mpfr_t r2, t2, w;
    mpfr_inits2(BITS, r2, t2, w, (mpfr_ptr)0);
    const size_t count = nearest(d2, order);
    const bool cut = !hood.query.k || count < hood.query.k;
    ck_assert_uint_gt(count, 0);
    mpfr_set(r2, d2[order[count - 1]].v, MPFR_RNDN);
    if (cut)
        from(r2, (double)hood.query.max_radius * (double)hood.query.max_radius);
    mpfr_set_zero(sum, 1);
    for (size_t i = 0; i < count; i++) {
        mpfr_div(t2, d2[order[i]].v, r2, MPFR_RNDN);
        weigh(f, w, t2);
        mpfr_mul_d(w, w, (double)hood.photons[order[i]].power[0], MPFR_RNDN);
        mpfr_mul_d(w, w, !cut && i + 1 == count ? last : 1.0, MPFR_RNDN);
        mpfr_add(sum, sum, w, MPFR_RNDN);
    }
    divisor_of(f, d, r2, w);
    mpfr_div(sum, sum, w, MPFR_RNDN);
    mpfr_clears(r2, t2, w, (mpfr_ptr)0);
}

/* ---- Comparisons ------------------------------------------------------------------------------- */

static pm__judged judge(const char *text, int dimensions)
{
    pm__spec spec;
    pm_error error;
    pm__judged judged;
    PM_CHECK_OK(pm__spec_parse(&pm__estimators, text, &spec, &error), error);
    const pm__judge_request request = {.photons = hood.photons, .count = hood.count, .query = &hood.query,
                                       .spec = &spec, .dimensions = dimensions};
    pm__judge(&request, &judged);
    ck_assert_int_eq(judged.status, PM_OK);
    ck_assert(judged.clear);
    return judged;
}

/* Within 2^-56 of the magnitudes: an eighth of a unit of the rows. */
static void check_near(long double got, const mpfr_t want, long double magnitude, const char *what)
{
    mpfr_t error;
    mpfr_init2(error, BITS);
    mpfr_set_ld(error, got, MPFR_RNDN);
    mpfr_sub(error, error, want, MPFR_RNDN);
    const double off = mpfr_get_d(error, MPFR_RNDN);
    mpfr_clear(error);
    ck_assert_msg(fabs(off) <= 0x1p-56 * (double)magnitude, "%s: %.20Lg is off by %g of %g", what, got, off,
                  (double)magnitude);
}

static void draw(uint32_t trial)
{
    pm__dice dice = {.seed = 1, .test = 3000 + trial};
    pm__hood_clear(&hood);
    pm__hood_scatter(&hood, &dice, 20 + trial, 1000, trial % 2 == 1);
    hood.query.k = trial % 3 ? 12 : 0;
    hood.query.max_radius = trial % 3 == 1 ? INFINITY : 0.6f;
    hood.query.position[0] = 0.25f;
}

START_TEST(test_kernels)
{
    static const char *const lasts[] = {"full", "half", "none"};
    static number d2[MOST];
    mpfr_t want;
    mpfr_init2(want, BITS);
    for (int i = 0; i < MOST; i++)
        mpfr_init2(d2[i].v, BITS);
    for (size_t f = 0; f < sizeof forms / sizeof *forms; f++)
        for (uint32_t trial = 0; trial < 6; trial++) {
            char text[80];
            const int d = 2 + (int)(trial / 3);
            draw(trial);
            (void)snprintf(text, sizeof text, "%s%slast=%s", forms[f].name, strchr(forms[f].name, ':') ? "," : ":",
                           lasts[trial % 3]);
            const pm__judged judged = judge(text, d);
            estimate(&forms[f], d, 1.0 - 0.5 * (double)(trial % 3), d2, want);
            check_near(judged.value[0], want, judged.magnitude[0], text);
        }
    for (int i = 0; i < MOST; i++)
        mpfr_clear(d2[i].v);
    mpfr_clear(want);
}
END_TEST

/* (x1 - x0) (y2 - y0) - (y1 - y0) (x2 - x0), exact. */
static void turn(const pm_photon *a, const pm_photon *b, const pm_photon *c, mpfr_t out)
{
    mpfr_t x, y;
    mpfr_inits2(BITS, x, y, (mpfr_ptr)0);
    from(x, (double)b->position[0] - (double)a->position[0]);
    mpfr_mul_d(x, x, (double)c->position[1] - (double)a->position[1], MPFR_RNDN);
    from(y, (double)b->position[1] - (double)a->position[1]);
    mpfr_mul_d(y, y, (double)c->position[0] - (double)a->position[0], MPFR_RNDN);
    mpfr_sub(out, x, y, MPFR_RNDN);
    mpfr_clears(x, y, (mpfr_ptr)0);
}

/* Of all photons: power inside in full, on the rim by a third, over the area. */
static void hull(mpfr_t sum)
{
    static bool rim[MOST];
    mpfr_t area, part;
    mpfr_inits2(BITS, area, part, (mpfr_ptr)0);
    mpfr_set_zero(area, 1);
    memset(rim, 0, sizeof rim);
    const pm_photon middle = {.position = {0.0f, 0.0f, 0.0f}};
    for (size_t i = 0; i < hood.count; i++)
        for (size_t j = 0; j < hood.count; j++) {
            bool edge = i != j;
            for (size_t k = 0; k < hood.count && edge; k++) {
                turn(&hood.photons[i], &hood.photons[j], &hood.photons[k], part);
                edge = k == i || k == j || mpfr_sgn(part) > 0;
            }
            if (!edge)
                continue;
            rim[i] = rim[j] = true;
            turn(&middle, &hood.photons[i], &hood.photons[j], part);
            mpfr_add(area, area, part, MPFR_RNDN);
        }
    mpfr_set_zero(sum, 1);
    for (size_t i = 0; i < hood.count; i++) {
        from(part, (double)hood.photons[i].power[0]);
        mpfr_mul_d(part, part, rim[i] ? 0.375 : 1.0, MPFR_RNDN);
        mpfr_add(sum, sum, part, MPFR_RNDN);
    }
    mpfr_div(sum, sum, area, MPFR_RNDN);
    mpfr_mul_ui(sum, sum, 2, MPFR_RNDN);
    mpfr_clears(area, part, (mpfr_ptr)0);
}

START_TEST(test_hull)
{
    mpfr_t want;
    mpfr_init2(want, BITS);
    for (uint32_t trial = 0; trial < 10; trial++) {
        pm__dice dice = {.seed = 2, .test = trial};
        pm__hood_clear(&hood);
        pm__hood_scatter(&hood, &dice, 8 + 4 * trial, 1000, false);
        hood.query.k = 100;
        hood.query.max_radius = INFINITY;
        const pm__judged judged = judge("hull:boundary=0.375", 2);
        hull(want);
        check_near(judged.value[0], want, judged.magnitude[0], "hull");
    }
    mpfr_clear(want);
}
END_TEST

/* What the others come down to: a single stage, equal maps, a photon's own lookup. */
START_TEST(test_others_come_down_to_the_disc)
{
    static const char *const others[] = {"differential:start=1000", "oracle"};
    draw(2);
    const pm__judged disc = judge("disc", 2);
    for (size_t i = 0; i < 2; i++) {
        const pm__judged judged = judge(others[i], 2);
        ck_assert(fabsl(judged.value[1] / disc.value[1] - 1) < 0x1p-58L);
    }
    /* four copies of every photon, one a map */
    pm__dice dice = {.seed = 3};
    pm__hood_clear(&hood);
    pm__hood_scatter(&hood, &dice, 15, 400, false);
    for (size_t i = 60; i-- > 0;)
        hood.photons[i] = hood.photons[i / 4];
    hood.query.k = 0;
    hood.query.max_radius = 0.5f;
    hood.count = 60;
    const pm__judged all = judge("disc", 2), pooled = judge("combined", 2), mean = judge("combined:rule=mean", 2);
    ck_assert(fabsl(pooled.value[0] / all.value[0] - 1) < 0x1p-58L);
    ck_assert(fabsl(mean.value[0] / all.value[0] - 1) < 0x1p-58L);
    /* at the query's own place the nearest photon is the query */
    hood.photons[0].position[0] = hood.photons[0].position[1] = 0.0f;
    const pm__judged at = judge("disc", 2), stored = judge("precomputed:fraction=1", 2);
    ck_assert(fabsl(stored.value[0] / at.value[0] - 1) < 0x1p-58L);
}
END_TEST

PM_TEST_MAIN("stress judge", test_kernels, test_hull, test_others_come_down_to_the_disc)
