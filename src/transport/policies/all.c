/* Every photon that arrives. */
#include "../keep_chance.h"

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_by_chance(storage, arrivals, NULL, taken);
}

static const pm__keeping keeping = {.keep = keep};

const pm__policy pm__policy_all = {
    .entry = {.name = "all", .summary = "every photon that arrives is stored", .citation = "course 43, 2.1"},
    .keep = &keeping,
};
