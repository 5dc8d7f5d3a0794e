/* One set of photons dealt to several maps: combined maps, [C02] 5.6. */
#ifndef PM_TRANSPORT_DEAL_H
#define PM_TRANSPORT_DEAL_H

#include "../photonmap.h"

#include <stdbool.h>

typedef struct pm__dealing {
    size_t maps;
    bool round_robin; /* photon i to map i mod maps; else each to one at random */
    uint64_t seed;
    uint32_t trial;
} pm__dealing;

/* made[maps]: the caller's to destroy, also on error (those not made are as they were). ENOMEM. */
pm_status pm__deal(const pm__dealing *dealing, const pm_photon *photons, size_t count, const pm_map_options *options,
                   pm_map **made);

#endif
