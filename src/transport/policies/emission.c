/* Large sets of photons from where they lead to what matters, small sets of powerful ones from elsewhere; all are
 * stored, but powerful ones split where it matters. */
#include "../keep_chance.h"
#include "../send_strata.h"
#include "../strays.h"

static const pm__param params[] = {
    PM__SETS_PARAMS_OF(8.0, 16.0, 64.0),
    {"form", PM__CHOICE, 0, 0, 1, "", "unbiased|printed", "trial photons decide alone, or are the small sets"},
};

static pm_status keep_all(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_by_chance(storage, arrivals, NULL, taken);
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    const size_t before = storage->stock.count;
    pm_status status = keep_all(storage, arrivals, taken);
    if (status == PM_OK)
        status = pm__note_paths(storage, arrivals, before);
    return status == PM_OK ? pm__note_strays(storage, before) : status;
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    (void)unmet;
    return pm__split_strays(storage);
}

static const pm__keeping keeping = {.keep = keep, .end = end};

const pm__policy pm__policy_emission = {
    .entry = {.name = "emission",
              .summary = "many photons where trial photons found importance, few powerful ones elsewhere",
              .citation = "Christensen: course 43, 5.7.4; errata 38",
              .params = params,
              .param_count = PM__SETS_PARAM_COUNT + 1},
    .send = &pm__send_sets,
    .keep = &keeping,
    .by_importance = true,
};
