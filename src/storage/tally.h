/* Errors of images over trials, told without the noise of what all trials share.
 *
 * An image comes as the relative errors e of PM__GROUPS groups of independent eye paths (viewing.h) against a reference
 * whose own relative variance is known. With <a, b> the mean over values (pixels and bands) of the products a_g b_h,
 * averaged over pairs of groups g != h, over trials t, u of T, and v the reference's mean variance:
 *
 *     square = mean of <e_t, e_t> - v                      has the mean of the squared error of images of infinitely
 *                                                          many eye paths
 *     cross  = mean of <e_t, e_u> over t != u, less v      that of the squared bias: trials are independent
 *     noise squared = square - cross                       that of the variance over trials, T - 1 in the divisor
 *
 * and all three are unbiased, whatever T, since no product is of a random number with itself. They may come out below 0
 * by chance; their roots are then 0. The bias is the mean of e, of which the reference's noise is a part.
 *
 * Most noise of `square` is that of the image with large maps, which all rows share. What the map in question adds,
 *     added = square - square of the image with large maps,
 * is without it; and equal errors are equal in it. */
#ifndef PM_STORAGE_TALLY_H
#define PM_STORAGE_TALLY_H

#include "../stats/stats.h"
#include "viewing.h"

enum { PM__GROUP_PAIRS = PM__GROUPS * (PM__GROUPS - 1) / 2 };

typedef struct pm__tally {
    size_t values, room, trials;    /* of a group; trials that it has room for; done */
    double own_square;              /* v */
    double base_square;             /* of the image with large maps */
    double *square, *added;         /* [trial]: <e_t, e_t> - v; and less base_square */
    double *mean;                   /* [trial]: of e */
    double pairs[PM__GROUP_PAIRS];        /* sums over trials of the products of two groups, less v */
    double group_mean[PM__GROUPS];  /* sums over trials */
    float *sum;                     /* [group * values + value], over trials */
} pm__tally;

/* room: trials at most; base: errors of the image with large maps. ENOMEM. */
pm_status pm__tally_create(size_t values, size_t room, double own_square, const float *base, pm__tally *tally);
void pm__tally_free(pm__tally *tally); /* one that is all 0 is allowed */
void pm__tally_add(pm__tally *tally, const float *errors);

/* NAN: does not exist (of no trials; what needs two). Intervals are 95 %: over trials, and for what all trials share
 * over groups, by jackknife of each. bias: that of the reference's mean is not in it. */
typedef struct pm__view_error {
    double bias, rms_bias, noise, rmse, added;
    pm__interval bias_ci95, rmse_ci95, added_ci95; /* added: over trials alone */
} pm__view_error;
pm__view_error pm__tally_error(const pm__tally *tally);

/* The jackknife's 95 % half width for the logarithm of a ratio that is `whole` of all, without[i] of all but trial i;
 * NAN where one of them is not finite. Student's quantile. */
double pm__jackknife_half(const double *without, size_t trials);

#endif
