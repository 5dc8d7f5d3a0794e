/* What reaches a relative RMS error E at least cost: pilot runs, a fitted law, its solution.
 *
 * Candidates are a single photon map with each estimator (the error over the region `all` of a case, as accuracy.h has
 * it) and progressive methods (over the points of a scene's image, as converge.h has it). The two are not the same
 * measure: photons at the places of a case, and radiance in the pixels of its picture. Seconds are those of one thread:
 * of a map drawing or tracing, building, and one lookup at each of `probes` points; of a method its passes. */
#ifndef PM_CONVERGE_ADVISE_H
#define PM_CONVERGE_ADVISE_H

#include "../accuracy/accuracy.h"
#include "converge.h"

/* "map", and the names of pm__progressives. */
extern const pm__entry pm__advise_map;
extern const pm__catalogue pm__advise_methods;

typedef struct pm__advise_config {
    const pm__spec *subject;    /* of pm__all_cases */
    double error;               /* E, above 0 and below 1 */
    const pm__spec *estimators; /* none: those that suit independent photons; of progressive methods the disc */
    size_t estimator_count;
    const pm__spec *methods;    /* of pm__advise_methods; none: map, and of scenes pppm too; pppm alone where there is
                                   no exact answer, which maps are judged by */
    size_t method_count;
    size_t probes;              /* points that are asked, and that the cost counts; >= 1 */
    size_t most_photons;        /* of a map, or emitted by a run (of methods that emit any); 0: as many as memory and
                                   the program allow */
    double seconds;             /* for pilots; the first of each method is run all the same */
    uint64_t seed;
    const pm_parallel *parallel; /* NULL: serial */
    size_t threads;             /* of it */
    double memory;              /* bytes that may be taken; 0: as many as are wanted */
    void (*progress)(void *context, double fraction, const char *what); /* may be NULL */
    bool (*canceled)(void *context);                                   /* may be NULL */
    void *context;
} pm__advise_config;

typedef struct pm__advice {
    pm__spec method;            /* of pm__advise_methods */
    pm__spec estimator;         /* entry NULL: the method looks nothing up */
    size_t k;                   /* of each lookup; of progressive methods those of the first; 0: as above */
    size_t photons;             /* in the map; of progressive methods emitted in a pass; 0: it emits none */
    uint32_t passes;            /* 0: a single map */
    size_t width, height;       /* of the image whose pixels are asked; 0: a single map */
    size_t trials;              /* that show the error well enough */
    double predicted_rel_bias, predicted_rel_noise, predicted_rel_rmse, predicted_seconds;
    bool advised;               /* the cheapest of those that reach the error */
    /* Of pm__advise_verify; NAN before. */
    double reached_rel_rmse, reached_seconds;
    pm__interval reached_rel_rmse_ci95;
    double ratio;               /* reached over asked for */
    /* "ok"; "unreachable": the row is what comes nearest; "unsupported"; "missed"; "interrupted": not verified */
    const char *status;
    char detail[PM__DETAIL_SIZE];
} pm__advice;

/* Progressive methods are asked so, in an image of 32x32 pixels or the size of the scene's stored reference. */
enum { PM__ADVISE_K = 50, PM__ADVISE_PASS = 20000, PM__ADVISE_MOST_PASSES = 1000000 };
extern const double pm__advise_alpha;

/* Advice for each method and estimator, the advised one first, then by time; *advice is malloc'ed and the caller's.
 * EINVAL: no candidate can be measured (error says why), ENOMEM, ECANCELED: none is there. */
pm_status pm__advise(const pm__advise_config *config, pm__advice **advice, size_t *count, pm_error *error);

/* Runs exactly that, with random numbers that the pilots have not seen, and fills in what was reached: "missed" where
 * that is not within a quarter of the error asked for, to either side; but "ok" where it is less and what was run was
 * predicted to be, since there is nothing smaller. ECANCELED: "interrupted", and nothing was reached. */
pm_status pm__advise_verify(const pm__advise_config *config, pm__advice *advice, pm_error *error);

#endif
