/* A pass's photons at fixed points. Some chunks of photons at a time, each by a task, write down what they find by runs
 * of points; then a task for each run adds that up in the order of the photons. Where the room of a chunk does not
 * suffice, what stands behind the place is found again, in smaller chunks: sums are the same however they are cut, and
 * whatever threads there are. At the end the points take what has been added up. */
#include "cover.h"

#include "../../base/clock.h"
#include "../../base/memory.h"
#include "../../base/parallel.h"

#include <stdlib.h>
#include <string.h>

enum {
    GROUP = 32,   /* photons that wait for memory together */
    PIECE = 256,  /* points listed in a cell that are measured before what is found is looked at */
    FOUND = 1024,
    WAITING = 256, /* so many are looked at together: most of them have come by then */
    AHEAD = 12,
    LINE = 64,    /* bytes */
    MOST_FETCHED = 512,
    RUNS = 32,    /* of points, at most: the sums of one stay in a near cache */
    PAGE = 170    /* gifts: with its count and the next one's number 4 KB */
};

/* What a photon brings to a point: its power, by the BRDF where that depends on it, and the kernel's weight. */
typedef struct gift {
    double weight;
    float flux[3]; /* W */
    uint32_t point;
} gift;

typedef struct page {
    gift items[PAGE];
    uint32_t count, next;
} page;

/* What a chunk's photons have found: pages in a chain for each run of points. */
typedef struct pm__pairs {
    page *pages;
    uint32_t pages_used, first[RUNS], last[RUNS];
    bool full;             /* there was no room for what photon `photon` of the chunk brings to point `point` ... */
    uint32_t photon, point; /* ... nor for what comes after that: a photon's points ascend */
} pm__pairs;

typedef struct splatting {
    pm__run *run;
    const pm__photon_set *set;
    pm__cover *cover;
    const pm__estimator *kernel;
    const double *values; /* the kernel's */
    double norm;
    uint32_t pages;       /* that a chunk has */
    unsigned shift;       /* point >> shift: its run */
    size_t runs;
    /* The chunks in hand: the first one's photon, and that one's first point that has not been given anything. */
    size_t photon;
    uint32_t point;
    size_t size, chunks;  /* photons of a chunk; chunks */
    size_t taken;         /* of which all up to where the last one's room ended is added up */
    bool ends;            /* no photon comes after those */
    double areas[RUNS];   /* the sum of squared radii after the pass */
} splatting;

/* ---- Photons find points ----------------------------------------------------------------------- */

typedef struct meeting {
    uint32_t point, photon; /* the latter counted from the chunk's first */
} meeting;

/* A chunk under way. */
typedef struct finder {
    const splatting *of;
    const pm_photon *photons; /* the chunk's */
    pm__pairs *pairs;
    uint32_t point;        /* of its first photon: those before have had its gifts */
    size_t count, fetched; /* of those found: whose points are on their way from memory */
    meeting found[FOUND + PIECE];
} finder;

/* For surfaces that do not scatter evenly. */
static void by_brdf(const splatting *s, uint32_t at, const float direction[3], float flux[3])
{
    const pm__hit_point *const point = &s->run->of->fixed[at];
    const double in[3] = {-(double)direction[0], -(double)direction[1], -(double)direction[2]};
    double brdf[3];
    if (point->material->kind == PM__DIFFUSE)
        return;
    pm__hit_point_brdf(point, in, brdf);
    for (int b = 0; b < 3; b++)
        flux[b] *= (float)brdf[b];
}

/* NULL: there is no room. */
static gift *next_gift(const splatting *s, pm__pairs *pairs, uint32_t point)
{
    uint32_t *const last = &pairs->last[point >> s->shift];
    page *to = &pairs->pages[*last];
    if (to->count == PAGE) {
        if (pairs->pages_used == s->pages)
            return NULL;
        *last = to->next = pairs->pages_used++;
        to = &pairs->pages[*last];
        to->count = 0;
    }
    return &to->items[to->count++];
}

static void give(finder *f, const meeting *m, float distance2, const pm__standing *now)
{
    const splatting *const s = f->of;
    const pm_photon *const photon = &f->photons[m->photon];
    gift *const to = next_gift(s, f->pairs, m->point);
    if (!to) {
        f->pairs->full = true;
        f->pairs->photon = m->photon;
        f->pairs->point = m->point;
        return;
    }
    to->point = m->point;
    to->weight = s->kernel->weight(s->values, (double)distance2 / ((double)now->radius * (double)now->radius));
    memcpy(to->flux, photon->power, sizeof to->flux);
    if (s->cover->uneven)
        by_brdf(s, m->point, photon->direction, to->flux);
}

/* What has been found, by the radii of now and the side that the photons came from. In single precision, with sums in
 * the order that searches have (search/result.h). */
static void hand_over(finder *f)
{
    const splatting *const s = f->of;
    const bool front = s->run->of->front;
    const float scale = (float)s->cover->inverse_unit;
    for (size_t i = 0; i < f->count && !f->pairs->full; i++) {
        const meeting *const m = &f->found[i];
        const pm__standing *const now = &s->cover->now[m->point];
        const pm_photon *const photon = &f->photons[m->photon];
        const float *const p = photon->position, *const w = photon->direction, *const n = now->normal;
        const float x = p[0] * scale - now->position[0], y = p[1] * scale - now->position[1];
        const float z = p[2] * scale - now->position[2], distance2 = x * x + y * y + z * z;
        const bool before = m->photon == 0 && m->point < f->point;
        if (distance2 <= now->most2 && now->radius > 0.0f && !before &&
            !(front && !(w[0] * n[0] + w[1] * n[1] + w[2] * n[2] < 0.0f)))
            give(f, m, distance2, now);
    }
    f->count = f->fetched = 0;
}

/* A photon that waits for what its cell lists. */
typedef struct waiting {
    size_t cell, from, to;
    float within[3];
} waiting;

/* Points listed from `from` to `to`, at most PIECE. */
static void measure(finder *f, const waiting *w, uint32_t photon, size_t from, size_t to)
{
    const pm__listed *const listed = f->of->cover->listed;
    const float px = w->within[0], py = w->within[1], pz = w->within[2];
    size_t count = f->count;
    for (size_t e = from; e < to; e++) {
        const float x = px - (float)listed[e].position[0], y = py - (float)listed[e].position[1];
        const float z = pz - (float)listed[e].position[2], radius = (float)listed[e].radius;
        f->found[count] = (meeting){listed[e].point, photon};
        count += x * x + y * y + z * z <= radius * radius;
    }
    f->count = count;
    if (f->count >= FOUND)
        hand_over(f);
}

/* left: photons that there are from the group's first on, of this chunk and those after it. */
static void find_group(finder *f, size_t first, size_t count, size_t left)
{
    const pm__cover *const cover = f->of->cover;
    const pm_photon *const photons = f->photons + first;
    waiting group[GROUP];
    for (size_t i = 0; i < count; i++) {
        __builtin_prefetch(&photons[i + 3 * GROUP < left ? i + 3 * GROUP : 0]);
        group[i].cell = pm__cover_cell(cover, photons[i].position, group[i].within);
        if (group[i].cell != SIZE_MAX)
            __builtin_prefetch(&cover->starts[group[i].cell]);
    }
    for (size_t i = 0; i < count; i++) {
        waiting *const w = &group[i];
        w->from = w->cell == SIZE_MAX ? 0 : cover->starts[w->cell];
        w->to = w->cell == SIZE_MAX ? 0 : cover->starts[w->cell + 1];
        /* Not by a function of its own: compilers take one that has no effect but this for one without. */
        const char *const begin = (const char *)(cover->listed + w->from);
        for (size_t at = 0; at < (w->to - w->from) * sizeof *cover->listed && at < MOST_FETCHED; at += LINE)
            __builtin_prefetch(begin + at);
    }
    for (size_t i = 0; i < count; i++)
        for (size_t e = group[i].from; e < group[i].to && !f->pairs->full; e += PIECE)
            measure(f, &group[i], (uint32_t)(first + i), e, group[i].to - e < PIECE ? group[i].to : e + PIECE);
    for (; f->fetched < f->count; f->fetched++)
        __builtin_prefetch(&cover->now[f->found[f->fetched].point]);
    if (f->count >= WAITING)
        hand_over(f);
}

static void find_task(void *argument, size_t chunk)
{
    const splatting *const s = argument;
    const size_t first = s->photon + chunk * s->size, left = s->set->count - first;
    const size_t count = left < s->size ? left : s->size;
    pm__pairs *const pairs = &s->cover->pairs[chunk];
    finder f; /* not initialised as a whole: it is large */
    f.of = s;
    f.photons = s->set->photons + first;
    f.pairs = pairs;
    f.point = chunk ? 0 : s->point;
    f.count = f.fetched = 0;
    pairs->full = false;
    pairs->pages_used = RUNS;
    for (uint32_t run = 0; run < RUNS; run++) {
        pairs->first[run] = pairs->last[run] = run;
        pairs->pages[run].count = 0;
    }
    for (size_t i = 0; i < count && !pairs->full; i += GROUP)
        find_group(&f, i, count - i < GROUP ? count - i : GROUP, left - i);
    if (!pairs->full)
        hand_over(&f);
}

/* ---- Points take what they are given ------------------------------------------------------------ */

static void add_page(const page *from, pm__brought *brought)
{
    for (size_t g = 0; g < from->count; g++) {
        const gift *const given = &from->items[g];
        __builtin_prefetch(&brought[from->items[g + AHEAD < from->count ? g + AHEAD : g].point], 1);
        pm__brought *const to = &brought[given->point];
        for (int b = 0; b < 3; b++)
            to->flux[b] += given->weight * (double)given->flux[b];
        to->count++;
    }
}

/* In the order of the photons. */
static void add_up(const splatting *s, size_t run)
{
    for (size_t c = 0; c < s->taken; c++) {
        const pm__pairs *const pairs = &s->cover->pairs[c];
        uint32_t at = pairs->first[run];
        add_page(&pairs->pages[at], s->cover->brought);
        while (at != pairs->last[run]) {
            at = pairs->pages[at].next;
            add_page(&pairs->pages[at], s->cover->brought);
        }
    }
}

static void take(const splatting *s, size_t i)
{
    const pm__run *const run = s->run;
    const pm__progressive *const method = pm__progressive_of(run);
    pm__brought *const given = &s->cover->brought[i];
    const double radius = (double)s->cover->now[i].radius * s->cover->unit;
    const double area = 3.14159265358979323846 * (radius * radius);
    const double per = given->count && s->norm * area > 0.0 ? 1.0 / (s->norm * area) : 0.0;
    pm__found found = {.count = given->count, .area = area};
    for (int b = 0; b < 3; b++) {
        found.share[b] = s->cover->share[i][b];
        found.radiance[b] = found.share[b] * (given->flux[b] * per);
    }
    method->take(run, &found, run->state + i * method->fields);
    *given = (pm__brought){.count = 0};
}

static void take_all(splatting *s, size_t run)
{
    const size_t first = run << s->shift, all = s->run->of->points;
    const size_t end = (run + 1) << s->shift < all ? (run + 1) << s->shift : all;
    double area = 0.0; /* areas of other runs lie in the same line of memory */
    for (size_t i = first; i < end; i++) {
        if (!(s->cover->now[i].radius > 0.0f))
            continue;
        take(s, i);
        const double radius = (double)pm__cover_take_radius(s->cover, s->run, i);
        area += radius * radius;
    }
    s->areas[run] = area;
}

static void take_task(void *argument, size_t run)
{
    splatting *const s = argument;
    add_up(s, run);
    if (s->ends)
        take_all(s, run);
}

/* ---- A pass ------------------------------------------------------------------------------------ */

void pm__pairs_free(pm__pairs *pairs, size_t count)
{
    for (size_t i = 0; pairs && i < count; i++)
        free(pairs[i].pages);
    free(pairs);
}

/* Room for as many chunks as there are, and no more than the configuration has at once. */
static bool open_pairs(splatting *s)
{
    const pm__meeting *const room = &s->run->of->meeting;
    pm__cover *const cover = s->cover;
    const size_t chunks = (s->set->count + room->chunk - 1) / room->chunk;
    const size_t wanted = chunks < room->chunks ? chunks : room->chunks;
    s->size = room->chunk;
    s->pages = (uint32_t)(RUNS + room->pairs / PAGE);
    while ((s->run->of->points - 1) >> s->shift >= RUNS)
        s->shift++;
    s->runs = ((s->run->of->points - 1) >> s->shift) + 1;
    if (!cover->pairs)
        cover->pairs = calloc(room->chunks, sizeof *cover->pairs);
    for (; cover->pairs && cover->pair_lists < wanted; cover->pair_lists++) {
        page *const pages = pm__alloc(s->pages, sizeof *pages);
        if (!pages)
            return false;
        cover->pairs[cover->pair_lists].pages = pages;
    }
    return cover->pairs != NULL;
}

/* What is behind the chunks' first place without room is found again. */
static void find_some(splatting *s, const pm_parallel *parallel)
{
    const size_t left = s->cover->listed ? s->set->count - s->photon : 0, all = (left + s->size - 1) / s->size;
    s->chunks = all < s->cover->pair_lists ? all : s->cover->pair_lists;
    pm__for(parallel, s->chunks, find_task, s);
    for (s->taken = 0; s->taken < s->chunks && !s->cover->pairs[s->taken].full;)
        s->taken++;
    s->ends = s->taken == all;
    s->photon += s->taken * s->size;
    s->point = 0;
    if (s->taken == s->chunks)
        return;
    s->photon += s->cover->pairs[s->taken].photon;
    s->point = s->cover->pairs[s->taken].point;
    s->taken++;
    s->size = s->size > 1 ? s->size / 2 : 1;
}

/* Where radii have shrunk to half the area that is listed, half of what is measured is in vain. */
pm_status pm__cover_ready(pm__run *run, bool *done, pm_error *error)
{
    const double start = pm__seconds();
    pm_status status = PM_OK;
    if (run->cover && run->cover->area < 0.5 * run->cover->listed_area) {
        pm__cover_free(run->cover);
        run->cover = NULL;
    }
    if (!run->cover)
        status = pm__cover_make(run, &run->cover, error);
    run->build_s += pm__seconds() - start;
    *done = status == PM_OK && run->cover;
    return status;
}

pm_status pm__run_splat(pm__run *run, const pm__photon_set *set, bool *done, pm_error *error)
{
    const pm_parallel *const parallel = run->of->config->parallel;
    const pm__spec *const kernel = &run->of->config->estimator->spec;
    const pm_status status = pm__cover_ready(run, done, error);
    if (!*done)
        return status;
    const double start = pm__seconds();
    splatting s = {.run = run, .set = set, .cover = run->cover, .kernel = pm__estimator_of(kernel),
                   .values = kernel->values, .norm = pm__estimator_of(kernel)->norm(kernel->values, 2)};
    if (!open_pairs(&s)) /* nothing has been taken */
        return pm__fail(error, PM_ENOMEM, "out of memory for the photons of a pass");
    while (!s.ends) {
        find_some(&s, parallel);
        pm__for(parallel, s.runs, take_task, &s);
    }
    run->cover->area = 0.0;
    for (size_t i = 0; i < s.runs; i++)
        run->cover->area += s.areas[i];
    run->lookup_s += pm__seconds() - start;
    return PM_OK;
}
