/* What storage policies cost, and what they are worth in the rendered view: photons sent and stored, time, flux that
 * was kept, and the error of the scene's image against its stored reference.
 *
 * A row is one policy, map and number of photons, over independent trials; the image is that of viewing.h, where all
 * but the map in question stays the same, and its errors are those of tally.h. A front compares a policy with `all` at
 * equal error. Trials run one after the other over all rows, so that all have as many. */
#ifndef PM_STORAGE_STORAGE_H
#define PM_STORAGE_STORAGE_H

#include "../image/image.h"
#include "../transport/storing.h"
#include "tally.h"

enum { PM__STORAGE_DETAIL = 160 };

typedef struct pm__storage_wish {
    const pm__spec *scene;         /* of pm__scene_cases */
    const pm__spec *policies;      /* [policy_count] */
    const size_t *photons;         /* [photon_count]: sent */
    const size_t *stored;          /* [stored_count]: sending ends once so many are stored */
    size_t policy_count, photon_count, stored_count;
    bool maps[PM__MAP_KINDS];      /* asked for; no rows of those that the scene has not */
    size_t width, height;          /* pixels; 0: as many as the reference has */
    size_t spp;                    /* eye paths of a pixel by which maps are looked at, a multiple of PM__GROUPS */
    size_t looks;                  /* where spp is 0: about so many for the whole image */
    size_t gather;                 /* viewing.h */
    size_t large;                  /* photons in large maps */
    size_t k;                      /* photons in a lookup */
    size_t paths;                  /* eye paths of importance */
    pm__measure measure;
    double share;                  /* importance.h */
    size_t trials;                 /* >= 2 */
    double seconds;                /* no further trial once they have gone by, but two; 0: no limit */
    uint64_t seed;
    bool images;                   /* are wanted too */
    const pm_parallel *parallel;
    void (*progress)(void *context, double fraction, const char *what); /* may be NULL */
    bool (*canceled)(void *context);                                    /* may be NULL. Asked by several threads */
    void *context;
} pm__storage_wish;

/* NAN (intervals: low is NAN) stands for a value that does not exist. Means are over trials; times are wall clock,
 * medians over trials. */
typedef struct pm__storage_row {
    const pm__spec *policy;
    pm__map_kind map;
    size_t photons, wanted;       /* sent, or stored, as asked for: the other is 0 */
    size_t trials;                /* done */
    size_t importons;             /* of this map's importance; 0: the policy needs none */
    double emitted, stored;       /* means */
    double importance_s, trace_s, policy_s, build_s, total_s; /* total: all of them, until the map can be looked up */
    double cost_added;            /* trace_s + policy_s over those of `all` asked for as many, less 1; NAN: no `all` */
    double flux[PM__PARTS];       /* W, all bands: stored */
    double expected[PM__PARTS];   /* W: what comes with even sending, by `all` with the largest number */
    pm__interval flux_ci95[PM__PARTS]; /* of flux over expected, over trials */
    double kept;                  /* flux over that of the same photons as they came: what the policy itself loses */
    double spread;                /* the largest over trials and important places: of k neighbours the largest power
                                     over their median */
    size_t unmet;                 /* trials in which the policy's demand was not met */
    size_t starved;               /* in which 64 times `wanted` were sent, and so many were still not stored */
    pm__view_error error;         /* relative to the reference's mean */
} pm__storage_row;

/* At equal error to `all`: how many times as many photons, and how much more time, it needs. By what maps add
 * (tally.h), which knows little of the noise that all share; by the whole error where a row adds nothing to that of
 * large maps. At the least error that both reach: that of a size of one of them; what the other costs there follows
 * from its sizes, by straight lines between logarithms. Intervals are over trials: both are given the same ones. */
typedef struct pm__storage_front {
    const pm__spec *policy;
    pm__map_kind map;
    bool whole;                    /* by the whole error; else by what is added */
    double rel_error;              /* at which */
    double stored_ratio, trace_ratio, time_ratio;
    pm__interval stored_ci95, trace_ci95, time_ci95;
    size_t *stored_front, *time_front; /* rows of the policy that no other of its own beats in both; ascending cost */
    size_t stored_count, time_count;
    char detail[PM__STORAGE_DETAIL];   /* why there are no ratios */
} pm__storage_front;

typedef enum pm__density_kind { PM__REQUIRED_DENSITY, PM__ACTUAL_DENSITY, PM__CONVERGENCE } pm__density_kind;

/* Of the first trial and a policy's largest number, at what the middle of each pixel shows, straight or through mirrors
 * and glass. One channel; NAN: nothing is seen, or the value does not exist. */
typedef struct pm__density_image {
    pm__density_kind kind;
    pm__map_kind map;
    const pm__spec *policy; /* NULL: required, by the first policy that requires any, or `density` */
    pm__image image;        /* 1/m2, 1/m2, C(x) */
    pm__image reached;      /* of convergence: actual over required density */
} pm__density_image;

typedef struct pm__storage_result {
    pm__storage_row *rows;
    pm__storage_front *fronts;
    pm__density_image *images;
    size_t row_count, front_count, image_count;
    size_t width, height, spp; /* pixels; eye paths of each by which maps were looked at */
    size_t trials;             /* done by all rows */
    double truth_mean;         /* of the reference, W/(m2 sr) */
    double near;               /* m: viewing.h */
    bool has[PM__MAP_KINDS];   /* does the scene have such photons? */
    bool interrupted;          /* canceled: rows are of the trials that they had, if two or more */
} pm__storage_result;

/* EINVAL: what is asked for cannot be (no reference, a size that does not fit it, no light that maps hold); ENOMEM.
 * Canceled: PM_OK with `interrupted`. Free the result by pm__storage_free in any case. */
pm_status pm__storage_measure(const pm__storage_wish *wish, pm__storage_result *result, pm_error *error);
void pm__storage_free(pm__storage_result *result);

/* EINVAL as above, before anything is done. */
pm_status pm__storage_check(const pm__storage_wish *wish, pm_error *error);

/* What it will hold, bytes; 0 where there is no reference. */
double pm__storage_bytes(const pm__storage_wish *wish);

#endif
