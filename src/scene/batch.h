/* Photons and rays by the hundred: the same arithmetic as one by one (pm__random_triple, pm__scene_intersect,
 * pm__scatter), in the same order for each, hence the same digits; but a step is done for all of them before the next,
 * in SIMD and with few branches. */
#ifndef PM_SCENE_BATCH_H
#define PM_SCENE_BATCH_H

#include "light_emit.h"
#include "scene.h"

enum { PM__BATCH = 128 };

/* By component. What lies beyond `count` is worked on, up to the next multiple of 8, and means nothing. */
typedef struct pm__batch {
    size_t count;                                                /* at most PM__BATCH */
    _Alignas(64) double origin[3][PM__BATCH];                    /* m */
    double direction[3][PM__BATCH];                              /* unit */
    int64_t from[PM__BATCH];                                     /* as pm__scene_intersect has it */
    double distance[PM__BATCH];                                  /* and as pm__hit */
    double position[3][PM__BATCH], normal[3][PM__BATCH];
    int64_t shape[PM__BATCH];
    const pm__material *material[PM__BATCH];                     /* NULL: nothing is met */
    double rate[3][PM__BATCH];                                   /* one over the direction */
    double enter[PM__BATCH], leave[PM__BATCH];                   /* m: the box of all shapes */
    uint64_t may[PM__BATCH], asks[PM__BATCH];                    /* 0 or 1 */
    double power[3][PM__BATCH];
    int64_t kind[PM__BATCH];                                     /* of the material; of printed glossy ones black */
    double bands[3][PM__BATCH];                                  /* its albedo, reflectance or ior */
    double specular[3][PM__BATCH], alpha[PM__BATCH];             /* and of glossy ones the facets */
    double outgoing[3][PM__BATCH];
    double u[3][PM__BATCH], v[3][PM__BATCH];                     /* uniform numbers */
    uint64_t number[PM__BATCH], goes_on[PM__BATCH];
    int64_t place[PM__BATCH];                                    /* of its light; then, as scratch, of the shape */
} pm__batch;

struct pm__shape;
struct pm__few;

/* The loops in one width. */
typedef struct pm__batch_kernel {
    /* u: pm__random_triple for tracing, of number[i]. */
    void (*draw)(pm__batch *b, uint64_t seed, uint32_t trial, uint32_t block, double u[3][PM__BATCH]);
    /* pm__emit by u and v[0], with this power, for those whose place is `light`. */
    void (*emit)(pm__batch *b, const pm__lamp *lamp, int64_t light, const double power[3]);
    void (*begin)(pm__batch *b);
    void (*meet_flat)(pm__batch *b, const struct pm__shape *shape, int64_t number, int64_t place);
    void (*meet_sphere)(pm__batch *b, const struct pm__shape *shape, int64_t number, int64_t place);
    /* true: some rays are left to pm__shape_meet. */
    bool (*meet_cylinder)(pm__batch *b, const struct pm__shape *shape, int64_t number, int64_t place);
    void (*meet_wave)(pm__batch *b, const struct pm__shape *shape, int64_t number, int64_t place);
    /* enter, leave and asks (0 or 1): is_embrees of rays.c. */
    void (*cut)(pm__batch *b, const pm__scene *scene);
    void (*settle)(pm__batch *b, const struct pm__few *few);
    void (*settle_round)(pm__batch *b, const struct pm__few *few);
    void (*settle_wave)(pm__batch *b, const struct pm__shape *shape, int64_t place);
    /* pm__scatter by u of all whose kind is this: outgoing, power and goes_on (0 or 1; 0 also where FLT_MAX is
     * passed). NULL: one by one. */
    void (*scatter[PM__BLACK + 1])(pm__batch *b);
} pm__batch_kernel;

extern const pm__batch_kernel pm__batch_plain, pm__batch_avx2, pm__batch_avx512;

/* The widest that the processor has and PHOTONBENCH_SIMD lets. */
const pm__batch_kernel *pm__batch_choose(void);

/* pm__scene_intersect for all, without limit of reach. */
void pm__scene_intersect_batch(const pm__scene *scene, const pm__batch_kernel *kernel, pm__batch *batch);

#endif
