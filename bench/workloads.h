/* Point sets that searches are timed on, and the queries that go with them.
 *
 * A photon depends on (seed, number) alone, so sets are the same whatever draws them, and a smaller set is the
 * beginning of a larger one. Lengths in m. */
#ifndef PM_BENCH_WORKLOADS_H
#define PM_BENCH_WORKLOADS_H

#include "../src/base/param.h"
#include "../src/base/random.h"

enum { PM__WORKLOAD_NUMBERS = 12 };

typedef struct pm__workload_point {
    double position[3];
    double direction[3]; /* of travel, unit */
    double normal[3];    /* of the surface, unit; where there is none, +z */
} pm__workload_point;

typedef struct pm__workload {
    pm__entry entry;
    double query_jitter; /* m: queries are moved on the surface by up to this much along each tangent; 0: they are
                          * independent draws and need not be */
    /* One photon from PM__WORKLOAD_NUMBERS uniform numbers. */
    void (*draw)(const double *u, pm__workload_point *point);
} pm__workload;

extern const pm__catalogue pm__workloads;

/* count photons of equal power, 1 W in all. photons: the caller's, count of them. */
void pm__workload_photons(const pm__workload *workload, uint64_t seed, size_t count, const pm_parallel *parallel,
                          pm_photon *photons);

/* count queries from the same distribution, independent of the photons. */
void pm__workload_queries(const pm__workload *workload, uint64_t seed, size_t count, const pm_parallel *parallel,
                          pm_surface_point *queries);

/* The same for a set that is only known by its photons: each query is near one of them, on its surface. normals: NULL
 * where unknown; a photon's surface is then taken to face it. At the origin where there are no photons. */
void pm__photon_queries(const pm_photon *photons, const float (*normals)[3], size_t photon_count, uint64_t seed,
                        size_t count, pm_surface_point *queries);

/* Sorts into Morton order of the points' bounding cube: neighbours in the list are neighbours in space. ENOMEM. */
pm_status pm__morton_order(pm_surface_point *queries, size_t count);

/* For draw: a direction with density cos/pi about the unit vector `normal`, from two uniform numbers. */
void pm__cosine_direction(const double normal[3], const double u[2], double direction[3]);

#endif
