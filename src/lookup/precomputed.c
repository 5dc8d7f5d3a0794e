/* Estimates stored at photons, [C02] 5.4.
 *
 * On demand a value is computed by the first lookup that asks for it. It does not depend on who asks, so threads
 * that meet compute the same one and a single one of them stores it. */
#include "carriers.h"

#include "../base/memory.h"
#include "../base/parallel.h"

#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { EMPTY, CLAIMED, READY, DEGENERATE };
enum { BLOCK = 256 };

typedef struct stored {
    double value[3];
    double radius;   /* m */
    uint32_t count;  /* photons in the estimate */
    _Atomic unsigned char state;
} stored;

struct pm_precomputed {
    const pm_map *map;
    pm__carriers carriers;
    stored *estimates; /* one a carrier */
    pm__spec spec;
    pm_query lookup;
    int dimensions;
    atomic_size_t computed;
};

/* The estimate at a photon, its own flux included as the paper has it (errata 13). */
static pm_status compute(const pm_precomputed *p, size_t index, pm_workspace *workspace, pm_estimation *estimation)
{
    const pm_query query = pm__carrier_query(&p->carriers, p->map, &p->lookup, index);
    const pm__gathering gathering = {NULL, p->map->unit, true, false};
    pm_status status = pm__gather(p->map, &query, &gathering, workspace, 0);
    if (status != PM_OK)
        return status;
    pm__point_sets(workspace, 1, false);
    const pm__lookup lookup = {.sets = workspace->sets,
                               .set_count = 1,
                               .dimensions = p->dimensions,
                               .normal = {query.normal[0], query.normal[1], query.normal[2]},
                               .unit = p->map->unit};
    status = pm__evaluate(&p->spec, &lookup, workspace, estimation->value);
    estimation->radius = sqrt(lookup.sets[0].radius2) * lookup.unit;
    estimation->count = lookup.sets[0].count;
    return status;
}

static void store(pm_precomputed *p, size_t index, pm_status status, const pm_estimation *estimation)
{
    stored *const c = &p->estimates[index];
    unsigned char expected = EMPTY;
    if ((status != PM_OK && status != PM_EDEGENERATE) ||
        !atomic_compare_exchange_strong_explicit(&c->state, &expected, CLAIMED, memory_order_acquire,
                                                 memory_order_relaxed))
        return;
    memcpy(c->value, estimation->value, sizeof c->value);
    c->radius = estimation->radius;
    c->count = (uint32_t)estimation->count;
    atomic_fetch_add_explicit(&p->computed, 1, memory_order_relaxed);
    atomic_store_explicit(&c->state, status == PM_OK ? READY : DEGENERATE, memory_order_release);
}

/* The stored estimate of a carrier, computed now if it is not there. */
static pm_status fetch(pm_precomputed *p, size_t index, pm_workspace *workspace, pm_estimation *estimation)
{
    const stored *const c = &p->estimates[index];
    const unsigned char state = atomic_load_explicit(&c->state, memory_order_acquire);
    if (state == READY || state == DEGENERATE) {
        memcpy(estimation->value, c->value, sizeof c->value);
        estimation->radius = c->radius;
        estimation->count = c->count;
        return state == READY ? PM_OK : PM_EDEGENERATE;
    }
    const pm_status status = compute(p, index, workspace, estimation);
    store(p, index, status, estimation);
    return status;
}

typedef struct eager_work {
    pm_precomputed *precomputed;
    _Atomic int failure;
} eager_work;

static void eager_block(void *argument, size_t block)
{
    eager_work *const work = argument;
    pm_precomputed *const p = work->precomputed;
    pm_workspace *workspace = NULL;
    pm_status status = pm_workspace_create(p->lookup.k < p->map->count ? p->lookup.k : p->map->count, &workspace);
    for (size_t i = block * BLOCK; i < p->carriers.count && i < (block + 1) * BLOCK && status == PM_OK; i++) {
        pm_estimation estimation = {{0.0, 0.0, 0.0}, 0.0, 0};
        status = fetch(p, i, workspace, &estimation);
        if (status == PM_EDEGENERATE)
            status = PM_OK; /* told to whoever asks for this photon */
    }
    if (status != PM_OK)
        atomic_store(&work->failure, (int)status);
    pm_workspace_destroy(workspace);
}

static pm_status check_options(const pm_estimator *estimator, const pm_map *map,
                               const pm_precomputed_options *options, pm_error *error)
{
    if (!estimator || !map || !options)
        return pm__fail(error, PM_EINVAL, "an estimator, a map and options are needed");
    if (!(pm__estimator_of(&estimator->spec)->needs & PM__AT_PHOTON))
        return pm__fail(error, PM_EINVAL, "%s is not evaluated at photons", estimator->name);
    if (options->dimensions != 2 && options->dimensions != 3)
        return pm__fail(error, PM_EINVAL, "%d dimensions: 2 or 3 are known", options->dimensions);
    if (options->lookup.k && options->lookup.k < pm__estimator_of(&estimator->spec)->min_k)
        return pm__fail(error, PM_EINVAL, "k = %zu is too few for %s", options->lookup.k, estimator->name);
    pm_query query = options->lookup; /* normals come later, photon by photon */
    query.normal[0] = query.normal[1] = 0.0f;
    query.normal[2] = 1.0f;
    pm__query prepared;
    return pm__query_prepare(map, &query, &prepared, error);
}

pm_status pm_precomputed_create(const pm_estimator *estimator, const pm_map *map,
                                const pm_precomputed_options *options, pm_precomputed **precomputed, pm_error *error)
{
    if (!precomputed)
        return pm__fail(error, PM_EINVAL, "nowhere to put the estimates");
    *precomputed = NULL;
    pm_status status = check_options(estimator, map, options, error);
    if (status != PM_OK)
        return status;
    pm_precomputed *const p = calloc(1, sizeof *p);
    if (!p)
        return pm__fail(error, PM_ENOMEM, "out of memory for stored estimates");
    p->map = map;
    p->spec = estimator->spec;
    p->lookup = options->lookup;
    p->dimensions = options->dimensions;
    status = pm__carriers_create(&p->carriers, map, pm__spec_value(&p->spec, "fraction", 1.0), options->normals,
                                 options->parallel);
    p->estimates = status == PM_OK ? pm__alloc_zero(p->carriers.count, sizeof *p->estimates) : NULL;
    if (!p->estimates)
        status = pm__fail(error, PM_ENOMEM, "out of memory for stored estimates");
    if (status == PM_OK && pm__spec_value(&p->spec, "when", 0.0) == 0.0) {
        eager_work work = {p, PM_OK};
        pm__for(options->parallel, (p->carriers.count + BLOCK - 1) / BLOCK, eager_block, &work);
        status = (pm_status)atomic_load(&work.failure);
        if (status != PM_OK)
            (void)pm__fail(error, status, "an estimate at a photon: %s", pm_status_text(status));
    }
    if (status != PM_OK) {
        pm_precomputed_destroy(p);
        return status;
    }
    *precomputed = p;
    return PM_OK;
}

void pm_precomputed_destroy(pm_precomputed *precomputed)
{
    if (!precomputed)
        return;
    pm__carriers_destroy(&precomputed->carriers);
    free(precomputed->estimates);
    free(precomputed);
}

size_t pm_precomputed_computed(const pm_precomputed *precomputed)
{
    return atomic_load_explicit(&precomputed->computed, memory_order_relaxed);
}

pm_status pm__precomputed_lookup(const pm_precomputed *precomputed, const pm_query *query, pm_workspace *workspace,
                                 pm_estimation *estimation)
{
    size_t index = SIZE_MAX;
    const pm_status status = pm__nearest_carrier(&precomputed->carriers, query, workspace, &index);
    if (status != PM_OK || index == SIZE_MAX)
        return status;
    /* The demand form fills itself in; its values are a pure function of the map, so it is const to callers. */
    return fetch((pm_precomputed *)(uintptr_t)precomputed, index, workspace, estimation);
}
