/* A peer: somebody else's search library behind one adapter in bench/peers, there to be timed beside our own.
 *
 * Adapters are C++ and compiled in where the library's headers are; a list without rows is fine. An adapter may throw
 * nothing: what fails is NULL or PM__PEER_FAILED. */
#ifndef PM_BENCH_PEER_H
#define PM_BENCH_PEER_H

#ifdef __cplusplus
#include <cstddef>
#include <cstdint>
extern "C" {
#else
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#endif

#define PM__PEER_FAILED ((size_t)-1)

typedef struct pm__peer {
    const char *name;
    const char *summary; /* library, version, settings */
    bool threaded;       /* build uses `threads`; else it always takes one */

    /* points: count >= 1 of them, finite; the caller's, alive until destroy. NULL: refused (memory). */
    void *(*build)(const float (*points)[3], size_t count, size_t threads);
    void (*destroy)(void *index);

    /* The nearest min(k, count) points, in any order; squared distances. ids, distances2: room for k. Returns how many.
     * One thread at a time: the index holds the scratch memory. */
    size_t (*nearest)(void *index, const float point[3], size_t k, uint32_t *ids, float *distances2);

    /* All points with distance <= radius, in any order; ids: room for capacity. Returns how many there are; where that
     * is more than capacity, ids' content is undefined. NULL: the library cannot. */
    size_t (*within)(void *index, const float point[3], float radius, size_t capacity, uint32_t *ids);

    /* Bytes of the index, and of the points where queries read them. */
    size_t (*bytes)(const void *index);
} pm__peer;

/* Those that are built in; ends in NULL. */
extern const pm__peer *const pm__peers[];

/* NULL if there is none of that name. */
const pm__peer *pm__peer_find(const char *name);

#ifdef __cplusplus
}
#endif
#endif
