/* A measurement under way. For the sources of this folder alone. */
#ifndef PM_STORAGE_JOB_H
#define PM_STORAGE_JOB_H

#include "../methods/stage.h"
#include "storage.h"

#include <string.h>

/* One row in the making. */
typedef struct pm__storage_item {
    pm__storage_row row;
    bool hidden;    /* only for the flux that is expected */
    bool largest;   /* of its policy and map: that is what images are of */
    pm__tally tally;
    double *stored, *trace_s, *policy_s, *build_s, *total_s; /* [trial] */
    double *flux[PM__PARTS], *came[PM__PARTS];
    double emitted; /* sum over trials */
} pm__storage_item;

typedef struct pm__storage_job {
    const pm__storage_wish *wish;
    pm__storage_result *result;
    pm__stage stage;
    pm__reference reference;
    pm__importance *importance;
    pm__viewing *viewing;
    double importance_s;
    double own_square;        /* of the reference's relative error: its mean over values */
    double radius;            /* m: of lookups, at most */
    pm__storage_item *items;  /* by map, policy, size; hidden ones last */
    size_t item_count;
    pm__spec all;             /* the policy, where none of the rows is its */
    pm__spec density;         /* that images show, where no policy requires any */
    size_t expecting[PM__MAP_KINDS]; /* the item whose photons say what flux is to be expected; SIZE_MAX: none */
    float *errors;            /* of the trial in hand */
    double work, done;        /* for progress: about photons and lookups */
} pm__storage_job;

/* context: the job. */
static inline bool pm__storage_canceled(void *context)
{
    const pm__storage_job *const job = context;
    return job->wish->canceled && job->wish->canceled(job->wish->context);
}

static inline bool pm__storage_is_all(const pm__storage_row *row)
{
    return strcmp(row->policy->entry->name, "all") == 0;
}

/* Photons sent, at most, for each that is to be stored. */
enum { PM__MOST_SENT = 64 };

/* About what a trial of an item takes, photons and lookups: for progress alone. prepare.c */
double pm__storage_work(const pm__storage_job *job, const pm__storage_item *item);
/* How much of it the view takes, over that of all trials. */
static const double pm__view_work = 0.7;

/* All but the trials; as pm__storage_measure. prepare.c */
pm_status pm__storage_prepare(pm__storage_job *job, pm_error *error);

/* The largest power within any k-neighbourhood of photons in important places over its median: at every 16th of the
 * photons. NAN where there is none. ENOMEM. spread.c */
pm_status pm__power_spread(const pm__storage_job *job, pm__map_kind kind, const pm__stored_photons *set,
                           const pm_map *map, double *spread);

/* rows.c: items to rows and fronts, of the trials that are done. ENOMEM. */
pm_status pm__storage_summarize(pm__storage_job *job, pm_error *error);

/* images.c: those of an item's map, and of its kind of map what is required if that is not there yet. ENOMEM. */
pm_status pm__storage_draw(pm__storage_job *job, const pm__storage_item *item, const pm_map *map, pm_error *error);

#endif
