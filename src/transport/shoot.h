/* Photons of a scene, traced and kept: so many emitted or stored, spread by a sampler, on any number of threads. */
#ifndef PM_TRANSPORT_SHOOT_H
#define PM_TRANSPORT_SHOOT_H

#include "../base/sampler.h"
#include "projection.h"
#include "trace.h"

/* Memory that one set of photons after the other lies in: what is touched once need not be cleared by the system again.
 * Empty at first; photons: freed by the owner with free(). */
typedef struct pm__photon_room {
    pm_photon *photons;
    size_t capacity;
} pm__photon_room;

typedef struct pm__shoot_config {
    const pm__scene *scene;
    const pm__paths *paths;           /* which are stored; NULL: all */
    uint64_t seed;
    uint32_t trial;
    const pm__sampler *sampler;       /* of what leaves the lights; NULL: independent photons */
    const pm__projection *projection; /* where photons are sent; NULL: everywhere */
    size_t count;                     /* photons ... */
    bool emitted;                     /* ... emitted; else stored */
    uint64_t most;                    /* emitted, when so many are to be stored: fewer are then; 0: no limit */
    bool normals;                     /* surface normals are wanted too */
    pm__photon_room *room;            /* that the set, of photons emitted without normals, is to lie in: it is gone when
                                         the room is used again. NULL: memory of its own */
    const pm_parallel *parallel;      /* NULL: this thread */
    bool (*canceled)(void *context);  /* NULL: never. Asked by several threads */
    void *context;
} pm__shoot_config;

typedef struct pm__photon_set {
    pm_photon *photons;   /* power: W, shares of what the lights emit: estimates need no further factor */
    float (*normals)[3];  /* unit, on the side that the photon came from; NULL unless asked for */
    size_t count;
    uint64_t emitted;
    bool borrowed;        /* the photons' memory is a room's */
} pm__photon_set;

/* Unbiased whether photons are counted as emitted or stored (errata 37). Photons that are stored along a path: with
 * `emitted` any number. With independent photons exactly `count` are stored when so many are asked for; with other
 * samplers about as many, since a set of points must be whole: how many are emitted is then settled by a trial run with
 * numbers of its own. The same photons in the same order for any parallel. EINVAL: next to none is stored (error says
 * of how many), and `most` is 0; ENOMEM; ECANCELED. On error the set is empty. */
pm_status pm__shoot(const pm__shoot_config *config, pm__photon_set *set, pm_error *error);
void pm__photon_set_free(pm__photon_set *set); /* an empty set is allowed */

/* Shadow photons (Jensen and Christensen 1995; [C02] 2.1): photons of light `light` alone, straight on. The first rough
 * or specular surface that one meets is lit; every rough surface behind it lies in that light's shadow.
 * shadow[i]: photon i is a shadow photon (its power is 0). config->count is of photons emitted; paths and projection
 * are not looked at. *shadow: the caller's, to be freed. */
pm_status pm__shoot_shadows(const pm__shoot_config *config, size_t light, pm__photon_set *set, unsigned char **shadow,
                            pm_error *error);

#endif
