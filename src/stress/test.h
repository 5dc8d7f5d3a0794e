/* What a test of stress is, and how its rows come about. */
#ifndef PM_STRESS_TEST_H
#define PM_STRESS_TEST_H

#include "hood.h"
#include "judge.h"
#include "stress.h"

typedef struct pm__stress_test {
    const char *name, *summary;
    /* Sets of photons, each asked of every estimator, search and width, by number, by radius and by both, in the plane
     * and in space. */
    size_t quick, full; /* how many */
    void (*make)(pm__hood *hood, size_t set, pm__dice *dice);
    /* Or rows of its own. measure fills in subject, measured, unit, bound (without its factor) and detail. */
    size_t (*subjects)(bool full);
    pm_status (*measure)(size_t subject, const pm__stress_config *config, pm__stress_row *row);
} pm__stress_test;

extern const pm__stress_test *const pm__stress_tests[];

/* What is known so far of a row. */
typedef struct pm__worst {
    double ratio, measured, bound;
    const char *unit;
    size_t lookups, unclear; /* unclear: of these, decided by rounding, so that values were not compared */
    bool failed;             /* beyond numbers */
    char detail[PM__STRESS_DETAIL];
} pm__worst;

void pm__worst_take(pm__worst *worst, double measured, double bound, const char *unit, const char *what);
#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pm__worst_fail(pm__worst *worst, const char *format, ...);

/* |got - want| in units in the last place of `magnitude` with so many bits of mantissa (53 or 24). */
double pm__ulps(long double got, long double want, long double magnitude, int bits);

/* One set for one estimator (spec NULL: for the searches alone): worst[search * widths + width]. ENOMEM. */
typedef struct pm__asking {
    const pm__hood *hood;
    const pm__spec *spec;
    const pm_search *const *searches;
    size_t search_count;
    const pm__stress_widths *widths;
    pm__worst *worst;
} pm__asking;
pm_status pm__stress_ask(const pm__asking *asking);    /* ask.c: estimates */
pm_status pm__stress_search(const pm__asking *asking); /* ask_search.c: neighbours */

/* Lookups by number, by radius, by both. */
enum { PM__BY_NUMBER, PM__BY_RADIUS, PM__BY_BOTH, PM__FORMS };
extern const char *const pm__form_names[PM__FORMS];
pm_query pm__form_query(const pm__hood *hood, int form);
bool pm__form_fits(const pm_search *search, int form);

/* The same set with lengths times 2^length and powers times 2^power; photons: room for all. */
void pm__twin_of(const pm__hood *hood, pm_photon *photons, pm__hood *twin);

#endif
