/* One set of photons dealt to several maps: combined maps, [C02] 5.6. */
#ifndef PM_TRANSPORT_DEAL_H
#define PM_TRANSPORT_DEAL_H

#include "../photonmap.h"

#include <stdbool.h>
#include <stdint.h>

/* The choices of the parameter `deal` of estimators that combine maps: of samples of their own, or of one sample. */
enum { PM__DEAL_SEPARATE, PM__DEAL_RANDOM, PM__DEAL_ROUND_ROBIN };

typedef struct pm__dealing {
    size_t maps;
    bool round_robin; /* photon i to map i mod maps; else each to one at random (errata 11, 12) */
    uint64_t seed;
    uint32_t trial;
} pm__dealing;

/* Bytes a photon that it holds for the while, beside what building a map takes. */
enum { PM__BYTES_TO_DEAL = sizeof(pm_photon) + sizeof(uint32_t) };

/* made[maps]: the caller's to destroy, also on error (those not made are as they were). ENOMEM, EINVAL as
 * pm_map_create. */
pm_status pm__deal(const pm__dealing *dealing, const pm_photon *photons, size_t count, const pm_map_options *options,
                   pm_map **made, pm_error *error);

#endif
