/* Large sets of photons from where they lead to what matters, small sets of powerful ones from elsewhere; where it does
 * not matter photons of large sets are kept by chance. */
#include "../keep_level.h"
#include "../send_strata.h"

static const pm__param params[] = {
    PM__SETS_PARAMS_OF(8.0, 16.0, 16.0),
    {"sets", PM__CHOICE, 0, 0, 1, "", "graded|two", "of strata: by what trial photons found, or large and small ones"},
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

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__level_keep(storage, arrivals, chance, taken);
}

static pm_status end(pm__storage *storage, bool *unmet)
{
    (void)unmet;
    return pm__policy_value(storage, "strays", 0.0) == 1.0 ? PM_OK : pm__level_end(storage);
}

static const pm__keeping keeping = {pm__level_begin, keep, end, pm__level_release};

const pm__policy pm__policy_emission = {
    .entry = {.name = "emission",
              .summary = "many photons where trial photons found importance, few powerful ones elsewhere",
              .citation = "Christensen: course 43, 5.7.4; errata 38",
              .params = params,
              .param_count = PM__SETS_PARAM_COUNT + 2},
    .send = &pm__send_sets,
    .keep = &keeping,
    .by_importance = true,
};
