/* photonmap.h: the public interface of libphotonmap.
 *
 * Photons in, a balanced map built, the nearest photons found, irradiance estimated.
 *
 *     pm_map_create -> pm_map_search                  neighbours only
 *                   -> pm_estimator_create,
 *                      pm_workspace_create,
 *                      pm_estimate                    irradiance or reflected radiance
 *
 * Units are SI: lengths in m, photon power (flux) in W, irradiance in W/m2 (in a medium: flux density
 * in W/m3). Three colour bands throughout.
 * Errors are returned as pm_status; functions that take a pm_error also leave a sentence there. The
 * library never prints, never exits, keeps no global state and starts no threads.
 * Threads: a pm_map, a pm_estimator and a pm_precomputed may be read by any number of threads at once;
 * a pm_workspace belongs to one thread at a time.
 * NULL for a handle: functions that return a pm_status give EINVAL, pm_*_destroy and pm_free do nothing, and the small
 * readers (pm_map_bytes, _simd, _count, _photon, _source, _unit, _max_power, pm_estimator_name, _maps,
 * pm_precomputed_computed, pm_photon_pack, _unpack, pm_query_init) must not be given it: the behaviour is undefined.
 * Sources cited: [C02] SIGGRAPH 2002 course 43; [J96] Jensen, "Global illumination using photon maps",
 * 1996; [J98] Jensen & Christensen 1998. docs/errata.md says where the code departs from print, and why.
 */
#ifndef PHOTONMAP_H
#define PHOTONMAP_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define PM_API __attribute__((visibility("default")))
#else
#define PM_API
#endif

/* ---- Statuses and errors --------------------------------------------------------------------- */

#define PM_STATUS_LIST(X)                                                   \
    X(OK, 0, "done")                                                        \
    X(EINVAL, 1, "an argument is out of its range")                         \
    X(ENOMEM, 2, "out of memory")                                           \
    X(EIO, 3, "a file cannot be read or written")                           \
    X(EFORMAT, 4, "a file is malformed")                                    \
    X(ENAME, 5, "an unknown name")                                          \
    X(ENONFINITE, 6, "a value is not finite")                               \
    X(EDEGENERATE, 7, "the neighbours span no area, so no density exists")  \
    X(ETRUNCATED, 8, "more photons found than the caller's buffer holds")   \
    X(EBROKEN, 9, "an invariant of the map does not hold")                  \
    X(ECANCELED, 10, "canceled by the caller")

typedef enum pm_status {
#define X(name, code, text) PM_##name = code,
    PM_STATUS_LIST(X)
#undef X
} pm_status;

/* The sentence for a status; never NULL, also for a value that is none. */
PM_API const char *pm_status_text(pm_status status);

/* Filled by a function that fails; untouched where it succeeds. May be passed as NULL. */
typedef struct pm_error {
    char text[320]; /* one sentence, no newline, ends in NUL */
} pm_error;

/* ---- Photons ---------------------------------------------------------------------------------- */

/* The full-precision record. */
typedef struct pm_photon {
    float position[3];  /* m, finite */
    float direction[3]; /* the direction of travel, unit */
    float power[3];     /* W in each colour band, finite; below 0: see pm_map_create */
} pm_photon;

/* The 20-byte record of [C02] 2.1.3: shared-exponent power, two bytes of direction.
 * Power: each band within 0.4 % of the largest one, unbiased over uniformly distributed mantissas
 * (decoded at the middle of the code's cell, errata 24). Direction: 256 x 256 cells decoded at their
 * centre, rms error 0.39 degrees, at most 0.79 (errata 21 to 23). */
typedef struct pm_packed_photon {
    float position[3];
    uint8_t rgbe[4];
    uint8_t theta, phi;
    uint16_t flags; /* free for the owner; pack sets 0 */
} pm_packed_photon;

/* Exact for positions. Powers must be >= 0; a negative or non-finite band is stored as 0, one above the
 * range of RGBE (1.7e38 W) as the largest code, and below 1e-38 W as 0. Cost: about 80 ns and 25 ns. */
PM_API void pm_photon_pack(const pm_photon *photon, pm_packed_photon *packed);
PM_API void pm_photon_unpack(const pm_packed_photon *packed, pm_photon *photon);

/* ---- Parallel work ---------------------------------------------------------------------------- */

/* The caller's parallel-for: runs task(argument, i) for each i in [0, count), in any order and on any
 * threads, and returns when all are done. The library cuts its work the same way whatever runs it, so
 * results do not depend on the threads. */
typedef struct pm_parallel {
    void (*run)(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument);
    void *context;
} pm_parallel;

/* ---- The map ---------------------------------------------------------------------------------- */

typedef struct pm_map pm_map;

typedef enum pm_split {
    PM_SPLIT_EXTENT = 0, /* the axis of the largest distance between photons: [C02] 2.2.2's choice */
    PM_SPLIT_VARIANCE    /* the axis of the largest variance */
} pm_split;

typedef struct pm_search pm_search; /* one search algorithm, see below */

/* Width of the SIMD code. The widths find the same photons, to the last tie. */
typedef enum pm_simd {
    PM_SIMD_AUTO = 0, /* the environment variable PHOTONBENCH_SIMD (v2, avx2, avx512) if set, else the widest */
    PM_SIMD_PLAIN,    /* C without SIMD: what processors other than x86-64 get */
    PM_SIMD_V2,       /* x86-64-v2: SSE4.2 */
    PM_SIMD_AVX2,
    PM_SIMD_AVX512
} pm_simd;

typedef struct pm_map_options {
    pm_split split;              /* of the kd-tree */
    const pm_parallel *parallel; /* NULL: serial */
    const pm_search *search;     /* the search that the map is built for; NULL: the fastest, `wide` */
    pm_simd simd;                /* EINVAL where the processor lacks it */
    bool no_directions;          /* directions are dropped: a smaller map, without sides and BRDFs; see pm_map_create */
} pm_map_options;

#define PM_MAX_PHOTONS ((size_t)0x3fffffff)

/* Builds the structure that the search of the options walks: by default 16-ary boxes over blocks of 16 photons; for the
 * classic searches a left-balanced kd-tree ([C02] 2.2, Fig. 2.7 with errata 18 and 19: split by rank, ties kept).
 * photons: borrowed for the call only. count from 0 to PM_MAX_PHOTONS. options: NULL for the defaults.
 * Errors: ENONFINITE for a position, direction or power that is NaN or infinite (error names its
 * index), EINVAL, ENOMEM. On error *map is NULL. Destroy with pm_map_destroy.
 * Positions are kept relative to a centre and scaled by a power of two, both chosen so that no position
 * is rounded (but for coordinates below 2^-126 of the extent).
 * Negative powers are taken as they are: searches do not look at powers, estimates are sums weighted with them and may
 * be negative then (`differential` decides by the sums where to stop). pm_map_max_power passes over them.
 * Cost: O(N log N). Memory in bytes a photon: 40 for position, index, direction and power, and for the structure 6
 * (wide), 16 (recursive, iterative, stackfree), 20 (unbalanced), up to 4 (grid) or none (brute); while it is built
 * more by 16 (unbalanced) or 20 (grid). The caller's array is not counted.
 * no_directions: for photons of which nobody asks where they came from. 28 bytes instead of 40 (while the map is built
 * 32) and, for wide, 3 instead of 6. Queries with front_only, also those of pm_precomputed_create, and sources with a
 * BRDF are then EINVAL, pm_map_photon gives the direction 0, 0, 0; all else is as with directions, to the last bit. */
PM_API pm_status pm_map_create(const pm_photon *photons, size_t count, const pm_map_options *options,
                               pm_map **map, pm_error *error);
PM_API void pm_map_destroy(pm_map *map); /* NULL is allowed */

/* Makes a map fit for a further search by adding the structure that it walks; nothing where it has it. No other thread
 * may use the map meanwhile. EINVAL for `wide`, which can only be created; ENOMEM. */
PM_API pm_status pm_map_prepare(pm_map *map, const pm_search *search, const pm_parallel *parallel, pm_error *error);

/* Bytes held for searching: a map's structures, the photons' indices, and their positions (once, where a tree has them
 * in its nodes). Directions and powers, 24 bytes a photon (12 where no directions are kept), are not counted. */
PM_API size_t pm_map_bytes(const pm_map *map);

/* The name of the SIMD width that a map uses: "plain", "v2", "avx2", "avx512". */
PM_API const char *pm_map_simd(const pm_map *map);

PM_API size_t pm_map_count(const pm_map *map);

/* Photons are renumbered by the build. `number` < count; source gives the index in the caller's array. */
PM_API pm_photon pm_map_photon(const pm_map *map, uint32_t number);
PM_API uint32_t pm_map_source(const pm_map *map, uint32_t number);

/* Metres in a unit of the map's own lengths (a power of two): see pm_neighbor. */
PM_API double pm_map_unit(const pm_map *map);

/* The largest photon power over all bands, W: the bound of [C02] 5.2.3. 0 where none is positive. */
PM_API double pm_map_max_power(const pm_map *map);

/* Verifies every invariant (index set, heap order, split planes, ids). EBROKEN says which; EINVAL: no map.
 * O(N log N). */
PM_API pm_status pm_map_check(const pm_map *map, pm_error *error);

/* ---- Search ----------------------------------------------------------------------------------- */

/* By name, as `photonbench list searches` shows them; NULL if there is none of that name. */
PM_API const pm_search *pm_search_find(const char *name);

typedef enum pm_lookup_shape {
    PM_LOOKUP_SPHERE = 0, /* Euclidean distance */
    PM_LOOKUP_ELLIPSOID,  /* distance along the normal counts `shape_parameter` (>= 1) times: [C02] 2.3.1 */
    PM_LOOKUP_DISC        /* distance in the tangent plane; |height| <= shape_parameter (m) */
} pm_lookup_shape;

/* Fill with pm_query_init, then set what differs. */
typedef struct pm_query {
    float position[3];      /* m, finite */
    float normal[3];        /* any length > 0; used where shape or front_only need it */
    size_t k;               /* photons wanted; 0: all within max_radius */
    float max_radius;       /* m, >= 0; INFINITY: no limit (then k must be > 0) */
    pm_lookup_shape shape;
    float shape_parameter;
    bool front_only;        /* only photons with direction . normal < 0: [C02] 2.1.3; EINVAL without directions */
    bool sorted;            /* neighbours in ascending order (distance, then the caller's index) */
    const pm_search *search; /* NULL: the one that the map was created for */
} pm_query;

/* k = 50, no limit, sphere, no filter, sorted, the map's search, at the origin, normal +z. */
PM_API void pm_query_init(pm_query *query);

typedef struct pm_neighbor {
    float distance2; /* in map units squared: x pm_map_unit^2 for m2 (kept so that no scale over- or underflows) */
    uint32_t number; /* for pm_map_photon and pm_map_source */
} pm_neighbor;

/* Finds the k nearest photons that the query accepts, exactly; equal distances go to the lower caller's
 * index. Distances are what single precision makes of them in map units: within 5 * 2^-24 of their squares, and
 * equal below 2^-75. Each search algorithm finds the same set; EINVAL where the map was not made for the query's.
 * neighbors: the caller's buffer of `capacity` entries; with k > 0 capacity must be >= min(k, pm_map_count). *count:
 * how many were found. With k = 0 and more in the sphere than fit: ETRUNCATED, *count says how many there are, the
 * buffer's content is undefined.
 * Errors: EINVAL (also NaN in the query). Cost: [C02] 2.3.4, about log N + k steps. */
PM_API pm_status pm_map_search(const pm_map *map, const pm_query *query, pm_neighbor *neighbors,
                               size_t capacity, size_t *count);

/* Many queries at once, [i * stride] on neighbours of query i: faster than one by one where the search has a form for
 * it (wide, grid: sixteen at a time). As pm_map_search otherwise; with k = 0 a query that finds more than stride is
 * ETRUNCATED, counts[] says how many. The first status that is not OK is returned; counts of queries from it on are
 * 0. */
PM_API pm_status pm_map_search_batch(const pm_map *map, const pm_query *queries, size_t query_count,
                                     pm_neighbor *neighbors, size_t stride, size_t *counts);

/* All photons within max_radius, any number of them, handed over in blocks of up to 1024 in no particular order; k is
 * not looked at. deliver returns false to stop, which is no error; its array is valid for the call only. EINVAL as for
 * pm_map_search. */
typedef bool (*pm_deliver)(void *context, const pm_neighbor *neighbors, size_t count);
PM_API pm_status pm_map_search_each(const pm_map *map, const pm_query *query, pm_deliver deliver, void *context);

/* Automatic maximum radius, m: beyond it n photons cannot reach the radiance `threshold`
 * (W/(m2 sr) per band). max_power: of any photon, W. Surfaces: [C02] 5.2.3; volumes: 5.2.4, sigma: the
 * scattering coefficient, 1/m. 0 where an argument is not positive and finite; what is beyond doubles is the largest;
 * relative error below 2^-50. */
PM_API double pm_max_radius_surface(size_t n, double max_power, double threshold);
PM_API double pm_max_radius_volume(size_t n, double max_power, double sigma, double threshold);

/* ---- Estimates -------------------------------------------------------------------------------- */

typedef struct pm_estimator pm_estimator;     /* an estimator with its parameters */
typedef struct pm_workspace pm_workspace;     /* buffers for one thread */
typedef struct pm_precomputed pm_precomputed; /* estimates stored at photons: [C02] 5.4 */

/* spec: NAME[:key=value[,key=value...]], as `photonbench list estimators` shows them; borrowed for the call. ENAME,
 * EINVAL, ENOMEM. On error *estimator is NULL. */
PM_API pm_status pm_estimator_create(const char *spec, pm_estimator **estimator, pm_error *error);
PM_API void pm_estimator_destroy(pm_estimator *estimator); /* NULL is allowed */

/* The canonical form with every parameter spelt; lives as long as the estimator. */
PM_API const char *pm_estimator_name(const pm_estimator *estimator);

/* How many maps it looks up in (1 but for `combined`). */
PM_API size_t pm_estimator_maps(const pm_estimator *estimator);

/* Grows as needed; max_k, photons of a lookup, only avoids the growth: 36 bytes each. EINVAL, ENOMEM; then
 * *workspace is NULL. */
PM_API pm_status pm_workspace_create(size_t max_k, pm_workspace **workspace);
PM_API void pm_workspace_destroy(pm_workspace *workspace); /* NULL is allowed */

/* BRDF value, 1/sr in each band, for light travelling along `incoming` and leaving along `outgoing`. */
typedef void (*pm_brdf)(void *context, const float incoming[3], const float outgoing[3], float value[3]);

/* What an estimate draws from. */
typedef struct pm_source {
    const pm_map *const *maps;         /* pm_estimator_maps of them */
    size_t map_count;
    const pm_precomputed *precomputed; /* for the estimator `precomputed` only, else NULL */
    int dimensions;                    /* 2: photons on surfaces; 3: in a medium */
    pm_brdf brdf;                      /* NULL: the result is irradiance; else reflected radiance, [C02] 2.6 */
    void *brdf_context;
    float outgoing[3];                 /* for the BRDF, unit, away from the surface */
} pm_source;

typedef struct pm_estimation {
    double value[3]; /* W/m2 (or W/m3; with a BRDF W/(m2 sr)) in each band; 0 where the status is not OK */
    double radius;   /* of the region that was looked up, m */
    size_t count;    /* photons found, min(k, N) or fewer */
} pm_estimation;

/* One estimate. An empty neighbourhood is 0 with PM_OK. Where max_radius comes before the k-th photon
 * the region is the whole max_radius and every photon counts in full. EDEGENERATE: the photons span no
 * area (all at distance 0; a hull of no more than 2^-23 of its width squared), or single precision cannot tell
 * how far they are: a region below 2^-60, a query beyond 1e18 of pm_map_unit. ENONFINITE: the BRDF gave NaN or
 * infinity. EINVAL: maps, dimensions or k that the estimator cannot use (`combined` wants k >= 3 a map). Sums
 * run in double: relative error of a sum of n equal powers below (n + 16) * 2^-53, beside r squared, which in
 * single precision errs by 5 * 2^-24 at most and not at all where its squares fit 24 bits; src/stress/stress.h
 * has the bound of each estimator. Cost: the search, then O(k). */
PM_API pm_status pm_estimate(const pm_estimator *estimator, const pm_source *source, const pm_query *query,
                             pm_workspace *workspace, pm_estimation *estimation);

typedef struct pm_precomputed_options {
    pm_query lookup;            /* how the estimate at a photon is looked up: k, max_radius, shape, filter, search */
    const float (*normals)[3];  /* the surface normal at each photon in the caller's order; NULL: then
                                   estimates at photons use no shape and no filter. Copied. */
    const pm_parallel *parallel; /* for the eager form; NULL: serial */
    int dimensions;             /* 2 or 3 */
} pm_precomputed_options;

/* Estimates for the photons that carry one: a `fraction` of them, spread evenly ([C02] 5.4.1), computed now
 * (`when=eager`) or when first asked for (`when=demand`, safe from several threads, every thread gets the
 * same value). estimator: of type `precomputed`; it is copied. The map must outlive the result. EINVAL, ENOMEM; then
 * *precomputed is NULL. Cost: a map of those photons, and with `when=eager` an estimate at each. */
PM_API pm_status pm_precomputed_create(const pm_estimator *estimator, const pm_map *map,
                                       const pm_precomputed_options *options,
                                       pm_precomputed **precomputed, pm_error *error);
PM_API void pm_precomputed_destroy(pm_precomputed *precomputed); /* NULL is allowed */

/* How many estimates have been computed so far. */
PM_API size_t pm_precomputed_computed(const pm_precomputed *precomputed);

/* ---- Photon and query files ------------------------------------------------------------------- */

/* PLY, ascii or binary little-endian, element `vertex`; extra elements and properties are skipped.
 * Photons: x y z, dx dy dz (made unit), r g b or power_r power_g power_b; optional nx ny nz (the surface
 * normal at the photon). Hostile files are refused: EIO, EFORMAT, ENONFINITE or ENOMEM, the error names
 * the file, the line or byte, and what was expected. Outputs are allocated and belong to the caller: free
 * with pm_free. *normals is NULL where the file has none; pass NULL where they are not wanted. */
PM_API pm_status pm_ply_read_photons(const char *path, pm_photon **photons, float (**normals)[3],
                                     size_t *count, pm_error *error);

typedef struct pm_surface_point {
    float position[3]; /* m */
    float normal[3];   /* unit */
} pm_surface_point;

/* Queries: x y z, nx ny nz (made unit). As above. */
PM_API pm_status pm_ply_read_points(const char *path, pm_surface_point **points, size_t *count, pm_error *error);

/* Binary little-endian; a temporary name and a rename, so that the file is complete or absent. Directions are to be of
 * unit length, else pm_ply_read_photons refuses the file. EINVAL, EIO, ENOMEM, ENONFINITE. */
PM_API pm_status pm_ply_write_photons(const char *path, const pm_photon *photons, size_t count, pm_error *error);

PM_API void pm_free(void *memory); /* NULL is allowed */

#ifdef __cplusplus
}
#endif
#endif
