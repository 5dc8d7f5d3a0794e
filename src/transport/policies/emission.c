/* Large sets of photons from where they lead to what matters, small sets of powerful ones from elsewhere; where it does
 * not matter photons of large sets are kept by chance. */
#include "../keep_chance.h"
#include "../send_strata.h"

static const pm__param params[] = {
    PM__SETS_PARAMS,
    {"form", PM__CHOICE, 0, 0, 1, "", "unbiased|printed", "trial photons decide alone, or are the small sets"},
};

/* Powers where it does not matter rise to those of small sets, with importance below the threshold. */
static double chance(const pm__storage *storage, const pm__arrivals *arrivals, size_t i)
{
    const double ratio = storage->values[2];
    if (arrivals->part[i])
        return 1.0;
    const double share = fmax(1.0 / ratio, (double)arrivals->importance[i] / storage->threshold);
    return fmin(1.0, share * pm__load_of(storage, arrivals, i));
}

static pm_status keep_some(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_by_chance(storage, arrivals, chance, taken);
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_but_strays(storage, arrivals, keep_some, taken);
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    (void)unmet;
    return pm__share_strays(storage);
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
