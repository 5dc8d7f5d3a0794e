/* Irradiance computed beforehand at a share of the photons, and used at the nearest of them ([C02] 5.4): what final
 * gathering looks up. Each estimator's own, with the photon at which it is computed: it is there for certain, which is
 * one too many, but photons in thin spots stand for more points, which takes it back. From k = 50 on flat estimates
 * keep the mean that they have elsewhere; kernels, which weigh that photon most, are a little bright (errata 13). */
#ifndef PM_METHODS_IRRADIANCE_H
#define PM_METHODS_IRRADIANCE_H

#include "../lookup/carriers.h"
#include "maps.h"

typedef struct pm__irradiance {
    const pm__render_job *job;
    const pm__maps *maps;
    pm__carriers carriers;
    float (*values)[3]; /* W/m2, [image * carriers.count + carrier] */
    float *radius;      /* m, [carrier]: of the lookup */
    bool whole;         /* edges are made up for */
} pm__irradiance;

/* maps: with normals; must outlive the result. whole: photons of other surfaces are left out, and what of a disc is no
 * surface is made up for, by rays (coverage.h); else as estimators have it. ENOMEM, ECANCELED. On error all is
 * released. */
pm_status pm__irradiance_create(const pm__render_job *job, const pm__maps *maps, double fraction, bool whole,
                                pm__irradiance *irradiance, pm_error *error);
void pm__irradiance_destroy(pm__irradiance *irradiance); /* an empty one is allowed */

/* The photon whose values stand for the point that the eye has reached; SIZE_MAX: none lies on such a surface. */
pm_status pm__irradiance_find(const pm__irradiance *irradiance, const pm__eye *eye, pm_workspace *workspace,
                              size_t *carrier);

#endif
