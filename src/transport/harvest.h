/* Photons as they are stored, gathered from paths that are traced on any number of threads, in the order of the paths'
 * numbers. Which are taken depends on what those before them stored, never on threads. */
#ifndef PM_TRANSPORT_HARVEST_H
#define PM_TRANSPORT_HARVEST_H

#include "shoot.h"

/* Traces paths first .. first + count - 1, in order. */
typedef void (*pm__tracer)(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context);

/* A photon's mark: how many photons its path stores, and these. */
enum { PM__PATH_LENGTH = 0x3fff, PM__FIRST_OF_PATH = 0x4000, PM__NO_POWER = 0x8000 };

typedef struct pm__harvest_wish {
    pm__tracer tracer;
    const void *tracing;
    double power;   /* W: about what a path carries */
    double share;   /* what a photon stands for of what is sent; 0: that is settled later */
    uint64_t first; /* the number of the first path */
    uint64_t most;  /* paths */
    size_t wanted;  /* stored photons; SIZE_MAX: those of all paths */
    bool marks, numbers;
} pm__harvest_wish;

typedef struct pm__harvest {
    pm_photon *photons;   /* power: W; without a share in units of `unit`, as if the number of photons emitted were 1 */
    float (*normals)[3];  /* NULL unless config has them wanted */
    uint16_t *marks;      /* NULL unless wished */
    uint32_t *numbers;    /* of their paths, the first being 0; NULL unless wished: then `most` is below 2^32 */
    size_t count;
    uint64_t emitted;
    double unit;          /* W: a power of two about the power that is sent, so that floats hold what scenes do not */
} pm__harvest;

/* Where config has room, and no normals, marks or numbers are wanted, photons lie in that; after an error it is empty.
 *
 * Traces paths until `wanted` photons are stored, the last path as a whole, or `most` paths are traced, or next to none
 * is stored: then count < wanted. Uses config's normals, parallel and canceled. Memory: what is given back, and for
 * each thread what about a thousand paths store; while one of them lags behind, what 131072 paths do at most. EINVAL:
 * a photon's power is more than a float holds; ENOMEM; ECANCELED; on error nothing is to be freed. */
pm_status pm__harvest_paths(const pm__shoot_config *config, const pm__harvest_wish *wish, pm__harvest *harvest,
                            pm_error *error);
void pm__harvest_free(pm__harvest *harvest);

#endif
