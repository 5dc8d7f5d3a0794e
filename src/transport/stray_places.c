#include "stray_places.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "surroundings.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* Photons of one task; strays that look for others at once; photons that one looks at. */
enum { PIECE = 2048, AT_ONCE = 16, MOST = 256 };

/* Photons of the stock near strays. */
typedef struct meeting {
    pm__storage *storage;
    pm__stray_places *places;
    bool by_importance;   /* the box is that of important photons, else of strays */
    pm__voxels voxels;
    uint32_t *voxel;      /* of each photon of the stock */
    pm__reach *reach;
    float (*boxes)[2][3]; /* of pieces */
    size_t *starts;       /* of pieces: in what is below */
    pm_photon *photons;
    uint32_t *who;        /* numbers in the stock */
    size_t count;
    pm_map *map;
    _Atomic pm_status status;
} meeting;

/* ---- Where ------------------------------------------------------------------------------------- */

static const pm_parallel *parallel_of(const meeting *m)
{
    return m->storage->config->parallel;
}

static void widen(float box[2][3], const float position[3])
{
    for (int a = 0; a < 3; a++) {
        box[0][a] = fminf(box[0][a], position[a]);
        box[1][a] = fmaxf(box[1][a], position[a]);
    }
}

static void empty(float box[2][3])
{
    for (int a = 0; a < 3; a++) {
        box[0][a] = INFINITY;
        box[1][a] = -INFINITY;
    }
}

static void box_piece(void *argument, size_t piece)
{
    const meeting *const m = argument;
    const pm__stock *const stock = &m->storage->stock;
    const size_t end = pm__piece_end(piece, PIECE, stock->count);
    empty(m->boxes[piece]);
    for (size_t i = piece * PIECE; i < end; i++)
        if (stock->part[i])
            widen(m->boxes[piece], stock->photons[i].position);
}

/* false: there is nothing. */
static bool find_box(const meeting *m, float box[2][3])
{
    const size_t pieces = m->by_importance ? pm__pieces(m->storage->stock.count, PIECE) : 0;
    pm__for(parallel_of(m), pieces, box_piece, (void *)m);
    empty(box);
    for (size_t i = 0; i < pieces; i++) {
        if (m->boxes[i][0][0] > m->boxes[i][1][0])
            continue;
        widen(box, m->boxes[i][0]);
        widen(box, m->boxes[i][1]);
    }
    for (size_t i = 0; i < m->places->stray_count && !m->by_importance; i++)
        widen(box, m->places->strays[i].photon.position);
    return box[0][0] <= box[1][0];
}

static void voxels_of_piece(void *argument, size_t piece)
{
    meeting *const m = argument;
    const pm__stock *const stock = &m->storage->stock;
    const size_t end = pm__piece_end(piece, PIECE, stock->count);
    for (size_t i = piece * PIECE; i < end; i++)
        m->voxel[i] = pm__voxels_count(&m->voxels, stock->photons[i].position, stock->part[i]);
}

/* Strays of the stock that lie near important photons. */
static pm_status choose_strays(meeting *m)
{
    enum { ENOUGH = 12 }; /* of a lookup of 50 */
    pm__storage *const storage = m->storage;
    const pm__sender *const sender = storage->sender;
    const pm__stock *const stock = &storage->stock;
    m->places->own = pm__alloc(sender->place_count, sizeof *m->places->own);
    if (!m->places->own)
        return PM_ENOMEM;
    m->places->strays = m->places->own;
    pm__reach_mark_all(&m->voxels, ENOUGH, m->reach);
    pm__reach_spread(m->reach);
    for (size_t i = 0; i < sender->place_count; i++) {
        const size_t place = sender->places[i];
        if (!pm__reach_holds(m->reach, m->voxel[place]))
            continue;
        pm__stray *const stray = &m->places->own[m->places->stray_count++];
        *stray = pm__stray_of(storage, &stock->photons[place], stock->normals[place], stock->part[place]);
        stray->place = place;
    }
    *m->reach = (pm__reach){{0}};
    return PM_OK;
}

/* How many of the nearest a stray looks at: beside some of those behind the surface. */
static size_t seen_by(const pm__stray *stray)
{
    return 2 * stray->parts + 6 < MOST ? 2 * stray->parts + 6 : MOST;
}

static void choose_reach(meeting *m)
{
    for (size_t i = 0; i < m->places->stray_count; i++)
        pm__reach_mark(&m->voxels, m->places->strays[i].photon.position,
                       (uint32_t)(seen_by(&m->places->strays[i]) / 3), m->reach);
    pm__reach_spread(m->reach);
}

static bool is_near(const meeting *m, size_t i)
{
    return i >= m->storage->settled && pm__reach_holds(m->reach, m->voxel[i]);
}

static void count_near(void *argument, size_t piece)
{
    const meeting *const m = argument;
    const size_t end = pm__piece_end(piece, PIECE, m->storage->stock.count);
    size_t count = 0;
    for (size_t i = piece * PIECE; i < end; i++)
        count += is_near(m, i);
    m->starts[piece] = count;
}

static void list_near(void *argument, size_t piece)
{
    const meeting *const m = argument;
    const size_t end = pm__piece_end(piece, PIECE, m->storage->stock.count);
    size_t at = m->starts[piece];
    for (size_t i = piece * PIECE; i < end; i++)
        if (is_near(m, i)) {
            m->photons[at] = m->storage->stock.photons[i];
            m->who[at++] = (uint32_t)i;
        }
}

/* Photons near strays, as a map. */
static pm_status make_map(meeting *m)
{
    const size_t pieces = pm__pieces(m->storage->stock.count, PIECE);
    const pm_map_options options = {.parallel = parallel_of(m)};
    pm__for(parallel_of(m), pieces, count_near, m);
    for (size_t piece = 0; piece < pieces; piece++) {
        const size_t own = m->starts[piece];
        m->starts[piece] = m->count;
        m->count += own;
    }
    m->photons = pm__alloc(m->count, sizeof *m->photons);
    m->who = pm__alloc(m->count, sizeof *m->who);
    if (!m->photons || !m->who)
        return PM_ENOMEM;
    pm__for(parallel_of(m), pieces, list_near, m);
    const pm_status status = pm_map_create(m->photons, m->count, &options, &m->map, m->storage->error);
    free(m->photons);
    m->photons = NULL;
    return status;
}

static pm_status gather_near(meeting *m)
{
    const size_t pieces = pm__pieces(m->storage->stock.count, PIECE);
    float box[2][3];
    m->boxes = pm__alloc(pieces, sizeof *m->boxes);
    m->starts = pm__alloc(pieces, sizeof *m->starts);
    m->voxel = pm__alloc(m->storage->stock.count, sizeof *m->voxel);
    m->reach = pm__alloc_zero(1, sizeof *m->reach);
    if (!m->boxes || !m->starts || !m->voxel || !m->reach)
        return PM_ENOMEM;
    if (!find_box(m, box))
        return PM_OK;
    if (pm__voxels_create(box[0], box[1], &m->voxels))
        return PM_ENOMEM;
    pm__for(parallel_of(m), pieces, voxels_of_piece, m);
    pm__voxels_gather(&m->voxels, parallel_of(m));
    const pm_status status = m->by_importance ? choose_strays(m) : PM_OK;
    if (status != PM_OK || !m->places->stray_count)
        return status;
    choose_reach(m);
    return make_map(m);
}

/* ---- Whom they meet ----------------------------------------------------------------------------- */

/* May a part of the stray lie where this one does? */
static bool is_alike(const meeting *m, const pm__stray *stray, size_t who)
{
    static const float least_cosine = 0.7f;
    const pm__stock *const stock = &m->storage->stock;
    const float *const n = stock->normals[who], *const own = stray->normal, *const d = stray->photon.direction;
    return (bool)stock->part[who] == stray->important &&
           n[0] * own[0] + n[1] * own[1] + n[2] * own[2] > least_cosine &&
           n[0] * d[0] + n[1] * d[1] + n[2] * d[2] < 0.0f;
}

/* Up to as many of its nearest as it has parts. */
static void list_alike(meeting *m, size_t i, const pm_neighbor *near, size_t found)
{
    const size_t first = m->places->first[i], most = m->places->first[i + 1] - first;
    size_t count = 0;
    for (size_t n = 0; n < found && count < most; n++) {
        const uint32_t who = m->who[pm_map_source(m->map, near[n].number)];
        if (is_alike(m, &m->places->strays[i], who))
            m->places->alike[first + count++] = who;
    }
    m->places->count[i] = count;
}

static pm_query query_of(const meeting *m, const pm__stray *stray)
{
    pm_query query;
    pm_query_init(&query);
    memcpy(query.position, stray->photon.position, sizeof query.position);
    memcpy(query.normal, stray->normal, sizeof query.normal);
    query.k = seen_by(stray) < m->count ? seen_by(stray) : m->count;
    query.front_only = true;
    query.sorted = true;
    return query;
}

static void meet_some(void *argument, size_t block)
{
    meeting *const m = argument;
    const size_t first = block * AT_ONCE, left = m->places->stray_count - first;
    const size_t count = left < AT_ONCE ? left : AT_ONCE;
    pm_neighbor near[AT_ONCE * MOST];
    pm_query queries[AT_ONCE] = {{.k = 0}};
    size_t found[AT_ONCE];
    for (size_t i = 0; i < count; i++)
        queries[i] = query_of(m, &m->places->strays[first + i]);
    const pm_status status = pm_map_search_batch(m->map, queries, count, near, MOST, found);
    for (size_t i = 0; i < count && status == PM_OK; i++)
        list_alike(m, first + i, near + i * MOST, found[i]);
    if (status != PM_OK)
        atomic_store(&m->status, status);
}

static pm_status meet(meeting *m)
{
    pm__stray_places *const places = m->places;
    const size_t strays = places->stray_count;
    size_t sum = 0;
    places->first = pm__alloc(strays + 1, sizeof *places->first);
    places->count = pm__alloc_zero(strays, sizeof *places->count);
    for (size_t i = 0; i <= strays && places->first; i++) {
        places->first[i] = sum;
        if (i < strays)
            sum += places->strays[i].parts < MOST ? places->strays[i].parts : MOST;
    }
    places->alike = pm__alloc(sum, sizeof *places->alike);
    if (!places->first || !places->count || !places->alike)
        return PM_ENOMEM;
    if (m->count)
        pm__for(parallel_of(m), pm__pieces(strays, AT_ONCE), meet_some, m);
    return m->status;
}

static pm_status find(meeting *m)
{
    pm_status status = gather_near(m);
    if (status == PM_OK)
        status = meet(m);
    pm__voxels_free(&m->voxels);
    pm_map_destroy(m->map);
    free(m->voxel);
    free(m->reach);
    free(m->boxes);
    free(m->starts);
    free(m->photons);
    free(m->who);
    return status;
}

pm_status pm__find_near_importance(pm__storage *storage, pm__stray_places *places)
{
    meeting m = {.storage = storage, .places = places, .by_importance = true};
    *places = (pm__stray_places){.stray_count = 0};
    return find(&m);
}

pm_status pm__find_near_strays(pm__storage *storage, pm__stray_places *places)
{
    meeting m = {.storage = storage, .places = places};
    *places = (pm__stray_places){.strays = storage->sender->strays, .stray_count = storage->sender->stray_count};
    return find(&m);
}

void pm__stray_places_free(pm__stray_places *places)
{
    free(places->own);
    free(places->first);
    free(places->count);
    free(places->alike);
    *places = (pm__stray_places){.stray_count = 0};
}
