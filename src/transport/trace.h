/* Photon tracing ([C02] 2.1): photons leave the lights, are scattered or end by Russian roulette, and are stored at
 * rough surfaces. A photon's path depends on (seed, trial, number) alone, so it is the same for any number of threads,
 * and in a changed scene but for what the change touches ([C02] 5.1). */
#ifndef PM_TRANSPORT_TRACE_H
#define PM_TRANSPORT_TRACE_H

#include "../scene/scene.h"

enum { PM__LONGEST_PATH = 1000 };

/* Photon numbers lie below; those from here on are of trial runs, and as many again above serve other ends. */
#define PM__MOST_TRACED ((uint64_t)1 << 39)

/* Which stored photons are wanted, by their light path: Heckbert's grammar with L (light), S (mirror or glass) and D
 * (rough) as a POSIX extended regular expression that must match the whole path up to the surface where the photon is
 * stored: "LD" direct, "LS+D" caustics, "L.*D" all. "LSSD" is two specular events. Of the syntax: L S D . [..] [^..]
 * ( ) | * + ? {n} {n,} {n,m}; at most 63 letters with counted repeats written out. */
typedef struct pm__paths pm__paths;

/* EINVAL for what is no such expression (error names the character), or matches no path of a photon. ENOMEM. */
pm_status pm__paths_create(const char *expression, pm__paths **paths, pm_error *error);
void pm__paths_destroy(pm__paths *paths);
bool pm__paths_match(const pm__paths *paths, const char *path);
/* Can no path that goes on from this one match? Then a photon need not be traced further. Exact. */
bool pm__paths_end(const pm__paths *paths, const char *path);

/* A stored photon. power: W, by band, as if the number of photons emitted were 1: to be divided by it. normal: of the
 * surface, on the side that the photon came from. */
typedef struct pm__stored {
    double position[3], direction[3], normal[3], power[3];
} pm__stored;

/* Called for each stored photon of photon `number`, in the order of its path; false stops tracing. */
typedef bool (*pm__store)(void *context, uint64_t number, const pm__stored *photon);

typedef struct pm__trace_config {
    const pm__scene *scene;
    const pm__paths *paths; /* NULL: all */
    uint64_t seed;
    uint32_t trial;
    const struct pm__emission *emission; /* what leaves the lights; NULL: independent photons, everywhere */
} pm__trace_config;

/* Traces photons first .. first + count - 1 in order, on this thread. Returns how many were emitted: fewer where store
 * said stop, the photon that it stopped at counted. Numbers below PM__MOST_TRACED. The light of a photon is chosen by
 * power; each photon carries the total power by band of its light over the chance of that light. */
uint64_t pm__trace(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store, void *context);

/* The same, and `watch` is called (with the same context) for each ray before it is answered, in the order of tracing.
 * from: as pm__scene_intersect has it. */
typedef void (*pm__watch)(void *context, const double origin[3], const double direction[3], uint32_t from);
uint64_t pm__trace_watched(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store,
                           pm__watch watch, void *context);

#endif
