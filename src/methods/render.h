/* Images of scenes: by a method, and for methods that estimate from photon maps one for each estimator.
 *
 * A pass takes one sample in every pixel; samples of a pixel are stratified over passes (Sobol', scrambled by pixel). A
 * trial has photon maps of its own, and the same samples of the pixels. Results do not depend on the threads. */
#ifndef PM_METHODS_RENDER_H
#define PM_METHODS_RENDER_H

#include "../../cases/case.h"
#include "../base/sampler.h"
#include "../image/image.h"
#include "plan.h"

typedef struct pm__render_config {
    const pm__spec *scene;   /* of pm__scene_cases */
    const pm__view *view;    /* NULL: the scene's own */
    const pm__spec *method;  /* of pm__methods */
    const pm_estimator *const *estimators; /* at least one; methods without estimates pass them over */
    size_t estimator_count;
    size_t k;                /* photons in an estimate; 0: all within the radius */
    double radius;           /* m; INFINITY: no limit */
    pm__shape lookup;
    const pm_search *search; /* NULL: the fastest */
    const pm__sampler *sampler; /* of emission; NULL: independent photons */
    size_t photons;          /* stored */
    size_t width, height, spp;
    size_t trials;           /* at least 1 */
    double seconds;          /* passes until then, at most spp of them unless 0; 0: no limit */
    uint64_t seed;
    bool aov;                /* truth, error, bias, noise, radius and count are wanted too */
    bool no_skip;
    const pm_parallel *parallel;
    void (*progress)(void *context, double fraction, const char *what); /* may be NULL */
    bool (*canceled)(void *context);                                    /* may be NULL */
    void *context;
} pm__render_config;

/* The images of one estimator. Those that do not exist are empty: truth, error and bias where nothing is known, bias
 * and noise with one trial, radius and count without estimates. */
typedef struct pm__render_images {
    pm__image radiance;    /* W/(m2 sr), of the first trial */
    pm__image truth;
    pm__image error;       /* (radiance - truth) / mean truth of the image, signed; 0 where truth is not known */
    pm__image bias, noise; /* over trials: mean - truth, standard deviation, over the mean truth (noise without a truth:
                              over the mean radiance). Of one trial of a method without maps noise is the standard error
                              of the image itself */
    pm__image radius, count; /* of the estimates: m, photons found; 0 where none was made */
    double mean_error, rms_error; /* of the error, over all pixels whose truth is known; NAN where none is */
} pm__render_images;

typedef struct pm__render_result {
    pm__render_images *images; /* [count], by estimator */
    size_t count;
    const char *truth;      /* "exact", "reference" or NULL */
    bool misfit;            /* there is a reference, but of a size that does not divide the image's */
    size_t passes;          /* done, of the first trial */
    size_t trials;          /* done */
    bool interrupted;       /* not all that was asked for is in the images */
    uint64_t emitted;       /* photons, of one trial, all maps */
    size_t stored;
    double trace_s, build_s, image_s, total_s; /* wall clock, first trial; total: all */
} pm__render_result;

extern const pm__catalogue pm__methods;

/* What the render will do and why, before anything is traced. EINVAL, ENOMEM as pm__render. */
pm_status pm__render_plan(const pm__render_config *config, pm__plan *plan, pm_error *error);

/* Bytes that it will hold at the least: film and images, photons and maps without directions. */
double pm__render_bytes(const pm__render_config *config);

/* EINVAL: what is asked for cannot be (error says why). ENOMEM. Canceled: PM_OK with `interrupted`; images hold what
 * was done. Free the result by pm__render_free in any case. */
pm_status pm__render(const pm__render_config *config, pm__render_result *result, pm_error *error);
void pm__render_free(pm__render_result *result);

#endif
