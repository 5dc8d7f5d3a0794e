/* Photons as they are stored, gathered from paths that are traced on any number of threads, in the order of their
 * numbers: blocks of paths, in rounds whose extent depends on what was stored before, never on threads. */
#ifndef PM_TRANSPORT_HARVEST_H
#define PM_TRANSPORT_HARVEST_H

#include "shoot.h"

/* Traces paths first .. first + count - 1, in order. */
typedef void (*pm__tracer)(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context);

enum { PM__FIRST_OF_PATH = 1, PM__NO_POWER = 2 };

typedef struct pm__harvest {
    pm_photon *photons;   /* power: in units of `unit`, as if the number of photons emitted were 1 */
    float (*normals)[3];  /* NULL unless wanted */
    unsigned char *marks; /* of each photon: PM__FIRST_OF_PATH, PM__NO_POWER */
    size_t count;
    uint64_t emitted;
    double unit;          /* W: a power of two about the power that is sent, so that floats hold what scenes do not */
} pm__harvest;

/* Traces `most` paths from number `first` on, or fewer: no more than are needed for `wanted` stored photons (SIZE_MAX:
 * all paths), the last path as a whole. Uses config's normals, parallel and canceled. Gives up where next to none is
 * stored: then count < wanted. ENOMEM, ECANCELED; on error nothing is to be freed. */
pm_status pm__harvest_paths(const pm__shoot_config *config, pm__tracer tracer, const void *tracing, double power,
                            uint64_t first, uint64_t most, size_t wanted, pm__harvest *harvest, pm_error *error);
void pm__harvest_free(pm__harvest *harvest);

#endif
