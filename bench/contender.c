#include "contender.h"

#include "../src/base/memory.h"

#include <stdlib.h>
#include <string.h>

static size_t peer_count(void)
{
    size_t count = 0;
    while (pm__peers[count])
        count++;
    return count;
}

size_t pm__contender_count(void)
{
    return pm__searches.count + peer_count();
}

pm__contender pm__contender_at(size_t i)
{
    if (i < pm__searches.count)
        return (pm__contender){pm_search_find(pm__searches.entries[i]->name), NULL};
    return (pm__contender){NULL, pm__peers[i - pm__searches.count]};
}

pm_status pm__bench_index_build(const pm__contender *contender, const pm__bench_photons *photons,
                                pm__bench_index *index, pm_error *error)
{
    *index = (pm__bench_index){*contender, NULL, NULL};
    if (contender->search) {
        const pm_map_options options = {.search = contender->search,
                                        .parallel = photons->threads > 1 ? photons->parallel : NULL};
        return pm_map_create(photons->photons, photons->count, &options, &index->map, error);
    }
    index->foreign = contender->peer->build(photons->points, photons->count, photons->threads);
    return index->foreign ? PM_OK : pm__fail(error, PM_ENOMEM, "%s builds no index", contender->peer->name);
}

void pm__bench_index_destroy(pm__bench_index *index)
{
    pm_map_destroy(index->map);
    if (index->foreign)
        index->contender.peer->destroy(index->foreign);
    index->map = NULL;
    index->foreign = NULL;
}

size_t pm__bench_index_bytes(const pm__bench_index *index)
{
    return index->map ? pm_map_bytes(index->map) : index->contender.peer->bytes(index->foreign);
}

bool pm__contender_can(const pm__contender *contender, const pm_query *query)
{
    if (contender->search)
        return !(contender->search->radius_only && query->k);
    return query->shape == PM_LOOKUP_SPHERE && !query->front_only && (query->k || contender->peer->within);
}

pm_status pm__asker_init(pm__asker *asker, const pm__bench_index *index, const pm_query *queries, size_t query_count,
                         size_t batch, size_t capacity)
{
    *asker = (pm__asker){.index = index, .queries = queries, .query_count = query_count, .batch = batch,
                         .capacity = capacity};
    if (index->map) {
        asker->neighbors = pm__alloc(batch * capacity, sizeof *asker->neighbors);
        asker->counts = pm__alloc(batch, sizeof *asker->counts);
        return asker->neighbors && asker->counts ? PM_OK : PM_ENOMEM;
    }
    asker->ids = pm__alloc(capacity, sizeof *asker->ids);
    asker->distances2 = pm__alloc(capacity, sizeof *asker->distances2);
    return asker->ids && asker->distances2 ? PM_OK : PM_ENOMEM;
}

void pm__asker_free(pm__asker *asker)
{
    free(asker->neighbors);
    free(asker->counts);
    free(asker->ids);
    free(asker->distances2);
}

/* Counts of `count` queries from `first` on; what they found is in the buffers. */
static void ask_map(pm__asker *asker, size_t first, size_t count, size_t *counts)
{
    const pm_status status =
        count > 1 ? pm_map_search_batch(asker->index->map, &asker->queries[first], count, asker->neighbors,
                                        asker->capacity, counts)
                  : pm_map_search(asker->index->map, &asker->queries[first], asker->neighbors, asker->capacity, counts);
    if (status != PM_OK && asker->status == PM_OK)
        asker->status = status;
}

static size_t ask_peer(pm__asker *asker, size_t first)
{
    const pm__peer *const peer = asker->index->contender.peer;
    const pm_query *const query = &asker->queries[first];
    const size_t count =
        query->k ? peer->nearest(asker->index->foreign, query->position, query->k, asker->ids, asker->distances2)
                 : peer->within(asker->index->foreign, query->position, query->max_radius, asker->capacity, asker->ids);
    if (count != PM__PEER_FAILED && count <= asker->capacity)
        return count;
    if (asker->status == PM_OK)
        asker->status = PM_ETRUNCATED;
    return 0;
}

static void run_map(pm__asker *asker, size_t first, size_t repetitions)
{
    for (size_t done = 0; done < repetitions;) {
        const size_t at = (first + done) % asker->query_count;
        size_t count = asker->batch;
        count = count < repetitions - done ? count : repetitions - done;
        count = count < asker->query_count - at ? count : asker->query_count - at;
        ask_map(asker, at, count, asker->counts);
        asker->checksum += asker->counts[0];
        done += count;
    }
}

static void run_peer(pm__asker *asker, size_t first, size_t repetitions)
{
    for (size_t done = 0; done < repetitions; done++)
        asker->checksum += ask_peer(asker, (first + done) % asker->query_count);
}

void pm__asker_run(void *asker, size_t first, size_t repetitions)
{
    pm__asker *const a = asker;
    if (a->index->map)
        run_map(a, first, repetitions);
    else
        run_peer(a, first, repetitions);
}

pm_status pm__asker_collect(pm__asker *asker, size_t first, size_t count, uint32_t *ids, size_t stride, size_t *counts)
{
    asker->status = PM_OK;
    if (!asker->index->map) {
        counts[0] = ask_peer(asker, first);
        memcpy(ids, asker->ids, counts[0] * sizeof *ids);
        return asker->status;
    }
    ask_map(asker, first, count, counts);
    for (size_t i = 0; i < count && asker->status == PM_OK; i++)
        for (size_t j = 0; j < counts[i]; j++)
            ids[i * stride + j] = pm_map_source(asker->index->map, asker->neighbors[i * asker->capacity + j].number);
    return asker->status;
}
