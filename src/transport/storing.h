/* The photons of one map, sent and kept by a policy: which light paths are followed, which photons are stored, and with
 * what power. Every policy keeps the flux: exactly, or in expectation. */
#ifndef PM_TRANSPORT_STORING_H
#define PM_TRANSPORT_STORING_H

#include "../base/param.h"
#include "importance.h"

extern const pm__catalogue pm__policies;

typedef struct pm__storing_config {
    const pm__scene *scene;
    pm__map_kind kind;
    const pm__spec *policy;           /* of pm__policies */
    const pm__importance *importance; /* NULL: the policy asks for none (pm__policy_needs_importance) */
    const pm_map *global;             /* light of all paths, for the convergence criterion of caustics; NULL: none */
    uint64_t seed;
    uint32_t trial;
    uint64_t emitted; /* photons that are sent evenly, or what even sending would be to have as many where they matter:
                         a policy that sends by importance says what it does with it */
    size_t stored;    /* sending ends once so many are stored; SIZE_MAX: never. Then `emitted` is the most */
    const pm_parallel *parallel;
    bool (*canceled)(void *context);
    void *context;
} pm__storing_config;

/* Of all surfaces, and of those that are important (pm__importance_threshold) alone. */
typedef enum pm__part { PM__EVERYWHERE, PM__IMPORTANT, PM__PARTS } pm__part;

typedef struct pm__stored_photons {
    pm_photon *photons;      /* power: W; the map is to be made of them as they are */
    float (*normals)[3];     /* unit, on the side that each came from */
    size_t count;
    uint64_t emitted;        /* photons, those of trial sets too */
    size_t arrived;          /* photons that came to where they could be stored */
    double flux[PM__PARTS];  /* W, all bands: stored */
    double came[PM__PARTS];  /* W: of those that arrived, before the policy */
    double trace_s, policy_s; /* wall clock: sending and following; deciding, keeping, handing out power */
    bool unmet;              /* what the policy requires was not reached when sending ended */
} pm__stored_photons;

bool pm__policy_needs_importance(const pm__spec *policy);

/* The same photons in the same order for any parallel. EINVAL; ENOMEM; ECANCELED; on error the set is empty. Where no
 * photon arrives the set is empty, and that is no error. */
pm_status pm__store_photons(const pm__storing_config *config, pm__stored_photons *set, pm_error *error);
void pm__stored_photons_free(pm__stored_photons *set);

/* Photons to the square metre that the policy asks for where importance is so much; 0: it asks for none. */
double pm__policy_required(const pm__spec *policy, pm__map_kind kind, const pm__importance *importance,
                           double importance_there);

#endif
