/* What leaves the lights: of which light photon `number` is, and by which numbers it is emitted. */
#ifndef PM_TRANSPORT_EMISSION_H
#define PM_TRANSPORT_EMISSION_H

#include "../base/sampler.h"
#include "../scene/batch.h"
#include "projection.h"
#include "trace.h"

typedef struct pm__emission {
    const pm__scene *scene;
    const pm__projection *projection; /* where photons are sent; NULL: everywhere */
    size_t only;        /* the one light that sends, or PM__ALL_LIGHTS */
    uint64_t seed;
    uint32_t trial;
    double total;       /* W, of all lights and bands: what is sent */
    pm__points *points; /* of each light, of a set spread by a sampler; NULL: independent photons */
    uint64_t *first;    /* the first number of each light's, and the end of the last one's */
    double *weight;     /* of each light's photons, about 1: what rounding to whole grids leaves */
    const struct pm__strata *strata; /* photons are sent by strata of the lights' numbers (strata.h); NULL: evenly */
} pm__emission;

/* A photon as it leaves. power: W, as if the number of photons emitted were 1. */
typedef struct pm__departure {
    double position[3], direction[3], power[3];
} pm__departure;

#define PM__ALL_LIGHTS SIZE_MAX

/* Beyond those of photons and trial runs: 0 and 1 are emission's own, others the caller's. */
#define PM__OTHER_NUMBERS (PM__MOST_TRACED + PM__MOST_TRACED / 2)

/* Independent photons, of any number, of one light or all: nothing to be freed. */
void pm__emission_init(const pm__scene *scene, const pm__projection *projection, size_t only, uint64_t seed,
                       uint32_t trial, pm__emission *emission);

/* A set of about `count` photons (a sampler may round), pm__emission_count of them, numbers from 0. Lights have photons
 * by their share of the power that is sent, within one; a fraction of a photon is made up for by chance, so all photons
 * carry the same power and none is favoured. EINVAL: count of 2^32 or more; ENOMEM. */
pm_status pm__emission_spread(pm__emission *emission, const pm__sampler *sampler, uint64_t count, pm_error *error);
uint64_t pm__emission_count(const pm__emission *emission);
void pm__emission_free(pm__emission *emission);

/* false: no light reaches where photons are sent. */
bool pm__depart(const pm__emission *emission, uint64_t number, pm__departure *departure);

/* The same for those of these numbers, which are not changed. */
bool pm__depart_all(const pm__emission *emission, const pm__batch_kernel *kernel, pm__batch *photons);

/* As pm__trace, but straight on through whatever is met: stores at rough surfaces, with power 0 behind the first
 * surface of any kind. config->paths is not looked at; config->emission must be there. */
void pm__trace_straight(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store, void *context);

/* A photon's numbers (pm__random_triple): blocks 0 and 1 are of emission, each step of its path takes the next. */
void pm__trace_uniform(uint64_t seed, uint32_t trial, uint64_t number, uint32_t block, double u[3]);

#endif
