/* Is what a contender finds right? Judged against brute force, twice over:
 *  - our own searches give the photons that our brute-force search gives, to the last tie;
 *  - all give the distances that a plain loop in double gives, which shares no code with any search, to 4 float ulp.
 * The second needs plain queries (sphere, no filter). */
#ifndef PM_BENCH_EXACTNESS_H
#define PM_BENCH_EXACTNESS_H

#include "contender.h"

enum { PM__CHECKED_QUERIES = 64 };

typedef struct pm__reference {
    const pm_photon *photons;
    size_t photon_count;
    pm_query queries[PM__CHECKED_QUERIES];
    size_t stride;        /* room for the results of a query */
    uint32_t *ids;        /* [query * stride]: brute force's, ascending */
    size_t counts[PM__CHECKED_QUERIES];
    double *distances; /* [query * stride], m, ascending, of the plain loop; for a radius also those just beyond it */
    size_t distance_counts[PM__CHECKED_QUERIES];
} pm__reference;

/* map: holds the photons, whatever it was made for. queries: the sample is spread evenly over them. stride: at least
 * what any of them finds. ENOMEM and what a search may say. Destroy always. Cost: 2 * 64 passes over the photons. */
pm_status pm__reference_create(const pm_map *map, const pm_photon *photons, size_t photon_count,
                               const pm_query *queries, size_t query_count, size_t stride, const pm_parallel *parallel,
                               pm__reference *reference);
void pm__reference_destroy(pm__reference *reference);

/* Mean number of photons found. */
double pm__reference_mean_count(const pm__reference *reference);

/* Asks and compares. *exact; detail: what differs first, "" where nothing does. */
pm_status pm__exactness_check(const pm__reference *reference, const pm__bench_index *index, size_t batch, bool *exact,
                              char detail[160]);

#endif
