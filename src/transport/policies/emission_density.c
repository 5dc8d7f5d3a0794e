/* Sent as by emission, kept as by density. */
#include "../keep_density.h"
#include "../send_strata.h"
#include "../strays.h"

static const pm__param params[] = {PM__SETS_PARAMS, PM__DENSITY_PARAMS};

static pm_status begin(pm__storage *storage)
{
    return pm__keep_density.begin(storage);
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_but_strays(storage, arrivals, pm__keep_density.keep, taken);
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    const pm_status status = pm__keep_density.end(storage, unmet);
    return status == PM_OK ? pm__give_strays(storage) : status;
}

static void release(pm__storage *storage)
{
    pm__keep_density.release(storage);
}

static const pm__keeping keeping = {begin, keep, end, release};

const pm__policy pm__policy_emission_density = {
    .entry = {.name = "emission+density",
              .summary = "sent by importance, stored up to a required density",
              .citation = "course 43, 5.7.4 and 3.5.2",
              .params = params,
              .param_count = PM__SETS_PARAM_COUNT + PM__DENSITY_PARAM_COUNT},
    .send = &pm__send_sets,
    .keep = &keeping,
    .by_importance = true,
    .required = pm__density_required,
};
