/* Every caustic photon and a share of the global ones, their power over that share: then photons can be emitted until
 * there are enough of caustics, and the global map grows no larger. */
#include "../keep_chance.h"

enum { SHARE };

static const pm__param params[] = {
    {"share", PM__REAL, 0.1, 1e-6, 1.0, "", NULL, "of global photons that are stored"},
};

static double chance(const pm__storage *storage, const pm__arrivals *arrivals, size_t i)
{
    (void)arrivals;
    (void)i;
    return storage->values[SHARE];
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_by_chance(storage, arrivals, storage->config->kind == PM__GLOBAL_MAP ? chance : NULL, taken);
}

static const pm__keeping keeping = {.keep = keep};

const pm__policy pm__policy_percentage = {
    .entry = {.name = "percentage",
              .summary = "every caustic photon, a share of the global ones by chance",
              .citation = "Kato: course 43, 6.2.2",
              .params = params,
              .param_count = 1},
    .keep = &keeping,
};
