/* A cell is a cube of space and a cone of normals. Its list has every photon that is the nearest in front for some
 * point and normal in there. Left out are those too far behind the cone, and those that another is nearer than to every
 * point of the cube, if that one is in front for every normal: of squared distances the difference is linear, so its
 * largest value over the cube is known. Where a list would be long, cells of half the size have lists instead.
 *
 * A list costs about as much as PATIENCE searches, so it is made when a cell has been asked for so often; it is a
 * function of map and cell alone. Threads that meet make the same one, and one of them leaves it in the table. */
#include "nearest.h"

#include "vicinity.h"

#include "../base/memory.h"
#include "../base/vec3.h"
#include "../lookup/lookup.h"
#include "../search/result.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum { LEVELS = 6, MOST_LISTED = 16, MOST_GATHERED = 512, SEEDS = 8, PROBES = 8,
       PATIENCE = 8 };
enum { STEPS = 8, NODES = 2 * STEPS + 1 }; /* directions: 17 x 17 on each face of a cube */
static const uint32_t ask_side = (uint32_t)1 << 31, finer = UINT32_MAX;
/* How far, at most, a unit normal lies from the one that its cone is named after: sqrt(2) / 16 on the cube's face. */
static const float cone = 0.0884f;

typedef struct listed {
    float place[3];  /* map units */
    uint32_t number; /* with ask_side: in front for some normals of the cone only */
} listed;

typedef struct key {
    int32_t cell[3];
    uint32_t kind; /* level, and cone of normals */
} key;

typedef struct entry {
    key key;
    uint32_t count; /* `finer`: ask cells of half the size */
    listed list[];
} entry;

struct pm__nearest {
    const pm_map *map;
    float reach2;  /* map units squared */
    pm__vicinity vicinity; /* where anything is within it */
    double per_size[LEVELS]; /* one over the cells' size, map units: a power of two, so places fall into them exactly */
    size_t mask;   /* slots - 1 */
    _Atomic(entry *) *slots;
    _Atomic unsigned char *asked; /* how often, by slot, while that is empty */
};

/* A point that is asked about. */
typedef struct asked {
    float place[3]; /* map units */
    const float *normal;
    uint32_t cone;
    bool is_any; /* false: not finite, or nothing is near */
} asked;

/* ---- Cells ------------------------------------------------------------------------------------- */

static uint32_t cone_of(const float normal[3])
{
    int axis = fabsf(normal[1]) > fabsf(normal[0]) ? 1 : 0;
    axis = fabsf(normal[2]) > fabsf(normal[axis]) ? 2 : axis;
    const float scale = (float)STEPS / fabsf(normal[axis]);
    const int u = (int)(normal[(axis + 1) % 3] * scale + (float)STEPS + 0.5f);
    const int v = (int)(normal[(axis + 2) % 3] * scale + (float)STEPS + 0.5f);
    return (uint32_t)(((2 * axis + (normal[axis] < 0.0f)) * NODES + u) * NODES + v);
}

static void middle_of(uint32_t number, float normal[3])
{
    const int v = (int)(number % NODES), u = (int)(number / NODES % NODES), face = (int)(number / (NODES * NODES));
    const int axis = face / 2;
    double n[3];
    n[axis] = face % 2 ? -1.0 : 1.0;
    n[(axis + 1) % 3] = (double)(u - STEPS) / STEPS;
    n[(axis + 2) % 3] = (double)(v - STEPS) / STEPS;
    (void)pm__normalize(n);
    for (int i = 0; i < 3; i++)
        normal[i] = (float)n[i];
}

/* false: too far off to be counted. */
static bool key_of(const pm__nearest *nearest, const asked *point, uint32_t level, key *made)
{
    for (int i = 0; i < 3; i++) {
        const double at = floor((double)point->place[i] * nearest->per_size[level]);
        if (!(fabs(at) < 1e9))
            return false;
        made->cell[i] = (int32_t)at;
    }
    made->kind = level << 16 | point->cone;
    return true;
}

static size_t slot_of(const key *k)
{
    uint64_t hash = (uint64_t)k->kind;
    for (int i = 0; i < 3; i++)
        hash = (hash ^ (uint32_t)k->cell[i]) * 0x9e3779b97f4a7c15u;
    return (size_t)(hash ^ hash >> 32);
}

static bool is_same(const key *a, const key *b)
{
    return memcmp(a, b, sizeof *a) == 0;
}

/* ---- Lists ------------------------------------------------------------------------------------- */

/* What is gathered for a cell. */
typedef struct gathering {
    const pm_map *map;
    double middle[3], half; /* map units */
    float normal[3];        /* of the cone's middle */
    size_t count;
    listed list[MOST_GATHERED];
    double distance2[MOST_GATHERED]; /* from the middle */
    listed first;                    /* in front for all normals of the cone, and near; */
    double first2;                   /* INFINITY: there is none */
} gathering;

static double distance2_of(const gathering *g, const float place[3])
{
    double sum = 0.0;
    for (int i = 0; i < 3; i++)
        sum += ((double)place[i] - g->middle[i]) * ((double)place[i] - g->middle[i]);
    return sum;
}

/* false: behind for all of them. */
static bool is_possible(const gathering *g, uint32_t number, listed *made)
{
    const float *const way = pm__direction(g->map, number);
    const float along = way[0] * g->normal[0] + way[1] * g->normal[1] + way[2] * g->normal[2];
    if (!(along < cone))
        return false;
    pm__position(g->map, number, made->place);
    made->number = along < -cone ? number : number | ask_side;
    return true;
}

/* Is a nearer than b to every point of the cube, be distances rounded? */
static bool is_always_nearer(const gathering *g, const listed *a, double a2, const listed *b, double b2)
{
    double most = a2 - b2;
    for (int i = 0; i < 3; i++)
        most += 2.0 * g->half * fabs((double)a->place[i] - (double)b->place[i]);
    return most < -1e-6 * (b2 + 3.0 * g->half * g->half);
}

static bool gather(void *context, const pm_neighbor *found, size_t count)
{
    gathering *const g = context;
    for (size_t i = 0; i < count; i++) {
        listed one;
        if (!is_possible(g, found[i].number, &one))
            continue;
        const double distance2 = distance2_of(g, one.place);
        if (g->first2 < INFINITY && is_always_nearer(g, &g->first, g->first2, &one, distance2))
            continue;
        if (g->count == MOST_GATHERED) {
            g->count++;
            return false;
        }
        g->list[g->count] = one;
        g->distance2[g->count++] = distance2;
    }
    return true;
}

static pm__query query_about(const gathering *g, double radius2)
{
    pm__query query = {.prune_scale = 1.0f, .max_distance2 = (float)radius2};
    for (int i = 0; i < 3; i++) {
        query.position[i] = (float)g->middle[i];
        query.normal[i] = g->normal[i];
    }
    return query;
}

/* Of the nearest few in front, the nearest that is so for all normals. */
static void find_first(gathering *g, double reach2)
{
    pm_neighbor near[SEEDS];
    const size_t all = pm_map_count(g->map), k = all < SEEDS ? all : SEEDS;
    pm__query query = query_about(g, reach2);
    query.k = k;
    query.front_only = true;
    const size_t found = pm__run_search(g->map, g->map->search, &query, near, k);
    g->first2 = INFINITY;
    for (size_t i = 0; i < found; i++) {
        listed one;
        if (!is_possible(g, near[i].number, &one) || (one.number & ask_side))
            continue;
        const double distance2 = distance2_of(g, one.place);
        if (distance2 < g->first2) {
            g->first = one;
            g->first2 = distance2;
        }
    }
}

static void sort_by_distance(gathering *g)
{
    for (size_t i = 1; i < g->count; i++) {
        const listed one = g->list[i];
        const double distance2 = g->distance2[i];
        size_t at = i;
        for (; at > 0 && g->distance2[at - 1] > distance2; at--) {
            g->list[at] = g->list[at - 1];
            g->distance2[at] = g->distance2[at - 1];
        }
        g->list[at] = one;
        g->distance2[at] = distance2;
    }
}

static bool is_needless(const gathering *g, size_t kept, size_t i)
{
    for (size_t j = 0; j < kept; j++)
        if (!(g->list[j].number & ask_side) &&
            is_always_nearer(g, &g->list[j], g->distance2[j], &g->list[i], g->distance2[i]))
            return true;
    return false;
}

/* Leaves what may be nearest; more than can be listed stays too many. */
static void thin_out(gathering *g)
{
    size_t kept = 0;
    if (g->count > MOST_GATHERED)
        return;
    sort_by_distance(g);
    for (size_t i = 0; i < g->count && kept <= MOST_LISTED; i++)
        if (!is_needless(g, kept, i)) {
            g->list[kept] = g->list[i];
            g->distance2[kept++] = g->distance2[i];
        }
    g->count = kept;
}

static void gather_cell(const pm__nearest *nearest, const key *k, gathering *g)
{
    const double size = 1.0 / nearest->per_size[k->kind >> 16], diagonal = sqrt(3.0) * 0.5 * size * (1.0 + 1e-6);
    g->map = nearest->map;
    g->half = 0.5 * size;
    g->count = 0;
    for (int i = 0; i < 3; i++)
        g->middle[i] = ((double)k->cell[i] + 0.5) * size;
    middle_of(k->kind & 0xffff, g->normal);
    const double reach = sqrt((double)nearest->reach2) + diagonal;
    find_first(g, reach * reach);
    const double radius = fmin(reach, sqrt(g->first2) + 2.0 * diagonal) * (1.0 + 1e-6);
    const pm__query query = query_about(g, radius * radius);
    pm_neighbor block[256];
    pm__result result = {.list = block, .capacity = 256, .bound = query.max_distance2, .ids = g->map->ids,
                         .deliver = gather, .context = g};
    g->map->search->find(g->map, &query, &result);
    if (result.count && !result.stopped)
        (void)gather(g, block, result.count);
    thin_out(g);
}

/* NULL: out of memory. */
static entry *make_entry(const pm__nearest *nearest, const key *k)
{
    gathering g;
    gather_cell(nearest, k, &g);
    const bool too_many = g.count > MOST_LISTED;
    const size_t count = too_many ? 0 : g.count;
    entry *const made = malloc(sizeof *made + count * sizeof *made->list);
    if (!made)
        return NULL;
    made->key = *k;
    made->count = too_many ? finer : (uint32_t)count;
    memcpy(made->list, g.list, count * sizeof *made->list);
    return made;
}

/* NULL: no room, or not yet. */
static const entry *entry_of(pm__nearest *nearest, const key *k)
{
    const size_t first = slot_of(k);
    for (size_t i = 0; i < PROBES; i++) {
        const size_t at = (first + i) & nearest->mask;
        _Atomic(entry *) *const slot = &nearest->slots[at];
        entry *there = atomic_load_explicit(slot, memory_order_acquire);
        if (!there) {
            if (atomic_fetch_add_explicit(&nearest->asked[at], 1, memory_order_relaxed) < PATIENCE)
                return NULL;
            entry *const made = make_entry(nearest, k);
            if (!made || atomic_compare_exchange_strong_explicit(slot, &there, made, memory_order_acq_rel,
                                                                 memory_order_acquire))
                return made;
            free(made);
        }
        if (is_same(&there->key, k))
            return there;
    }
    return NULL;
}

/* ---- Points ------------------------------------------------------------------------------------ */

/* Ties go to the lower index of the caller's. */
static pm_neighbor nearest_listed(const pm__nearest *nearest, const entry *e, const asked *point)
{
    pm_neighbor best = {nearest->reach2, UINT32_MAX};
    pm__query query = {.shape = PM_LOOKUP_SPHERE};
    memcpy(query.position, point->place, sizeof query.position);
    memcpy(query.normal, point->normal, sizeof query.normal);
    for (uint32_t i = 0; i < e->count; i++) {
        const uint32_t number = e->list[i].number & ~ask_side;
        const pm_neighbor one = {pm__measure(&query, e->list[i].place), number};
        if (!(one.distance2 <= best.distance2))
            continue;
        if (one.distance2 == best.distance2 && best.number != UINT32_MAX &&
            nearest->map->ids[number] > nearest->map->ids[best.number])
            continue;
        if (!(e->list[i].number & ask_side) || pm__in_front(nearest->map, &query, number))
            best = one;
    }
    return best;
}

static pm_neighbor search(const pm__nearest *nearest, const asked *point)
{
    pm_neighbor best = {0.0f, UINT32_MAX};
    pm__query query = {.k = 1, .prune_scale = 1.0f, .max_distance2 = nearest->reach2, .front_only = true};
    memcpy(query.position, point->place, sizeof query.position);
    memcpy(query.normal, point->normal, sizeof query.normal);
    const size_t found = pm__run_search(nearest->map, nearest->map->search, &query, &best, 1);
    return found ? best : (pm_neighbor){0.0f, UINT32_MAX};
}

static pm_neighbor find_one(pm__nearest *nearest, const asked *point)
{
    key k;
    for (uint32_t level = 0; level < LEVELS && key_of(nearest, point, level, &k); level++) {
        const entry *const e = entry_of(nearest, &k);
        if (!e)
            break;
        if (e->count != finer)
            return nearest_listed(nearest, e, point);
    }
    return search(nearest, point);
}

static asked ask(const pm__nearest *nearest, const float position[3], const float normal[3])
{
    asked point = {.normal = normal};
    float sum = 0.0f;
    for (int i = 0; i < 3; i++) {
        point.place[i] = pm__in_frame(nearest->map, i, position[i]);
        sum += fabsf(normal[i]);
    }
    point.is_any = sum > 0.0f && sum < INFINITY && isfinite(position[0] + position[1] + position[2]) &&
                   pm__vicinity_holds(&nearest->vicinity, point.place);
    point.cone = point.is_any ? cone_of(normal) : 0;
    return point;
}

/* What the first cells are, and then their lists, is fetched for all points before any is looked at. */
void pm__nearest_find(pm__nearest *nearest, const float (*positions)[3], const float (*normals)[3], size_t count,
                      pm_neighbor *found)
{
    asked points[PM__NEAREST_AT_ONCE];
    size_t slots[PM__NEAREST_AT_ONCE];
    for (size_t i = 0; i < count; i++) {
        key k;
        points[i] = ask(nearest, positions[i], normals[i]);
        slots[i] = points[i].is_any && key_of(nearest, &points[i], 0, &k) ? slot_of(&k) & nearest->mask : 0;
        __builtin_prefetch(&nearest->slots[slots[i]]);
    }
    for (size_t i = 0; i < count; i++) {
        const entry *const there = atomic_load_explicit(&nearest->slots[slots[i]], memory_order_relaxed);
        if (there) {
            __builtin_prefetch(there);
            __builtin_prefetch((const char *)there + 64);
        }
    }
    for (size_t i = 0; i < count; i++)
        found[i] = points[i].is_any ? find_one(nearest, &points[i]) : (pm_neighbor){0.0f, UINT32_MAX};
}

/* ---- Creation ---------------------------------------------------------------------------------- */

pm_status pm__nearest_create(const pm_map *map, double reach, double spacing, pm__nearest **nearest)
{
    enum { LEAST_SLOTS = 1 << 17, MOST_SLOTS = 1 << 20 };
    size_t slots = LEAST_SLOTS;
    while (slots < MOST_SLOTS && slots < 16 * pm_map_count(map))
        slots *= 2;
    pm__nearest *const made = pm__alloc_zero(1, sizeof *made);
    *nearest = NULL;
    if (!made)
        return PM_ENOMEM;
    const double framed = reach * map->inverse_unit, size = fmin(fmax(spacing * map->inverse_unit, 1e-9), 1e9);
    made->map = map;
    made->reach2 = (float)fmin(framed * framed, 1e37);
    for (int level = 0; level < LEVELS; level++)
        made->per_size[level] = ldexp(1.0, level - (int)rint(log2(size)));
    made->mask = slots - 1;
    made->slots = pm__alloc_zero(slots, sizeof *made->slots);
    made->asked = pm__alloc_zero(slots, sizeof *made->asked);
    const bool known = pm__vicinity_create(map, sqrt((double)made->reach2), &made->vicinity) == PM_OK;
    if (!made->slots || !made->asked || !known) {
        pm__vicinity_free(&made->vicinity);
        free((void *)made->slots);
        free((void *)made->asked);
        free(made);
        return PM_ENOMEM;
    }
    *nearest = made;
    return PM_OK;
}

void pm__nearest_destroy(pm__nearest *nearest)
{
    if (!nearest)
        return;
    for (size_t i = 0; i <= nearest->mask; i++)
        free(atomic_load_explicit(&nearest->slots[i], memory_order_relaxed));
    free((void *)nearest->slots);
    free((void *)nearest->asked);
    pm__vicinity_free(&nearest->vicinity);
    free(nearest);
}
