/* A series under way. For series.c, saved.c and own.c alone. */
#ifndef PM_CONVERGE_MEASURING_H
#define PM_CONVERGE_MEASURING_H

#include "measure.h"

typedef struct pm__measuring {
    const pm__converge_config *config;
    pm__progressive_config progressive; /* config's, with what else is asked for */
    pm__progression progression;
    pm__expectation expectation;
    pm__yardstick yardstick;
    uint32_t passes[PM__MOST_RECORDS];
    size_t records, room;  /* room: records that were planned */
    float *errors;         /* [(trial * room + record) * 3 values] */
    double *estimated, *right; /* [trial * room + record]: what runs say of their own error; NULL: they do not */
    double (*radiance)[3]; /* [points] */
    pm__converge_series *series; /* trials: done; rows: what the first run says of itself */
    pm__run run;           /* of the trial in hand; of NULL: none */
    size_t record;         /* the next one of that trial */
    double start;          /* s: when it began, less what had gone by before a checkpoint */
    double saved;          /* s: when it was saved last */
} pm__measuring;

/* All that the rest depends on, as bytes. ENOMEM. Free bytes by free(). */
pm_status pm__measuring_save(const pm__measuring *m, pm__saved *saved, pm_error *error);
/* Into a series that has been set up, and has no run in hand. EFORMAT, ENOMEM. */
pm_status pm__measuring_restore(pm__measuring *m, const pm__saved *saved, pm_error *error);

/* own.c: what runs say of their own error. What the run in hand does, over the points that are measured; that and the
 * share of points within their bounds into the record in hand (e: as yardsticks measure); both into rows. The latter
 * two do nothing where nothing is estimated but for rows' NAN. */
double pm__measuring_own_error(const pm__measuring *m);
void pm__measuring_own_record(pm__measuring *m, const float *e);
void pm__measuring_own_average(const pm__measuring *m);

#endif
