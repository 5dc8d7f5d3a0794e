/* The laws by which advice is given, and their solution. Pure. All errors are relative to the mean truth. */
#ifndef PM_CONVERGE_ADVISE_LAW_H
#define PM_CONVERGE_ADVISE_LAW_H

#include <stdbool.h>
#include <stddef.h>

enum { PM__MOST_SAMPLES = 64 };

/* ---- One photon map ---------------------------------------------------------------------------- */

/* What a pilot measured with one k. */
typedef struct pm__map_sample {
    double k, photons;
    double variance;      /* rel_noise^2 */
    double bias2;         /* rms_bias^2 ... */
    double bias2_error;   /* ... and its standard error */
    double ns_per_query;  /* NAN: not timed */
    double ns_per_photon; /* drawing or tracing, and building. NAN: not timed */
} pm__map_sample;

typedef struct pm__map_law {
    pm__map_sample samples[PM__MOST_SAMPLES];
    size_t count;
} pm__map_law;

/* False where there is no room. A sample whose k is below 3, or whose variance is not positive, says nothing and is
 * passed over. */
bool pm__map_law_add(pm__map_law *law, const pm__map_sample *sample);

double pm__map_variance(const pm__map_law *law, double k, double photons);
double pm__map_bias2(const pm__map_law *law, double share); /* share: k / photons */
/* Seconds on one thread of a map of `photons` and `queries` lookups of k. */
double pm__map_seconds(const pm__map_law *law, double k, double photons, double queries);

typedef struct pm__map_limits {
    double queries;     /* that the cost counts */
    double least_k;     /* >= 3 */
    double most_photons;
} pm__map_limits;

typedef struct pm__map_choice {
    bool reachable;     /* else the least error that is, and what gives it */
    double k, photons;  /* whole */
    double rel_bias, rel_noise, rel_rmse, seconds;
} pm__map_choice;

/* Whether a is cheaper, or comes nearer where the error is out of reach. */
bool pm__map_is_better(const pm__map_choice *a, const pm__map_choice *b);

/* The cheapest k and photons whose predicted error is `error`. Cost: some hundred evaluations. */
pm__map_choice pm__map_solve(const pm__map_law *law, const pm__map_limits *limits, double error);

/* Whether the nearest sample has a quarter of the photons or more, and a share within a factor of 2. */
bool pm__map_is_near(const pm__map_law *law, const pm__map_choice *choice);

/* ---- Passes ------------------------------------------------------------------------------------ */

/* What runs of some passes measured. */
typedef struct pm__pass_sample {
    double passes;
    double variance, bias2;   /* as above; bias2 0 where it is not clear of the noise */
} pm__pass_sample;

/* error^2 = variance_1 i^-variance_slope + bias2_1 i^-bias2_slope after i passes. */
typedef struct pm__pass_law {
    double variance_1, variance_slope, bias2_1, bias2_slope;
} pm__pass_law;

/* Of the last half of the samples. variance_slope: the least there can be, and what is taken where fewer than two
 * variances are above 0; measured it is at most 1. count >= 1. */
pm__pass_law pm__pass_law_fit(const pm__pass_sample *samples, size_t count, double variance_slope,
                              double bias2_slope);
double pm__pass_error(const pm__pass_law *law, double passes);
/* The passes after which the error is at most `error`, a whole number >= 1; 0: not within `most`. */
double pm__pass_solve(const pm__pass_law *law, double error, double most);
/* The error that no number of passes goes below: of a bias that stays. */
double pm__pass_floor(const pm__pass_law *law);
/* Where the error is out of reach: `most`, or where a bias stays the fewest passes within 1 % of what `most` leave. */
double pm__pass_nearest(const pm__pass_law *law, double most);

#endif
