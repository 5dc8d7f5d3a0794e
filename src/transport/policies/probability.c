/* Photons by importance, their power over the probability. */
#include "../keep_probability.h"

static const pm__param params[] = {PM__PROBABILITY_PARAMS};

const pm__policy pm__policy_probability = {
    .entry = {.name = "probability",
              .summary = "photons are stored with a probability by importance, power over probability",
              .citation = "Keller and Wald 2000; course 43, 3.5.1",
              .params = params,
              .param_count = PM__PROBABILITY_PARAM_COUNT},
    .keep = &pm__keep_probability,
    .by_importance = true,
};
