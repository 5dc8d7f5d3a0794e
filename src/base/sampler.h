/* Samplers: how the numbers that photons are made of are spread over the unit cube. */
#ifndef PM_BASE_SAMPLER_H
#define PM_BASE_SAMPLER_H

#include "param.h"
#include "random.h"

enum { PM__MAX_DIMENSIONS = 4 };

/* A set of points in [0,1)^d: what a sampler needs to give the i-th of them. */
typedef struct pm__points {
    const struct pm__sampler *sampler;
    uint64_t seed;
    pm__purpose purpose;
    uint32_t trial;
    int dimensions;       /* 1 to PM__MAX_DIMENSIONS; further ones are independent uniform */
    int strata_dimensions; /* the first so many are stratified */
    uint64_t count;       /* points in the set, after plan */
    uint32_t cells[3];    /* stratified: the grid */
} pm__points;

typedef struct pm__sampler {
    pm__entry entry;
    bool independent; /* the points are independent: the laws for Poisson photons hold */
    /* Fixes how many points there are: `stratified` rounds points->count to a full grid whose cells have the
     * aspect ratio closest to `aspect` (extent along u[0] / along u[1] of the warped domain). */
    void (*plan)(pm__points *points, const double aspect[2]);
    /* Point `index` of the set, dimensions numbers in [0,1). Pure: depends on points and index only. */
    void (*point)(const pm__points *points, uint64_t index, double *u);
} pm__sampler;

extern const pm__catalogue pm__samplers;

/* Sets up a set of about `count` points. aspect: see plan; aspect[1] is that of u[0] against u[2]. */
void pm__points_init(pm__points *points, const pm__sampler *sampler, uint64_t seed, pm__purpose purpose,
                     uint32_t trial, uint64_t count, int dimensions, int strata_dimensions, const double aspect[2]);

#endif
