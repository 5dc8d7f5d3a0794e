/* Photons in proportion to the importance that trial photons find, uneven powers and all. */
#include "../keep_chance.h"
#include "../send_strata.h"

static const pm__param params[] = {
    PM__STRATA_PARAMS,
    {"least", PM__REAL, 0.05, 1e-6, 1.0, "", NULL, "share of all photons that is sent evenly"},
};

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_by_chance(storage, arrivals, NULL, taken);
}

static const pm__keeping keeping = {.keep = keep};

const pm__policy pm__policy_peter_pietrek = {
    .entry = {.name = "peter-pietrek",
              .summary = "photons are sent in proportion to the importance that they lead to; all are stored",
              .citation = "Peter and Pietrek 1998; course 43, 3.5.3",
              .params = params,
              .param_count = PM__STRATA_PARAM_COUNT + 1},
    .send = &pm__send_by_importance,
    .keep = &keeping,
    .by_importance = true,
};
