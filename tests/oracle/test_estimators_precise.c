/* Estimates against the same sums in 200 bits (kernels) and in long double straight from the definition (differential,
 * combined, precomputed). */
#include "../neighborhood.h"

#include <mpfr.h>
#include <stdio.h>

static hood h;
static stream random_numbers = {11, 0, 0};

/* Random distances in random order, random flux. */
static void random_hood(size_t count, int dimensions, bool sorted)
{
    hood_init(&h, dimensions);
    hood_poisson(&h, &random_numbers, count);
    h.set.cut = below(&random_numbers, 3) == 0;
    if (h.set.cut)
        h.set.radius2 *= 1.0 + uniform(&random_numbers);
    h.lookup.unit = exp2((double)below(&random_numbers, 9) - 4.0);
    for (size_t i = count; !sorted && i-- > 1;) {
        const size_t j = below(&random_numbers, i + 1);
        const float d = h.distance2[i];
        h.distance2[i] = h.distance2[j];
        h.distance2[j] = d;
    }
    for (size_t i = 0; i < count; i++)
        for (int c = 0; c < 3; c++)
            h.flux[i][c] = (float)exp(4.0 * uniform(&random_numbers));
}

static size_t farthest(void)
{
    size_t best = 0;
    for (size_t i = 0; i < h.set.count; i++)
        if (h.distance2[i] >= h.distance2[best])
            best = i;
    return best;
}

/* ---- Kernels in 200 bits -------- */

typedef enum shape { DISC, CONE, EPANECHNIKOV, BIWEIGHT, WIDE_GAUSS, NARROW_GAUSS } shape;

/* w = the weight at t2, which is overwritten. */
static void weigh(shape kind, double k, mpfr_t w, mpfr_t t2)
{
    mpfr_t beta, e;
    mpfr_inits2(200, beta, e, (mpfr_ptr)0);
    mpfr_set_d(beta, 1.953, MPFR_RNDN);
    switch (kind) {
    case DISC:
        mpfr_set_ui(w, 1, MPFR_RNDN);
        break;
    case CONE:
        mpfr_sqrt(w, t2, MPFR_RNDN);
        mpfr_div_d(w, w, k, MPFR_RNDN);
        mpfr_ui_sub(w, 1, w, MPFR_RNDN);
        if (mpfr_sgn(w) < 0)
            mpfr_set_ui(w, 0, MPFR_RNDN);
        break;
    case EPANECHNIKOV:
    case BIWEIGHT:
        mpfr_ui_sub(w, 1, t2, MPFR_RNDN);
        if (kind == BIWEIGHT)
            mpfr_sqr(w, w, MPFR_RNDN);
        break;
    case WIDE_GAUSS:
    case NARROW_GAUSS:
        mpfr_mul(t2, t2, beta, MPFR_RNDN);
        mpfr_div_si(t2, t2, kind == WIDE_GAUSS ? -2 : -1, MPFR_RNDN);
        mpfr_expm1(w, t2, MPFR_RNDN);
        mpfr_neg(beta, beta, MPFR_RNDN);
        mpfr_expm1(e, beta, MPFR_RNDN);
        mpfr_div(w, w, e, MPFR_RNDN);
        mpfr_ui_sub(w, 1, w, MPFR_RNDN);
        mpfr_mul_d(w, w, 0.918, MPFR_RNDN);
        break;
    }
    mpfr_clears(beta, e, (mpfr_ptr)0);
}

/* sum w flux (the farthest times `last` unless cut) / (pi r2 or 4/3 pi r3); the normaliser is left to the caller. */
static double precise(shape kind, double k, double last)
{
    mpfr_t sum, w, t2, r2;
    mpfr_inits2(200, sum, w, t2, r2, (mpfr_ptr)0);
    mpfr_set_zero(sum, 1);
    mpfr_set_d(r2, h.set.radius2, MPFR_RNDN);
    const size_t rim = h.set.cut ? h.set.count : farthest();
    for (size_t i = 0; i < h.set.count; i++) {
        mpfr_d_div(t2, (double)h.distance2[i], r2, MPFR_RNDN);
        weigh(kind, k, w, t2);
        mpfr_mul_d(w, w, (double)h.flux[i][0] * (i == rim ? last : 1.0), MPFR_RNDN);
        mpfr_add(sum, sum, w, MPFR_RNDN);
    }
    mpfr_mul_d(r2, r2, h.lookup.unit * h.lookup.unit, MPFR_RNDN);
    mpfr_const_pi(w, MPFR_RNDN);
    mpfr_mul(w, w, r2, MPFR_RNDN);
    if (h.lookup.dimensions == 3) {
        mpfr_sqrt(r2, r2, MPFR_RNDN);
        mpfr_mul(w, w, r2, MPFR_RNDN);
        mpfr_mul_ui(w, w, 4, MPFR_RNDN);
        mpfr_div_ui(w, w, 3, MPFR_RNDN);
    }
    mpfr_div(sum, sum, w, MPFR_RNDN);
    const double value = mpfr_get_d(sum, MPFR_RNDN);
    mpfr_clears(sum, w, t2, r2, (mpfr_ptr)0);
    return value;
}

START_TEST(test_kernels)
{
    static const struct {
        const char *name;
        shape kind;
        double k;
    } table[] = {{"disc", DISC, 0},
                 {"cone:k=0.6", CONE, 0.6},
                 {"cone:k=1", CONE, 1},
                 {"cone:k=1.1", CONE, 1.1},
                 {"epanechnikov", EPANECHNIKOV, 0},
                 {"biweight", BIWEIGHT, 0},
                 {"gaussian:form=printed", WIDE_GAUSS, 0},
                 {"gaussian:form=pavicic", NARROW_GAUSS, 0},
                 {"gaussian:form=normalised", WIDE_GAUSS, 0}};
    static const char *const lasts[] = {"full", "half", "none"};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++)
        for (int trial = 0; trial < 60; trial++) {
            const size_t choice = below(&random_numbers, 3), count = 1 + below(&random_numbers, 300);
            char text[100];
            snprintf(text, sizeof text, "%s%slast=%s", table[i].name, strchr(table[i].name, ':') ? "," : ":",
                     lasts[choice]);
            const subject s = subject_of(text);
            random_hood(count, 2 + trial % 2, false);
            const double want = precise(table[i].kind, table[i].k, 1.0 - 0.5 * (double)choice) /
                                s.estimator->norm(s.spec.values, h.lookup.dimensions);
            /* Rounding of the sum, and of weights: absolute, since they may vanish; the Gaussian's are polynomials. */
            double flux = 0.0;
            for (size_t j = 0; j < count; j++)
                flux += (double)h.flux[j][0];
            const double weight_error = table[i].kind >= WIDE_GAUSS ? 2e-14 : 1e-15;
            const double slack = weight_error * flux / pm__measure_of(&h.lookup, h.set.radius2);
            PM_CHECK_NEAR(estimate_of(&s, &h.lookup), want,
                          want * ((double)count + 10.0) * 0x1p-53 +
                              slack / s.estimator->norm(s.spec.values, h.lookup.dimensions));
        }
}
END_TEST

/* ---- Straight from the definition -------- */

static long double measure(double radius2)
{
    const long double pi = 3.14159265358979323846264338327950288L;
    const long double r2 = (long double)radius2 * (long double)h.lookup.unit * (long double)h.lookup.unit;
    return h.lookup.dimensions == 3 ? 4 * pi * r2 * sqrtl(r2) / 3 : pi * r2;
}

/* E_n of one band (-1: the sum of the three). */
static long double naive_stage(size_t n, long double last, int band)
{
    const bool whole = h.set.cut && n == h.set.count;
    long double sum = 0;
    for (size_t i = 0; i < n; i++)
        for (int c = 0; c < 3; c++)
            if (band < 0 || band == c)
                sum += (i + 1 == n && !whole ? last : 1) * (long double)h.flux[i][c];
    return sum / measure(whole ? h.set.radius2 : (double)h.distance2[n - 1]);
}

static size_t naive_stop(const size_t *stages, size_t count, size_t trend, long double last, double z, bool stratified)
{
    for (size_t i = trend; i < count; i++) {
        size_t up = 0, down = 0;
        for (size_t j = i - trend; j < i; j++) {
            const long double change = naive_stage(stages[j + 1], last, -1) - naive_stage(stages[j], last, -1);
            up += change > 0;
            down += change < 0;
        }
        if (up < trend && down < trend)
            continue;
        bool significant = z < 0;
        for (size_t j = 0; j < i && !significant; j++) {
            const long double n = (long double)stages[j], now = (long double)stages[i];
            const long double sd = stratified ? sqrtl(0.59L * powl(n, -1.5L)) : sqrtl(1 / n - 1 / now);
            const long double change = logl(naive_stage(stages[i], last, -1) / naive_stage(stages[j], last, -1));
            significant = fabsl(change) > z * sd;
        }
        if (significant)
            return stages[i];
    }
    return stages[count - 1];
}

START_TEST(test_differential)
{
    static size_t stages[HOOD_MAX];
    size_t stopped = 0, went_on = 0;
    for (int trial = 0; trial < 1500; trial++) {
        const bool monotone = trial % 2, stratified = below(&random_numbers, 2);
        const size_t choice = below(&random_numbers, 3), start = 3 + below(&random_numbers, 20);
        const size_t trend = 1 + below(&random_numbers, monotone ? 8 : 3), k = 1 + below(&random_numbers, 90);
        const double z = stratified ? 3.0 : 1.5;
        char text[120];
        snprintf(text, sizeof text, "differential:rule=%s,z=%g,start=%zu,trend=%zu,last=%s,noise=%s",
                 monotone ? "monotone" : "significance", z, start, trend,
                 choice == 0   ? "full"
                 : choice == 1 ? "half"
                               : "none",
                 stratified ? "stratified" : "poisson");
        const subject s = subject_of(text);
        random_hood(k, 2 + trial % 3 % 2, true);
        size_t count = 0, n = start < k ? start : k;
        for (stages[count++] = n; n < k; stages[count++] = n) {
            n = monotone ? n + 1 : (size_t)ceill((long double)n * powl(2, 0.25L));
            n = n < k ? n : k;
        }
        const long double last = 1 - 0.5L * (long double)choice;
        const size_t stop = naive_stop(stages, count, trend, last, monotone ? -1.0 : z, stratified);
        stopped += stop < k;
        went_on += stop == k && k > 60;
        double result[3];
        ck_assert_int_eq(s.estimator->estimate(s.spec.values, &h.lookup, result), PM_OK);
        for (int c = 0; c < 3; c++) {
            const double want = (double)naive_stage(stop, last, c);
            PM_CHECK_NEAR(result[c], want, 1e-14 * want);
        }
    }
    ck_assert(stopped > 100 && went_on > 50);
}
END_TEST

START_TEST(test_combined)
{
    static hood parts[7];
    const pm_status none = PM_OK;
    for (int trial = 0; trial < 400; trial++) {
        const bool pooled = trial % 2;
        const size_t choice = below(&random_numbers, 3), maps = 2 + below(&random_numbers, 6);
        const long double last = 1 - 0.5L * (long double)choice;
        char text[80];
        snprintf(text, sizeof text, "combined:maps=%zu,rule=%s,last=%s", maps, pooled ? "pooled" : "mean",
                 choice == 0   ? "full"
                 : choice == 1 ? "half"
                               : "none");
        const subject s = subject_of(text);
        pm__neighbors sets[7];
        long double sum = 0, open = 0, cut = 0, photons = 0, area = 0;
        for (size_t m = 0; m < maps; m++) {
            random_hood(3 + below(&random_numbers, 30), 2, false);
            h.lookup.unit = 0.25;
            memcpy(parts[m].distance2, h.distance2, sizeof h.distance2);
            memcpy(parts[m].flux, h.flux, sizeof h.flux);
            sets[m] = h.set;
            sets[m].distance2 = parts[m].distance2;
            sets[m].flux = (const float(*)[3])parts[m].flux;
            long double all = 0;
            for (size_t i = 0; i < h.set.count; i++)
                all += (long double)h.flux[i][2];
            const size_t rim = farthest();
            sum += (all - (h.set.cut ? 0 : (1 - last) * (long double)h.flux[rim][2])) / measure(h.set.radius2);
            *(h.set.cut ? &cut : &open) += all;
            photons += h.set.cut ? 0 : (long double)h.set.count;
            area += measure(h.set.radius2);
        }
        if (pooled && photons > 0)
            sum = (long double)maps * (open * (photons - 1 + last) / photons + cut) / area;
        else if (pooled)
            sum = (long double)maps * cut / area;
        pm__lookup lookup = h.lookup;
        lookup.sets = sets;
        lookup.set_count = maps;
        double result[3];
        ck_assert_int_eq(s.estimator->estimate(s.spec.values, &lookup, result), none);
        PM_CHECK_NEAR(result[2], (double)sum, 1e-13 * (double)sum);
    }
}
END_TEST

START_TEST(test_precomputed)
{
    const subject printed = subject_of("precomputed"), unbiased = subject_of("precomputed:form=unbiased");
    for (int trial = 0; trial < 300; trial++) {
        random_hood(3 + below(&random_numbers, 60), 2 + trial % 2, false);
        const size_t itself = below(&random_numbers, h.set.count), rim = farthest();
        if (itself == rim)
            continue;
        h.distance2[itself] = 0.0f;
        long double all = 0, fewer = 0;
        for (size_t i = 0; i < h.set.count; i++) {
            all += (long double)h.flux[i][1];
            fewer += i == itself || (i == rim && !h.set.cut) ? 0 : (long double)h.flux[i][1];
        }
        double result[3];
        ck_assert_int_eq(printed.estimator->estimate(printed.spec.values, &h.lookup, result), PM_OK);
        PM_CHECK_NEAR(result[1] * (double)(measure(h.set.radius2) / all), 1.0, 1e-14);
        ck_assert_int_eq(unbiased.estimator->estimate(unbiased.spec.values, &h.lookup, result), PM_OK);
        PM_CHECK_NEAR(result[1] * (double)(measure(h.set.radius2) / fewer), 1.0, 1e-14);
    }
}
END_TEST

PM_TEST_MAIN("estimators against precise sums", test_kernels, test_differential, test_combined, test_precomputed)
