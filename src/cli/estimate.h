/* Estimates at a user's points from a user's photons. */
#ifndef PM_CLI_ESTIMATE_H
#define PM_CLI_ESTIMATE_H

#include "../../estimators/estimator.h"
#include "../photonmap.h"

/* Zero it, fill in the first part, then load, build, run and free. */
typedef struct pm__estimate {
    const pm__spec *spec;
    pm_query lookup;       /* all but position and normal; max_radius only where it is not automatic */
    double radius;         /* m, as given; 0: none, or automatic */
    double auto_threshold; /* W/(m2 sr); 0: not automatic */
    uint64_t seed;         /* for dealing photons to several maps */
    const pm_parallel *parallel;
    size_t threads; /* that `parallel` runs on */
    double memory;  /* bytes that all of it may take; 0: as many as it wants */
    bool (*canceled)(void);

    pm_photon *photons;
    float (*normals)[3]; /* NULL where the file has none */
    size_t photon_count;
    pm_surface_point *points;
    size_t point_count;

    pm_estimator *estimator;
    pm_map **maps;
    size_t map_count;
    pm_precomputed *precomputed;

    pm_estimation *estimations; /* point_count of them, in the points' order */
    pm_status *statuses;
} pm__estimate;

/* Refuses what cannot be done with files, or with so few photons. EINVAL. */
pm_status pm__estimate_check(const pm__estimate *estimate, pm_error *error);

/* Any status but OK and ENOMEM is the input's fault. ENOMEM too where the files hold more than `memory` allows to work
 * with: found out before they are read. */
pm_status pm__estimate_load(pm__estimate *estimate, const char *photon_path, const char *query_path, pm_error *error);

/* Builds the maps. As above. */
pm_status pm__estimate_build(pm__estimate *estimate, pm_error *error);

/* EDEGENERATE is a matter of each point (statuses); ECANCELED, EINVAL and ENOMEM of the whole. */
pm_status pm__estimate_run(pm__estimate *estimate, pm_error *error);

void pm__estimate_free(pm__estimate *estimate);

#endif
