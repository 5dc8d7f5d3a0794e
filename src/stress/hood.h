/* A set of photons with a query: what every row asks about. */
#ifndef PM_STRESS_HOOD_H
#define PM_STRESS_HOOD_H

#include "../photonmap.h"

enum { PM__HOOD_MOST = 4200, PM__HOOD_STEPS = 1024 };

/* Coordinates in whole steps of `step` m, at most PM__HOOD_STEPS either way, keep squared distances exact in single
 * precision (stress.h). */
typedef struct pm__hood {
    pm_photon *photons; /* room for PM__HOOD_MOST */
    size_t count;
    pm_query query; /* k of lookups by number; max_radius (finite) of those by radius */
    bool rounds;    /* not on such a lattice */
    bool coarse;    /* lengths differ by more than single precision may hold: EDEGENERATE is an answer too */
    /* The twin: all lengths times 2^length and powers times 2^power; results are to be the same but for that, to the
     * last bit. 0 and 0: there is none. */
    int twin_length, twin_power;
    char what[80]; /* in words, for the detail of a row */
} pm__hood;

/* Random numbers that depend on the seed, the test and the number of the set alone. */
typedef struct pm__dice {
    uint64_t seed, number;
    uint32_t test;
} pm__dice;

double pm__roll(pm__dice *dice);               /* in [0, 1) */
int pm__roll_between(pm__dice *dice, int low, int high); /* inclusive */

/* Empties the hood: k = 20, radius 300 steps, the query in the middle, normal along +z. */
void pm__hood_clear(pm__hood *hood);

/* A photon so many steps (of 2^-10 m) from the origin, with random power in [0.5, 2) W and a random direction. */
void pm__hood_add(pm__hood *hood, pm__dice *dice, int x, int y, int z);

/* count of them at random within `reach` steps along each axis, in the plane z = 0 unless `deep`. */
void pm__hood_scatter(pm__hood *hood, pm__dice *dice, size_t count, int reach, bool deep);

/* All lengths (positions, radius, half height of a disc) times a factor, in single precision. */
void pm__hood_stretch(pm__hood *hood, float factor);

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
void pm__hood_say(pm__hood *hood, const char *format, ...);

#endif
