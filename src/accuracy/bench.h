/* Inside the accuracy bench: one job is one case with one sampler and one number of photons. */
#ifndef PM_ACCURACY_BENCH_H
#define PM_ACCURACY_BENCH_H

#include "../lookup/carriers.h"
#include "../transport/shoot.h"
#include "accuracy.h"

enum { PM__MAX_REGIONS = 8, PM__MAX_MAPS = 64, PM__MAX_VARIETIES = 16 };

/* One estimator with one k: a row in each region. */
typedef struct pm__variant {
    const pm__spec *spec;
    const pm__estimator *estimator;
    size_t k;          /* 0: fixed radius */
    double radius;     /* m, INFINITY where there is no limit */
    size_t variety;    /* PM__MAPS, PM__AT_PHOTON, PM__TRUTH: which of the job's deals, fractions or oracles */
    const char *unsupported; /* why it has no estimate in this case, or NULL */
} pm__variant;

/* How photons are dealt to several maps. */
typedef struct pm__deal_kind {
    size_t maps;
    double how; /* the choice of `deal`: separate, random, roundrobin */
} pm__deal_kind;

typedef struct pm__job {
    const pm__accuracy_config *config;
    const pm__case *subject;
    const double *values;
    const pm__spec *case_spec, *sampler_spec;
    size_t asked_photons, photons; /* photons: as the sampler's grid has it; see pm__is_about */
    pm__scene *scene;   /* of a traced case, and the paths whose photons are stored; else NULL */
    pm__paths *paths;

    pm__probe *probes; /* region by region, near ones together */
    double *truth;
    size_t probe_count;
    size_t first[PM__MAX_REGIONS + 1]; /* first probe of each region */
    double truth_mean;

    pm__variant *variants; /* estimator by estimator, k by k */
    size_t variant_count;
    size_t max_k;          /* 0: fixed radius only */
    double max_radius;     /* m */
    bool offsets;          /* some variant asks for them */

    pm__deal_kind deals[PM__MAX_VARIETIES];
    size_t deal_count;
    double fractions[PM__MAX_VARIETIES]; /* of photons that carry an estimate */
    size_t fraction_count;
    const pm__spec *oracles[PM__MAX_VARIETIES];
    size_t oracle_count;
    size_t *candidates;    /* the oracles' choices of k, ascending */
    size_t candidate_count;

    float *errors;         /* [variant][trial][probe]: estimate less truth */
    float *oracle_errors;  /* [oracle][candidate][trial][probe] */
    double *expected_square; /* [oracle][candidate][probe]: of the error, by theory; NAN where there is none */
    size_t *degenerate;    /* [trial][variant]: estimates that do not exist, counted as 0 */
    pm_status *trial_status;

    double *predicted_mean, *predicted_variance; /* [variant][probe], NAN where there is no theory */

    void (*trial_done)(struct pm__job *job);
    void *owner;
} pm__job;

static inline bool pm__is_canceled(const pm__accuracy_config *config)
{
    return config->canceled && config->canceled(config->context);
}

/* The maps of one trial. */
typedef struct pm__trial_maps {
    pm_map *map;
    pm_map *dealt[PM__MAX_VARIETIES][PM__MAX_MAPS];
    pm__carriers carriers[PM__MAX_VARIETIES];
} pm__trial_maps;

/* What one thread needs to look up and evaluate. */
typedef struct pm__bench_lookup {
    const pm__job *job;
    const pm__trial_maps *maps;
    const pm_search *search;
    pm_workspace *workspace;
    double guess; /* m: a radius that probably holds the photons; INFINITY: none */
    pm_source source; /* in cases of radiance: the BRDF, and the direction of the probe in hand */
} pm__bench_lookup;

/* job.c: what can be known to be wrong with a job before it starts: EINVAL, ENOMEM. Costs next to nothing. */
pm_status pm__job_check(const pm__accuracy_config *config, const pm__spec *case_spec, const pm__spec *sampler_spec,
                        size_t photons, pm_error *error);

/* The plan of a job; allocates everything above but the maps. */
pm_status pm__job_plan(pm__job *job, const pm__accuracy_config *config, const pm__spec *case_spec,
                       const pm__spec *sampler_spec, size_t photons, pm_error *error);
void pm__job_free(pm__job *job);

/* traced.c: the scene and the paths of a traced case; nothing for others. */
pm_status pm__job_scene(pm__job *job, pm_error *error);

/* draw.c: `count` photons of trial `trial`, drawn or traced; part > 0 for the part-th of several separately drawn maps
 * that share the power. There are pm__drawn_count of them: a sampler may round; about so many where pm__is_about.
 * EINVAL: next to no traced photon is stored; ENOMEM, ECANCELED. On error the set is empty. */
size_t pm__drawn_count(const pm__job *job, size_t count);
pm_status pm__draw_photons(const pm__job *job, uint32_t trial, uint32_t part, uint32_t parts, size_t count,
                           bool normals, pm__photon_set *set);
bool pm__is_about(const pm__job *job); /* does the count differ from trial to trial? */
/* deal.maps of them, of the photons given or (separate) of samples of their own. On error those made are the
 * caller's. */
pm_status pm__deal_maps(const pm__job *job, const pm__deal_kind *deal, uint32_t trial, const pm__photon_set *set,
                        pm_map **maps);
bool pm__is_separate(const pm__deal_kind *deal);
pm_status pm__trial_maps_create(const pm__job *job, uint32_t trial, pm__trial_maps *maps);
void pm__trial_maps_destroy(pm__trial_maps *maps);

/* lookup.c: the query of a probe, which becomes the one in hand, and a variant's estimate there from sets that hold at
 * least its photons. */
pm_query pm__probe_query(pm__bench_lookup *lookup, size_t probe, size_t k, double radius);
pm_status pm__evaluate_variant(const pm__bench_lookup *lookup, const pm__variant *variant, size_t oracle_k,
                               const float normal[3], const pm__neighbors *sets, size_t set_count, double *value);
/* Where the BRDF of the probe in hand comes from; NULL: irradiance is asked for. */
const pm_source *pm__source_of(const pm__bench_lookup *lookup);
/* Gathers what variants of a kind need; the sets are in the workspace. */
pm_status pm__gather_main(const pm__bench_lookup *lookup, const pm_query *query);
pm_status pm__gather_dealt(const pm__bench_lookup *lookup, size_t deal, const pm_query *query);

/* trial.c: one trial's errors at all probes; a task for pm__for. */
void pm__run_trial(void *job, size_t trial);

/* predict.c: fills predicted_mean, predicted_variance and expected_square. */
pm_status pm__predict(pm__job *job);

/* oracle.c: fills the errors of oracle variants, once all trials and the theory are there. */
pm_status pm__apply_oracles(pm__job *job);

/* timing.c: times each variant on this thread; results by variant. */
typedef struct pm__timing {
    double ns_per_query;
    pm__interval ns_per_query_ci95;
    double cost_s;
} pm__timing;
pm_status pm__time_variants(const pm__job *job, pm__timing *timings);

/* rows.c: the rows of a finished job, appended. timings may be NULL. */
pm_status pm__append_rows(const pm__job *job, const pm__timing *timings, pm__accuracy_row **rows, size_t *count);

#endif
