/* Rays asked of a scene together, in every width that the processor has: to the last bit what they are one by one. */
#ifndef PM_TESTS_BATCHES_H
#define PM_TESTS_BATCHES_H

#include "../src/scene/batch.h"
#include "test.h"

#include <stdint.h>
#include <string.h>

typedef struct asked {
    double origin[3], direction[3];
    uint32_t from;
} asked;

static inline void check_batch(const pm__scene *scene, const pm__batch_kernel *kernel, const asked *rays, size_t count,
                               const char *what)
{
    static pm__batch b;
    memset(&b, 0, sizeof b); /* behind the last ray, what is none: no direction */
    b.count = count;
    for (size_t i = 0; i < count; i++) {
        b.from[i] = rays[i].from;
        for (int axis = 0; axis < 3; axis++) {
            b.origin[axis][i] = rays[i].origin[axis];
            b.direction[axis][i] = rays[i].direction[axis];
        }
    }
    pm__scene_intersect_batch(scene, kernel, &b);
    for (size_t i = 0; i < count; i++) {
        pm__hit hit;
        const asked *const r = &rays[i];
        const bool met = pm__scene_intersect(scene, r->origin, r->direction, (double)INFINITY, r->from, &hit);
        ck_assert_msg(met == (b.material[i] != NULL), "%s: ray %zu of the batch: met %d alone", what, i, met);
        if (!met)
            continue;
        bool same = hit.distance == b.distance[i] && hit.shape == b.shape[i] && hit.material == b.material[i];
        for (int axis = 0; axis < 3; axis++)
            same = same && hit.position[axis] == b.position[axis][i] && hit.normal[axis] == b.normal[axis][i];
        ck_assert_msg(same, "%s: ray %zu of the batch: shape %d at %.17g, alone %u at %.17g", what, i,
                      (int)b.shape[i], b.distance[i], hit.shape, hit.distance);
    }
}

static inline void check_batches(const pm__scene *scene, const asked *rays, size_t count, const char *what)
{
    static const char *const widths[] = {"plain", "avx2", "avx512"};
    const pm__batch_kernel *const kernels[] = {&pm__batch_plain, &pm__batch_avx2, &pm__batch_avx512};
    for (size_t w = 0; w < 3; w++) {
        ck_assert_int_eq(setenv("PHOTONBENCH_SIMD", widths[w], 1), 0);
        if (pm__batch_choose() != kernels[w]) /* the processor lacks it */
            continue;
        for (size_t first = 0; first < count; first += PM__BATCH) {
            const size_t some = count - first < PM__BATCH ? count - first : PM__BATCH;
            check_batch(scene, kernels[w], rays + first, some, what);
        }
    }
    ck_assert_int_eq(unsetenv("PHOTONBENCH_SIMD"), 0);
}

#endif
