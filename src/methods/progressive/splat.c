/* A pass's photons at fixed points: what each finds is written down by runs of points, and these take it in the order
 * of the photons, whatever threads there are. */
#include "cover.h"

#include "../../base/clock.h"
#include "../../base/memory.h"
#include "../../base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

enum {
    CHUNK = 8192, /* photons of a task */
    GROUP = 32,   /* photons that wait for memory together */
    PIECE = 256,  /* points listed in a cell that are measured before what is found is looked at */
    FOUND = 1024,
    WAITING = 256, /* so many are looked at together: most of them have come by then */
    AHEAD = 12,
    LINE = 64,    /* bytes */
    MOST_FETCHED = 512,
    RUNS = 32     /* of points, at most: the sums of one stay in a near cache */
};

typedef struct splatting {
    pm__run *run;
    const pm__photon_set *set;
    pm__cover *cover;
    const pm__estimator *kernel;
    const double *values; /* the kernel's */
    double norm;
    pm__gifts *lists;     /* [chunks * RUNS] */
    size_t chunks;
    unsigned shift;       /* point >> shift: its run */
    double areas[RUNS];   /* the sum of squared radii after the pass */
    atomic_int failed;    /* memory ran out */
} splatting;

/* ---- Photons find points ----------------------------------------------------------------------- */

typedef struct meeting {
    uint32_t point, photon;
} meeting;

/* A chunk under way. */
typedef struct finder {
    splatting *of;
    pm__gifts *lists; /* the chunk's */
    size_t count, fetched; /* of those found: whose points are on their way from memory */
    meeting found[FOUND + PIECE];
} finder;

/* For surfaces that do not scatter evenly. */
static void by_brdf(const splatting *s, const meeting *m, const float direction[3], float flux[3])
{
    const pm__hit_point *const point = &s->run->of->fixed[m->point];
    const double in[3] = {-(double)direction[0], -(double)direction[1], -(double)direction[2]};
    double brdf[3];
    if (point->material->kind == PM__DIFFUSE)
        return;
    pm__hit_point_brdf(point, in, brdf);
    for (int b = 0; b < 3; b++)
        flux[b] *= (float)brdf[b];
}

static void give(finder *f, const meeting *m, float distance2, double radius2)
{
    splatting *const s = f->of;
    const pm_photon *const photon = &s->set->photons[m->photon];
    pm__gifts *const list = &f->lists[m->point >> s->shift];
    if (list->count == list->capacity) {
        void *items = list->items;
        if (pm__grow(&items, &list->capacity, list->count + 1, sizeof *list->items)) {
            atomic_store(&s->failed, 1);
            return;
        }
        list->items = items;
    }
    pm__gift *const to = &list->items[list->count++];
    to->point = m->point;
    to->weight = s->kernel->weight(s->values, (double)distance2 / radius2);
    memcpy(to->flux, photon->power, sizeof to->flux);
    if (s->cover->uneven)
        by_brdf(s, m, photon->direction, to->flux);
}

/* What has been found, by the radii of now and the side that the photons came from. */
static void hand_over(finder *f)
{
    const splatting *const s = f->of;
    const bool front = s->run->of->front;
    for (size_t i = 0; i < f->count; i++) {
        const meeting *const m = &f->found[i];
        const pm__standing *const now = &s->cover->now[m->point];
        const pm_photon *const photon = &s->set->photons[m->photon];
        const float *const p = photon->position, *const w = photon->direction, *const n = now->normal;
        const float x = p[0] - now->position[0], y = p[1] - now->position[1], z = p[2] - now->position[2];
        const float distance2 = x * x + y * y + z * z;
        const double radius2 = (double)now->radius * (double)now->radius;
        if ((double)distance2 <= radius2 && radius2 > 0.0 &&
            !(front && !(w[0] * n[0] + w[1] * n[1] + w[2] * n[2] < 0.0f)))
            give(f, m, distance2, radius2);
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

static void find_group(finder *f, size_t first, size_t count)
{
    const pm__cover *const cover = f->of->cover;
    const pm_photon *const photons = f->of->set->photons;
    waiting group[GROUP];
    for (size_t i = 0; i < count; i++) {
        __builtin_prefetch(&photons[first + i + 3 * GROUP < f->of->set->count ? first + i + 3 * GROUP : first]);
        group[i].cell = pm__cover_cell(cover, photons[first + i].position, group[i].within);
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
        for (size_t e = group[i].from; e < group[i].to; e += PIECE)
            measure(f, &group[i], (uint32_t)(first + i), e, group[i].to - e < PIECE ? group[i].to : e + PIECE);
    for (; f->fetched < f->count; f->fetched++)
        __builtin_prefetch(&cover->now[f->found[f->fetched].point]);
    if (f->count >= WAITING)
        hand_over(f);
}

static void find_task(void *argument, size_t chunk)
{
    splatting *const s = argument;
    const size_t end = (chunk + 1) * CHUNK < s->set->count ? (chunk + 1) * CHUNK : s->set->count;
    finder f; /* not initialised as a whole: it is large */
    f.of = s;
    f.lists = s->lists + chunk * RUNS;
    f.count = f.fetched = 0;
    for (size_t i = chunk * CHUNK; i < end; i += GROUP)
        find_group(&f, i, end - i < GROUP ? end - i : GROUP);
    hand_over(&f);
}

/* ---- Points take what they are given ------------------------------------------------------------ */

static void take(const splatting *s, size_t i, const pm__brought *given)
{
    const pm__run *const run = s->run;
    const pm__progressive *const method = pm__progressive_of(run);
    const double radius = (double)s->cover->now[i].radius, area = 3.14159265358979323846 * (radius * radius);
    const double per = given->count && s->norm * area > 0.0 ? 1.0 / (s->norm * area) : 0.0;
    pm__found found = {.count = given->count, .area = area};
    for (int b = 0; b < 3; b++) {
        found.share[b] = s->cover->share[i][b];
        found.radiance[b] = found.share[b] * (given->flux[b] * per);
    }
    method->take(run, &found, run->state + i * method->fields);
}

/* In the order of the photons. */
static void add_up(const splatting *s, size_t index)
{
    for (size_t c = 0; c < s->chunks; c++) {
        const pm__gifts *const list = &s->lists[c * RUNS + index];
        for (size_t g = 0; g < list->count; g++) {
            const pm__gift *const gift = &list->items[g];
            __builtin_prefetch(&s->cover->brought[list->items[g + AHEAD < list->count ? g + AHEAD : g].point], 1);
            pm__brought *const to = &s->cover->brought[gift->point];
            for (int b = 0; b < 3; b++)
                to->flux[b] += gift->weight * (double)gift->flux[b];
            to->count++;
        }
    }
}

static void take_task(void *argument, size_t index)
{
    splatting *const s = argument;
    pm__cover *const cover = s->cover;
    const size_t first = index << s->shift, all = s->run->of->points;
    const size_t end = (index + 1) << s->shift < all ? (index + 1) << s->shift : all;
    memset(cover->brought + first, 0, (end - first) * sizeof *cover->brought);
    add_up(s, index);
    double area = 0.0;
    for (size_t i = first; i < end; i++) {
        float *const radius = &cover->now[i].radius;
        if (!(*radius > 0.0f))
            continue;
        take(s, i, &cover->brought[i]);
        *radius = pm__cover_radius(s->run, i);
        area += (double)*radius * (double)*radius;
    }
    s->areas[index] = area;
}

/* ---- A pass ------------------------------------------------------------------------------------ */

static bool open_lists(splatting *s)
{
    pm__cover *const cover = s->cover;
    s->chunks = (s->set->count + CHUNK - 1) / CHUNK;
    s->shift = 0;
    while ((s->run->of->points - 1) >> s->shift >= RUNS)
        s->shift++;
    if (s->chunks * RUNS > cover->gift_lists) {
        pm__gifts *const more = realloc(cover->gifts, s->chunks * RUNS * sizeof *more);
        if (!more)
            return false;
        memset(more + cover->gift_lists, 0, (s->chunks * RUNS - cover->gift_lists) * sizeof *more);
        cover->gifts = more;
        cover->gift_lists = s->chunks * RUNS;
    }
    s->lists = cover->gifts;
    for (size_t i = 0; i < s->chunks * RUNS; i++)
        s->lists[i].count = 0;
    return true;
}

/* Where radii have shrunk to half the area that is listed, half of what is measured is in vain. */
static pm_status renew(pm__run *run, pm_error *error)
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
    return status;
}

pm_status pm__run_splat(pm__run *run, const pm__photon_set *set, pm_error *error)
{
    const pm_parallel *const parallel = run->of->config->parallel;
    const pm__spec *const kernel = &run->of->config->estimator->spec;
    const pm_status status = renew(run, error);
    if (status != PM_OK)
        return status;
    const double start = pm__seconds();
    splatting s = {.run = run, .set = set, .cover = run->cover, .kernel = pm__estimator_of(kernel),
                   .values = kernel->values, .norm = pm__estimator_of(kernel)->norm(kernel->values, 2)};
    if (!open_lists(&s))
        atomic_store(&s.failed, 1);
    if (run->cover->listed)
        pm__for(parallel, atomic_load(&s.failed) ? 0 : s.chunks, find_task, &s);
    const size_t runs = ((run->of->points - 1) >> s.shift) + 1;
    if (!atomic_load(&s.failed)) /* nothing is taken unless all is there */
        pm__for(parallel, runs, take_task, &s);
    const bool failed = atomic_load(&s.failed);
    run->cover->area = 0.0;
    for (size_t i = 0; i < runs; i++)
        run->cover->area += s.areas[i];
    run->lookup_s += pm__seconds() - start;
    return failed ? pm__fail(error, PM_ENOMEM, "out of memory for the photons of a pass") : PM_OK;
}
