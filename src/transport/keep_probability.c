#include "keep_probability.h"

#include "../base/memory.h"
#include "keep_chance.h"
#include "send_strata.h"

#include <math.h>
#include <stdlib.h>

typedef struct chances {
    double full, least; /* full: 1/m2 */
} chances;

static pm_status begin(pm__storage *storage)
{
    const pm__storing_config *const config = storage->config;
    chances *const own = malloc(sizeof *own);
    if (!own)
        return PM_ENOMEM;
    own->full = pm__policy_value(storage, "full", 1.0) * pm__importance_mean(config->importance, config->kind);
    own->least = pm__policy_value(storage, "least", 0.0);
    storage->own = own;
    return PM_OK;
}

static double chance(const pm__storage *storage, const pm__arrivals *arrivals, size_t i)
{
    const chances *const own = storage->own;
    const double importance = (double)arrivals->importance[i];
    const double share = fmax(own->least, own->full > 0.0 ? fmin(importance / own->full, 1.0) : 0.0);
    return fmin(1.0, share * pm__load_of(storage, arrivals, i));
}

static pm_status keep(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken)
{
    return pm__keep_by_chance(storage, arrivals, chance, taken);
}

static void release(pm__storage *storage)
{
    free(storage->own);
}

const pm__keeping pm__keep_probability = {.begin = begin, .keep = keep, .release = release};
