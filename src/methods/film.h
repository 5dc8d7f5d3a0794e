/* What an image is while it is made: sums over samples by pixel, then moments over trials. */
#ifndef PM_METHODS_FILM_H
#define PM_METHODS_FILM_H

#include "method.h"

typedef struct pm__film {
    size_t width, height, images, pixels;
    size_t tiles, tiles_across;
    double (*sum)[3];         /* [image * pixels + pixel], of the trial in hand */
    double *radius, *count;   /* likewise: of the estimates; count 0 where none was made */
    double (*truth)[3];       /* [pixel]; NULL unless the truth of samples is known */
    uint32_t *taken;          /* [tile]: samples of each of its pixels */
    double (*first)[3];       /* [image * pixels + pixel]: the first trial's means */
    double (*mean)[3], (*m2)[3]; /* over trials: mean, sum of squared deviations */
    double (*square)[3];      /* of the first trial, of methods without maps: sums of squares; then of their means the
                                 variance. NULL: not wanted */
    bool estimates;           /* radius and count say something */
    size_t trials;
} pm__film;

/* What a film and the images made of it hold at the least (a truth may be known or not): bytes for each pixel and
 * image. maps: the method has some. */
double pm__film_bytes(const pm__render_config *config, bool maps);

/* ENOMEM; then all is released. maps: as above. */
pm_status pm__film_create(const pm__render_job *job, bool maps, pm__film *film, pm_error *error);
void pm__film_destroy(pm__film *film);

pm__tile pm__film_tile(const pm__film *film, size_t index, uint32_t pass, uint32_t trial);
/* Adds a sample of each pixel of a tile. samples as of pm__method.sample; truth: NULL unless the film has one. */
void pm__film_add(pm__film *film, size_t index, const pm__sample *samples, const double (*truth)[3]);

/* The trial in hand is done: into the moments, and the sums begin anew (truth, radius and count stay the first's). */
void pm__film_end_trial(pm__film *film);

/* Can images of this size be judged by the reference: are they a whole multiple of it, across as down? EINVAL. */
pm_status pm__reference_fits(const pm__image *reference, size_t width, size_t height, pm_error *error);

/* The images of the film; reference: NULL, or what takes the truth's place where the film has none. Sizes of the two
 * must divide; images of comparison then have the smaller. ENOMEM, EINVAL. */
pm_status pm__film_develop(const pm__film *film, const pm__image *reference, bool aov, pm__render_result *result,
                           pm_error *error);

#endif
