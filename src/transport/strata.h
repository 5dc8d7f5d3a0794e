/* Emission by strata: cells of the numbers that a light's photons are emitted by (of those that go where photons are
 * aimed), all of a light with the same power. Which stratum a photon is of follows from its number.
 *
 * Trial photons, numbers from PM__MOST_TRACED on: so many of each stratum in turn. Others, where it is known how many
 * are sent: dealt out in whole numbers, a stratum's one after another, which meet the same surfaces, and each carries
 * its part of what the stratum sends, exactly; runs of them come in an order that mixes strata. Where it is not known:
 * a stratum has the part of [0, 1) that is its share, and a van der Corput sequence, shifted by chance, says whose turn
 * it is: so the first n photons have about n times the share of each stratum for any n, on average exactly, and sending
 * may end anywhere. */
#ifndef PM_TRANSPORT_STRATA_H
#define PM_TRANSPORT_STRATA_H

#include "emission.h"

typedef struct pm__stratum {
    size_t light;
    double low[4], width[4]; /* of the numbers u */
    double power;            /* W, all bands */
    double factor;           /* of the light's power: what a photon carries, as if the number emitted were 1 */
    double trial_factor;     /* of one that is a trial photon: its share of what the stratum sends */
    double load;             /* the policy's: power over that of a photon that is sent evenly */
    uint64_t first;          /* of its photons, where they are dealt out */
} pm__stratum;

typedef struct pm__strata {
    pm__stratum *items;
    double *ends; /* of the strata's shares, the last 1 */
    size_t count;
    size_t fine;  /* the first so many are of lights that are cut */
    size_t tests; /* trial photons of each */
    double shift;
    uint64_t sent, runs, stride; /* photons dealt out, 0: none are; whole runs of them, and from one to the next */
} pm__strata;

/* Up to `per_light` strata for each light that sends, a power of two of them, from 1 to 65536; tests: from 1. cut:
 * [lights], those that have so many, others have one; NULL: all. No shares yet. ENOMEM. */
pm_status pm__strata_create(const pm__emission *emission, size_t per_light, const bool *cut, size_t tests,
                            pm__strata *strata);
void pm__strata_free(pm__strata *strata);

/* Deals out about as many photons as shares[count], each >= 0, add up to, numbers from 0 on: to each stratum the whole
 * number below its share or the one above, its share on average. Says how many. Those of strata with a share of 1 or
 * more carry all of their power together, of others their power on average. */
uint64_t pm__strata_deal(const pm__emission *emission, pm__strata *strata, const double *shares);

/* shares[count], each >= 0, not all 0: strata send in proportion. */
void pm__strata_share(const pm__emission *emission, pm__strata *strata, const double *shares);

/* The stratum of a photon, by number. */
size_t pm__strata_find(const pm__strata *strata, uint64_t number);

/* Moves u[0..3], uniform over the unit cube, into the photon's stratum. Returns the light. */
size_t pm__strata_place(const pm__strata *strata, uint64_t number, double u[4], double *factor);

#endif
