/* Our own searches and the peers behind one interface: built from the same photons, asked the same queries. */
#ifndef PM_BENCH_CONTENDER_H
#define PM_BENCH_CONTENDER_H

#include "../src/search/search.h"
#include "peer.h"

/* Exactly one of the two is set. */
typedef struct pm__contender {
    const pm_search *search;
    const pm__peer *peer;
} pm__contender;

static inline const char *pm__contender_name(const pm__contender *contender)
{
    return contender->search ? contender->search->entry.name : contender->peer->name;
}

/* How many there are, and the i-th: our own first. */
size_t pm__contender_count(void);
pm__contender pm__contender_at(size_t i);

/* What is built from. */
typedef struct pm__bench_photons {
    const pm_photon *photons;
    const float (*points)[3]; /* their positions, packed, as peers want them; NULL where no peer runs */
    size_t count;
    size_t threads;           /* of the build */
    const pm_parallel *parallel;
} pm__bench_photons;

/* A contender's index; NULL members: none. */
typedef struct pm__bench_index {
    pm__contender contender;
    pm_map *map;
    void *foreign;
} pm__bench_index;

/* ENOMEM, EINVAL. */
pm_status pm__bench_index_build(const pm__contender *contender, const pm__bench_photons *photons,
                                pm__bench_index *index, pm_error *error);
void pm__bench_index_destroy(pm__bench_index *index);
size_t pm__bench_index_bytes(const pm__bench_index *index);

/* Asks an index queries[i]: one kind of query, one a call or in batches. All queries have the same k. */
typedef struct pm__asker {
    const pm__bench_index *index;
    const pm_query *queries;
    size_t query_count;
    size_t batch;           /* 1: one a call */
    size_t capacity;        /* results that a query has room for; enough for all */
    pm_neighbor *neighbors; /* [batch * capacity]; own searches */
    uint32_t *ids;          /* [capacity]; peers */
    float *distances2;      /* [capacity]; peers */
    size_t *counts;         /* [batch] */
    size_t checksum;        /* so that the work cannot be dropped */
    pm_status status;       /* the first that was not OK */
} pm__asker;

/* Can the contender answer queries like this one? */
bool pm__contender_can(const pm__contender *contender, const pm_query *query);

/* Sets all members; ENOMEM (free it then too). */
pm_status pm__asker_init(pm__asker *asker, const pm__bench_index *index, const pm_query *queries, size_t query_count,
                         size_t batch, size_t capacity);
void pm__asker_free(pm__asker *asker);

/* For the harness: `repetitions` queries from `first` on, around the list. */
void pm__asker_run(void *asker, size_t first, size_t repetitions);

/* Asks `count` (at most batch) queries from `first` on; leaves the caller's indices of the neighbours of the i-th at
 * ids[i * stride] on, in the order in which they came. stride >= capacity. */
pm_status pm__asker_collect(pm__asker *asker, size_t first, size_t count, uint32_t *ids, size_t stride, size_t *counts);

#endif
