/* stress: does the library hold at the edges? One verdict a row, over every estimator, search and SIMD width.
 *
 * The judge (judge.h) computes what is due by code of its own: neighbours by measuring every photon, estimates by their
 * formulas, all in long double (64 bits of mantissa at least; where a machine has less, no more than `double` is
 * promised). A subject is asked through the public interface, the oracle through the lookup's own.
 *
 * What is measured. On most sets every coordinate is a whole number of steps, at most 1024 of them either way, a power
 * of two each: differences, squares and their sums (below 2^24) are then exact in single precision, ties are ties, and
 * what is left of rounding is that of double. Its unit is `ulp`: the last place of the sum of magnitudes as a double,
 * that is of the same estimate with every term of its sums taken positive. For positive powers that is, up to the
 * weights' own terms, the result; where powers cancel nothing else can be asked for. Elsewhere (moved, scaled by tens,
 * tilted) squared distances round in single precision, and the unit is `float ulp`, the last place of the same as a
 * float. A lookup's row has the error of squared distances, which is 0 on such lattices; of statuses that should have
 * come and did not, of other photons, counts or radii, and of NaN there is no number: `measured` is NAN, `detail` says.
 *
 * Bounds. With u = 2^-53 a sum of n terms in the order delivered errs by (n - 1) u of their magnitudes, and ulp(x) is
 * at least u |x|, so a relative error of c u is at most c ulps:
 *   n     the sum, its last share and product, n being the photons found
 *   + w   a weight, by terms that t^2 = d^2/r^2 enters with two roundings: disc 0; epanechnikov 3 (1 and t^2); biweight
 *         7 (squared, and rounded); cone 5 (1 and t/k: root, product, difference); gaussian 512: its polynomial is good
 *         to 1.5e-14 = 135 u and rounds by some 60 u more; pavicic's form is its square, twice that; norm 30
 *   + 16  measure (pi 1, products 3, a root in space 1), the kernel's norm and its product 4, division 1, a share and
 *         its product 2: 12 at most
 * hull: its area is a sum of at most n triangles about a corner, each of two products: 5 n + 16, magnitudes being those
 * of products over the area. combined: 8 more for each map.
 * In single precision a difference of coordinates errs by v = 2^-24, its square by 3 v, the sum of three by 5 v, and so
 * r^2 by 5 v, areas by 5 v and volumes by 7.5 v, and d^2/r^2 by 10 v. A weight's slope by t^2 carries the latter on:
 * cone t/(2k): 5/k (1 at most where k > 5: its part of the magnitudes); epanechnikov 10; biweight 20; gaussian 11.
 * hull: 8 (offsets' relative error twice in two products). All + 2.
 * Radius of repeated updates: see updates.c; sums of 1e8 terms: sums.c. */
#ifndef PM_STRESS_STRESS_H
#define PM_STRESS_STRESS_H

#include "../base/param.h"

enum { PM__STRESS_SUBJECT = PM__MAX_SPEC + 40, PM__STRESS_DETAIL = 200, PM__STRESS_WIDTHS = 4 };

typedef struct pm__stress_row {
    const char *test;
    char subject[PM__STRESS_SUBJECT];
    bool passed;
    double measured, bound; /* NAN: there is none */
    const char *unit;
    char detail[PM__STRESS_DETAIL]; /* empty: nothing to say */
} pm__stress_row;

typedef struct pm__stress_config {
    const bool *tests;           /* [pm__stress_test_count]: which; NULL: all */
    const pm__spec *estimators;
    size_t estimator_count;
    const pm_search *const *searches; /* NULL: all */
    size_t search_count;
    uint64_t seed;
    bool full;                   /* more sets of each kind, more forms of estimators */
    double bound_factor;         /* of every bound: 1. For tests of what follows when a row fails */
    const pm_parallel *parallel; /* NULL: serial */
    void (*progress)(void *context, double fraction, const char *what); /* may be NULL */
    bool (*canceled)(void *context);                                    /* may be NULL; asked by several threads */
    void *context;
} pm__stress_config;

/* What is run unless the user says otherwise: all, with their defaults, and in the full profile other forms too. The
 * caller's to free. ENOMEM. */
pm_status pm__stress_estimators(bool full, pm__spec **specs, size_t *count);

/* The rows, in the order of the tests, then of estimators, searches, widths; the caller's to free. Do not depend on
 * threads. ECANCELED: the tests that were complete. ENOMEM, EINVAL (PHOTONBENCH_SIMD). */
pm_status pm__stress_run(const pm__stress_config *config, pm__stress_row **rows, size_t *count, pm_error *error);

/* The tests. */
size_t pm__stress_test_count(void);
const char *pm__stress_test_name(size_t test);
const char *pm__stress_test_summary(size_t test);

/* The widths that are run, in ascending order: all that this processor has, or the one that PHOTONBENCH_SIMD asks for.
 * Of the others, `missing` says why. EINVAL: PHOTONBENCH_SIMD names none or one that is not here. */
typedef struct pm__stress_widths {
    pm_simd width[PM__STRESS_WIDTHS];
    size_t count;
    pm_simd missing[PM__STRESS_WIDTHS];
    size_t missing_count;
    bool forced; /* by PHOTONBENCH_SIMD: the missing ones were not asked for */
} pm__stress_widths;
pm_status pm__stress_widths_here(pm__stress_widths *widths, pm_error *error);

#endif
