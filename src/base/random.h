/* Counter-based random numbers: a draw depends on its key and number alone (Salmon et al. 2011, Philox4x32-10
 * of Random123), so a photon's path depends on nothing but its number ([C02] 5.1; errata 39). */
#ifndef PM_BASE_RANDOM_H
#define PM_BASE_RANDOM_H

#include <stdint.h>

/* What a draw is for: streams with different purposes never share numbers. */
typedef enum pm__purpose {
    PM__FOR_PHOTONS = 1,
    PM__FOR_PROBES,
    PM__FOR_DEALING,
    PM__FOR_SCRAMBLING,
    PM__FOR_TESTS,
    PM__FOR_TIMING,
    PM__FOR_TRACING,
    PM__FOR_PIXELS, /* where in a pixel its samples lie */
    PM__FOR_EYES,   /* paths from the camera */
    PM__FOR_TRIALS, /* a trial's own seed */
    PM__FOR_IMPORTONS,
    PM__FOR_STORING /* which photons a policy keeps */
} pm__purpose;

/* Four 32-bit words for draw `number` (and block `block` of its dimensions) of trial `trial`. */
void pm__random_words(uint64_t seed, pm__purpose purpose, uint32_t trial, uint64_t number, uint32_t block,
                      uint32_t words[4]);

/* `count` uniform numbers in [0, 1), 53 bits each. */
void pm__random_uniform(uint64_t seed, pm__purpose purpose, uint32_t trial, uint64_t number, double *u, int count);

/* Three uniform numbers in [0, 1) of 42 bits from one block: for a path that takes a block a step, so that what it
 * meets does not depend on how many numbers were taken before. */
void pm__random_triple(uint64_t seed, pm__purpose purpose, uint32_t trial, uint64_t number, uint32_t block,
                       double u[3]);

#endif
