/* The judge: neighbours and estimates in long double, straight from the definitions, without a line of the library's
 * own evaluation. Slow: every photon is measured, every stage summed anew. */
#ifndef PM_STRESS_JUDGE_H
#define PM_STRESS_JUDGE_H

#include "../base/param.h"

/* What is asked. Photons of map m of `maps` are those whose index leaves m when divided by it. */
typedef struct pm__judge_request {
    const pm_photon *photons;
    size_t count;
    const pm_query *query; /* k, max_radius, shape, filter */
    const pm__spec *spec;
    int dimensions;
    size_t oracle_k; /* of `oracle` */
    bool rounds;     /* squared distances are in single precision, so what is close may be either way */
} pm__judge_request;

typedef struct pm__judged {
    pm_status status;
    long double value[3];     /* W/m2 or W/m3 */
    long double magnitude[3]; /* the same with every term positive */
    long double radius;       /* m */
    size_t count;
    size_t maps;
    bool clear;    /* nothing was decided by a difference that rounding may turn round */
} pm__judged;

/* status ENOMEM: nothing was judged. */
void pm__judge(const pm__judge_request *request, pm__judged *judged);

/* The bound of an estimate's error, in ulps (float ulps where distances round): see stress.h. */
double pm__judge_bound(const pm__judge_request *request, const pm__judged *judged);

/* ---- Parts ------------------------------------------------------------------------------------- */

typedef struct pm__near {
    long double d2; /* m2, as the lookup's shape measures */
    uint32_t index;
} pm__near;

/* Neighbours of a query among the photons index % maps == map with k photons of them wanted, by (d2, index). near: room
 * for all. gap: the least relative difference between successive d2 up to the first that is not wanted. */
typedef struct pm__nears {
    pm__near *near;
    size_t count;
    bool cut;
    long double r2, gap;
} pm__nears;

void pm__judge_find(const pm_photon *photons, size_t count, const pm_query *query, size_t k, size_t map, size_t maps,
                    pm__nears *nears);

/* The share of k that falls to one of several maps. */
size_t pm__judge_share(size_t k, size_t maps, size_t map);

/* The hull of a set; judged as above. */
void pm__judge_hull(const pm__judge_request *request, const pm__nears *set, pm__judged *judged);

#endif
