/* Methods whose answer gets better pass by pass, and a run of one.
 *
 * A run measures radiance at points, one for each pixel of an image of the scene: where the eye first meets a rough
 * surface, directly or through mirrors and glass. Each pass emits photons of its own, looks them up at the points and
 * takes what it finds into the state of each point, of fixed size: memory does not grow with passes (but for methods
 * that say so). A run depends on its configuration, its trial and the number of passes alone, so that it can be taken
 * up again from its state; not on threads. */
#ifndef PM_METHODS_PROGRESSIVE_H
#define PM_METHODS_PROGRESSIVE_H

#include "../../lookup/lookup.h"
#include "../../transport/shoot.h"
#include "../../transport/eye.h"
#include "../stage.h"

enum { PM__OWN_FIELDS = 8 }; /* doubles of a point that estimates of the error need */

typedef struct pm__progressive_config {
    const pm__spec *scene;         /* of pm__scene_cases */
    const pm__view *view;          /* NULL: the scene's own */
    size_t width, height;          /* of the image: how many points there are */
    const pm__spec *method;        /* of pm__progressives */
    const pm_estimator *estimator; /* the kernel of lookups */
    double alpha;                  /* in (0, 1): the share of new photons that is kept as radii shrink */
    double radius;                 /* m, of the first lookup; 0: at each point that of its k nearest photons */
    size_t k;                      /* photons of such a lookup, and of lookups of methods that do not shrink */
    size_t photons;                /* emitted a pass */
    bool front_only;               /* lookups refuse photons from behind, where there can be any */
    const pm_search *search;       /* NULL: the fastest for the lookups that there are */
    const pm__sampler *sampler;    /* of emission; NULL: independent photons */
    uint64_t seed;
    bool estimates;                /* runs estimate their own error */
    const pm_parallel *parallel;
    bool (*canceled)(void *context); /* may be NULL; asked by several threads */
    void *context;
} pm__progressive_config;

/* A point where radiance is wanted, and what its estimates are multiplied by. */
typedef struct pm__hit_point {
    double position[3], normal[3]; /* m; unit, on our side */
    double outgoing[3];            /* unit, back along the eye's ray */
    double weight[3];              /* of what it sends, by band */
    double emitted[3];             /* W/(m2 sr): lights seen on the way */
    const pm__material *material;  /* NULL: no rough surface is reached, only `emitted` is seen */
    bool back;                     /* our side is the material's back */
} pm__hit_point;

/* Photons that find the points (cover.h), in the place of points that look for photons in a map of them. */
typedef struct pm__meeting {
    bool by_photons;
    size_t chunk, chunks; /* photons of a task; tasks whose pairs of a photon and a point are kept at once; both >= 1 */
    size_t pairs;         /* for which each of them has room, more or less */
} pm__meeting;

/* What all runs of a configuration have in common. */
typedef struct pm__progression {
    const pm__progressive_config *config;
    pm__stage stage;
    const char *expression;  /* of the light paths that are traced and measured: those of the scene's exact answer, or
                                all */
    pm__paths *paths;
    bool front, directions;  /* lookups refuse photons from behind; maps keep directions */
    size_t points;
    pm__hit_point *fixed;    /* [points]: through the middle of each pixel */
    float *radius;           /* [points]: m, of the first lookup. The same for all trials */
    double moment;           /* m2 of the kernel (curvature.h), where errors are estimated and lookups shrink */
    pm__meeting meeting;     /* how photons and points meet: times depend on it, and sums by rounding. No bit of them
                                does on the sizes */
} pm__progression;

/* EINVAL: what is asked for cannot be (error says why); ENOMEM, ECANCELED. On error all is released. */
pm_status pm__progression_open(const pm__progressive_config *config, pm__progression *progression, pm_error *error);
void pm__progression_close(pm__progression *progression);

typedef struct pm__run {
    const pm__progression *of;
    uint64_t seed;   /* of this trial's photons and paths */
    uint32_t passes; /* done */
    double *state;   /* [points * fields], and behind them what estimates of the error need */
    void *own;       /* of methods that keep more than that */
    pm__photon_room room;    /* of a pass's photons where these seek the points */
    struct pm__cover *cover; /* of the points, once photons have sought them; NULL: not so */
    uint64_t emitted, stored; /* photons, of all passes */
    double trace_s, build_s, lookup_s; /* wall clock */
} pm__run;

/* Doubles of a run's state. */
size_t pm__run_state_count(const pm__progression *progression);

/* Trial `trial`, before its first pass. ENOMEM; then there is nothing to end. */
pm_status pm__run_begin(const pm__progression *progression, uint32_t trial, pm__run *run, pm_error *error);
void pm__run_end(pm__run *run);

/* One more pass. ECANCELED: the run is as it was before, and can be saved. After another error (ENOMEM, EINVAL: no
 * light) it can only be ended. */
pm_status pm__run_pass(pm__run *run, pm_error *error);

/* Goes on from a state that was saved: `passes` of them are done. The counts of photons are the caller's to restore. */
pm_status pm__run_resume(pm__run *run, const double *state, uint32_t passes, pm_error *error);

/* The answer after the passes done so far, at every point: radiance[points], W/(m2 sr). ENOMEM, ECANCELED. */
pm_status pm__run_read(pm__run *run, double (*radiance)[3], pm_error *error);

/* A point's statistics: radius of the next lookup, m (0: there is none), and photons that count so far. */
typedef struct pm__point_view {
    double radius, count;
} pm__point_view;
pm__point_view pm__run_view(const pm__run *run, size_t point);

/* What a run can tell of its answer's error at a point without the truth (estimates.c), where the configuration has
 * `estimates`. NAN before the second pass. */
typedef struct pm__own_error {
    double variance;      /* of the answer, (W/(m2 sr))^2, mean over bands */
    double bias[3];       /* W/(m2 sr), by band; unbiased but for what curvature.h says of the Laplacian */
    double bias_variance; /* of that estimate of the bias, mean over bands */
} pm__own_error;
pm__own_error pm__run_own_error(const pm__run *run, size_t point);

/* What the root of the mean square over bands of the answer's error at the point stays below with the confidence given
 * (0.5 < confidence < 1), W/(m2 sr). */
double pm__run_own_bound(const pm__run *run, size_t point, double confidence);

/* The estimated rms error over points[count] (NULL: all) and bands, over the mean of the answer there. NAN before the
 * second pass, and where all is black. */
double pm__run_own_rel_rmse(const pm__run *run, const size_t *points, size_t count);

/* ---- For methods ------------------------------------------------------------------------------- */

/* What a lookup found. Where there was none (no surface, no radius) all is 0 but `emitted`. */
typedef struct pm__found {
    double radiance[3]; /* W/(m2 sr), weighted: the estimate of this pass alone */
    double emitted[3];  /* of the point: pm__hit_point. To methods that are `summed` 0 */
    double area;        /* m2, of the lookup: pi r^2; 0 where there was none */
    size_t count;       /* photons */
    const pm__neighbors *neighbors; /* NULL where there was no lookup; methods that are `summed` must not ask */
    double unit;        /* m in the neighbours' unit; 0 where there are none */
    double share[3];    /* weight times BRDF where the surface scatters evenly: radiance of a unit of irradiance */
} pm__found;

/* What is expected of an answer after several passes. */
typedef enum pm__progress_law {
    PM__LAW_UNKNOWN,
    PM__LAW_SHRINKING, /* the mean of the passes' estimates, radii by the schedule */
    PM__LAW_MEAN,      /* the mean of estimates of k photons each */
    PM__LAW_POOLED,    /* their flux over their areas */
    PM__LAW_GROWING,   /* one estimate on the photons of all passes */
    PM__LAW_UNBIASED   /* the mean of independent answers without a bias */
} pm__progress_law;

typedef struct pm__progressive {
    pm__entry entry;
    bool uses_photons; /* else neither kernel nor radius matters */
    bool no_lookups;   /* nor do they here: photons are used otherwise */
    bool redraws;      /* points are drawn anew in each pass: the answer is the mean over a pixel, not that at its
                          middle */
    bool shrinks;      /* lookups have a radius that shrinks from the first one, by alpha; else k photons */
    bool summed;       /* points stay, and `take` wants sums of what is found alone: radiance, area, count, share; what
                          finds nothing it leaves as it is. Then photons may find the points */
    size_t fields;     /* doubles of a point's state, all 0 before the first pass unless `begin` says otherwise */
    void (*begin)(const pm__run *run, size_t point, double *state); /* may be NULL */
    /* The next lookup's k and radius, in m; k = 0: all within the radius. */
    void (*ask)(const pm__run *run, size_t point, const double *state, size_t *k, double *radius);
    /* Takes what the lookup found, where there is a surface. */
    void (*take)(const pm__run *run, const pm__found *found, double *state);
    /* The answer: run->passes of them are done, at least one. */
    void (*answer)(const pm__run *run, const double *state, double radiance[3]);
    pm__point_view (*view)(const pm__run *run, size_t point, const double *state);

    /* Is the answer the mean of the passes' estimates, and each of these wrong by noise and by its kernel's blur alone?
     * Only then can a run say how large its error is. NULL: no. */
    bool (*averages)(const double *values);

    /* For predictions. schedule: squared radius of the lookup of pass j (from 0; a fraction where not every pass finds
     * a surface) over that of the first, where photons are as dense in every pass. */
    pm__progress_law law;
    double (*schedule)(const double *values, double alpha, double pass); /* of PM__LAW_SHRINKING */
    size_t (*photons_of)(const pm__progressive_config *config, uint32_t passes); /* k of PM__LAW_GROWING */

    /* Instead of shooting, mapping and looking up. NULL: that is what a pass does. Must not stop, canceled, once it has
     * begun to write to the state. */
    pm_status (*pass)(pm__run *run, pm_error *error);
    /* Before answers are read, and when a run is resumed behind its passes; NULL: nothing is to be done. */
    pm_status (*settle)(pm__run *run, pm_error *error);
    void (*release)(pm__run *run); /* what `own` holds; may be NULL */
} pm__progressive;

/* Does it look photons up, so that a kernel and k matter? */
static inline bool pm__progressive_looks_up(const pm__progressive *method)
{
    return method->uses_photons && !method->no_lookups;
}
static inline const pm__progressive *pm__progressive_of(const pm__run *run)
{
    return (const pm__progressive *)(const void *)run->of->config->method->entry;
}
static inline const double *pm__progressive_values(const pm__run *run)
{
    return run->of->config->method->values;
}

/* Photons of pass `pass`, and a map of photons: run's counts and times are added to. */
pm_status pm__run_shoot(pm__run *run, uint32_t pass, pm__photon_set *set, pm_error *error);
pm_status pm__run_map(pm__run *run, const pm__photon_set *set, pm_map **map, pm_error *error);
/* The map of a pass: where lookups have a radius and no k, one that is built for them, unless the configuration has a
 * search. */
pm_status pm__run_pass_map(pm__run *run, const pm__photon_set *set, pm_map **map, pm_error *error);
/* Looks up at every point by the method's ask and take. */
pm_status pm__run_lookups(pm__run *run, const pm_map *map, pm_error *error);
/* Looks, at fixed points, only for what tells of the estimates' bias: before the state takes the same photons. */
pm_status pm__run_further_lookups(pm__run *run, const pm_map *map, pm_error *error);

/* `averages` of most. */
static inline bool pm__always_averages(const double *values)
{
    (void)values;
    return true;
}
/* For estimates of the error: how far a lookup must reach beside one of the radius r, in m, and what is found there of
 * a bias; after a pass, what it has added to the answers. */
double pm__own_reach(double radius);
void pm__run_own_bias(pm__run *run, size_t point, const pm__found *found, double radius);
void pm__run_own_take(pm__run *run);

/* The eye's path through pixel `point`: through its middle, or where the pass has its sample. */
void pm__run_eye(const pm__progression *progression, uint64_t seed, uint32_t pass, size_t point, bool middle,
                 pm__eye *eye);
/* Follows it to where radiance is wanted. */
void pm__hit_point_follow(pm__eye *eye, pm__hit_point *point);
/* The point where a path has ended. */
void pm__hit_point_of(const pm__eye *eye, bool reached, pm__hit_point *point);
/* BRDF, 1/sr, for light that comes from `in` (unit, away from the surface). */
void pm__hit_point_brdf(const pm__hit_point *point, const double in[3], double value[3]);
/* The query at a point. radius: m. */
void pm__point_query(const pm__progression *progression, const pm__hit_point *point, size_t k, double radius,
                     pm_query *query);

extern const pm__catalogue pm__progressives;

#endif
