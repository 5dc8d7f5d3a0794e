/* Sent as by emission, kept as by probability. */
#include "../keep_probability.h"
#include "../send_strata.h"
#include "../strays.h"

static const pm__param params[] = {PM__SETS_PARAMS, PM__PROBABILITY_PARAMS};

static pm_status begin(pm__storage *storage)
{
    return pm__keep_probability.begin(storage);
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_but_strays(storage, arrivals, pm__keep_probability.keep, taken);
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    (void)unmet;
    return pm__give_strays(storage);
}

static void release(pm__storage *storage)
{
    pm__keep_probability.release(storage);
}

static const pm__keeping keeping = {begin, keep, end, release};

const pm__policy pm__policy_emission_probability = {
    .entry = {.name = "emission+probability",
              .summary = "sent by importance, stored with a probability by importance",
              .citation = "course 43, 5.7.4 and 3.5.1",
              .params = params,
              .param_count = PM__SETS_PARAM_COUNT + PM__PROBABILITY_PARAM_COUNT},
    .send = &pm__send_sets,
    .keep = &keeping,
    .by_importance = true,
};
