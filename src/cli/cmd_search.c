/* search: build and query time of the searches and of peer libraries, checked against brute force. */
#include "commands.h"
#include "interrupt.h"
#include "parallel.h"
#include "progress.h"
#include "search_options.h"
#include "search_rows.h"

#include "../map/ply_reader.h"

#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>

enum { BRUTE_LIMIT = 100000 };
static const double default_seconds = 50.0;

/* All that the config points at. */
typedef struct plan {
    pm__search_config config;
    pm__contender *contenders;
    pm__shape filters[2 * PM__MAX_SHAPES];
    pm_photon *photons; /* of a file */
    float (*normals)[3];
    pm__progress progress;
} plan;

static pm_status take_contenders(plan *p, const pm__settings *s, pm_error *error)
{
    const size_t count = s->searches.count ? s->searches.count : pm__contender_count();
    p->contenders = calloc(count, sizeof *p->contenders);
    if (!p->contenders)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (size_t i = 0; i < count; i++)
        p->contenders[i] = pm__contender_at(s->searches.count ? s->searches.items[i] : i);
    p->config.contenders = p->contenders;
    p->config.contender_count = count;
    p->config.brute_limit = s->searches.count ? SIZE_MAX : BRUTE_LIMIT;
    return PM_OK;
}

/* Every shape without the front-side filter, with it, or both. */
static void take_filters(plan *p, const pm__settings *s)
{
    const pm__shape sphere = {PM_LOOKUP_SPHERE, 0.0, false};
    const bool off = s->front_off || !s->front_on;
    for (size_t i = 0; i < (s->shape_count ? s->shape_count : 1); i++) {
        pm__shape shape = s->shape_count ? s->shapes[i] : sphere;
        if (off)
            p->filters[p->config.filter_count++] = shape;
        shape.front_only = true;
        if (s->front_on)
            p->filters[p->config.filter_count++] = shape;
    }
    p->config.filters = p->filters;
}

static pm_status take_defaults(pm__settings *s, pm_error *error)
{
    pm_status status = PM_OK;
    if (!s->cases.count && !s->photon_file)
        status = pm__search_option_case.set(s, "box", error);
    if (status == PM_OK && !s->photons.count)
        status = pm__search_option_photons.set(s, "1000000", error);
    if (status == PM_OK && !s->ks.count && !(s->radius > 0.0) && !s->radius_hits)
        status = pm__search_option_k.set(s, "50", error);
    if (!s->order_random && !s->order_coherent)
        s->order_coherent = true;
    return status;
}

static pm_status refuse_conflicts(const pm__settings *s, pm_error *error)
{
    if (s->photon_file && s->cases.count)
        return pm__fail(error, PM_EINVAL, "--input and --case exclude each other");
    if (s->photon_file && s->photons.count)
        return pm__fail(error, PM_EINVAL, "--input says how many photons there are: --photons is for cases");
    return PM_OK;
}

static void show_progress(void *context, double fraction, const char *what)
{
    pm__progress_update(&((plan *)context)->progress, fraction, what);
}

static bool is_canceled(void *context)
{
    (void)context;
    return pm__interrupted();
}

static void configure(plan *p, const pm__settings *s, const pm_parallel *parallel)
{
    pm__search_config *const c = &p->config;
    c->cases = s->cases.items;
    c->case_count = s->cases.count;
    c->photons = s->photons.items;
    c->photon_count = s->photons.count;
    c->ks = s->ks.items;
    c->k_count = s->ks.count;
    c->radius = s->radius;
    c->radius_hits = s->radius_hits;
    c->coherent = s->order_coherent;
    c->random = s->order_random;
    c->samples = s->samples;
    c->seconds = s->seconds > 0.0 ? s->seconds : default_seconds;
    c->memory = pm__free_memory();
    c->threads = s->threads;
    c->seed = s->seed;
    c->parallel = parallel;
    c->progress = show_progress;
    c->canceled = is_canceled;
    c->context = p;
}

static pm_status read_input(plan *p, const pm__settings *s, pm_error *error)
{
    if (!s->photon_file)
        return PM_OK;
    const pm__ply_budget budget = {.memory = pm__free_memory(), .per_vertex = sizeof(float[3]) + 2 * PM__INDEX_BYTES};
    p->config.given_name = s->photon_file;
    const pm_status status =
        pm__ply_read_photons(s->photon_file, &budget, &p->photons, &p->normals, &p->config.given_count, error);
    p->config.given = p->photons;
    p->config.given_normals = (const float (*)[3])p->normals;
    return status;
}

static bool all_held(const pm__search_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (strcmp(rows[i].status, "ok") != 0)
            return false;
    return true;
}

/* A combination that a search cannot do has no row, which must not pass for a result. */
static void say_why_empty(const pm__settings *s, size_t count)
{
    if (!count && !s->quiet)
        pm__complain("search", "no rows: none of the searches asked for can do any of this ('grid' needs --radius, "
                               "peers know plain spheres only)");
}

/* Runs and writes what came out. Interrupted: the runs that were complete. */
static pm_status measure(plan *p, const pm__settings *s, pm__sinks *sinks, bool *held, pm_error *error)
{
    pm__search_row *rows = NULL;
    size_t count = 0;
    const double start = pm__seconds();
    pm__progress_start(&p->progress, s->quiet);
    pm_status status = pm__search_run(&p->config, &rows, &count, error);
    pm__progress_end(&p->progress);
    if (status == PM_OK || status == PM_ECANCELED) {
        *held = all_held(rows, count);
        if (pm__sinks_screen(sinks))
            pm__search_print(pm__sinks_screen(sinks), rows, count);
        const pm_status written = pm__search_write(s, &p->config, rows, count, pm__seconds() - start,
                                                   status == PM_ECANCELED, sinks, error);
        if (status == PM_OK)
            say_why_empty(s, count);
        status = written ? written : status;
    } else {
        pm__sinks_discard(sinks);
    }
    pm__search_free(rows, count);
    return status;
}

static int finish(const pm__settings *s, pm_status status, bool held, const pm_error *error)
{
    return pm__conclude("search", status, s->quiet, "only the runs that were complete are there",
                        held ? NULL : "not every row is exact: see status and detail", error);
}

static int run(pm__settings *s)
{
    pm_error error = {""};
    pm__sinks sinks;
    bool held = true;
    plan p = {.photons = NULL};
    const pm_parallel parallel = pm__parallel_for(&s->threads);
    pm_status status = refuse_conflicts(s, &error);
    if (status == PM_OK)
        status = take_defaults(s, &error);
    if (status == PM_OK)
        status = take_contenders(&p, s, &error);
    take_filters(&p, s);
    configure(&p, s, &parallel);
    if (status == PM_OK) {
        const pm_status read = read_input(&p, s, &error);
        if (read != PM_OK) {
            (void)finish(s, read, true, &error);
            free(p.contenders);
            return pm__exit_status_of_input(read);
        }
    }
    pm__interrupt_watch();
    if (status == PM_OK)
        status = pm__sinks_open(s, true, &sinks, &error);
    if (status == PM_OK)
        status = measure(&p, s, &sinks, &held, &error);
    pm_free(p.photons);
    pm_free(p.normals);
    free(p.contenders);
    return finish(s, status, held, &error);
}

static const pm__option *const options_taken[] = {
    &pm__search_option_case,    &pm__search_option_input,   &pm__search_option_photons, &pm__search_option_k,
    &pm__search_option_radius,  &pm__search_option_order,   &pm__search_option_search,  &pm__search_option_lookup,
    &pm__search_option_front,   &pm__search_option_samples, &pm__search_option_seconds, &pm__search_option_threads,
    &pm__option_seed,           &pm__option_json,           &pm__option_csv,            &pm__option_markdown,
    &pm__option_output,         &pm__option_quiet};

const pm__command pm__command_search = {
    .name = "search",
    .operands = "",
    .job = "build and query time of the searches and of peer libraries, checked against brute force",
    .text = "All searches get the same photons and the same queries, which are drawn as the photons are. They\n"
            "take turns, in random order, in rounds; ratios are taken within rounds, and their intervals hold\n"
            "for all of a run together. The baseline is 'recursive', or the first where that is not asked for.\n"
            "Exit status 1: a search found other photons than brute force does.\n\n"
            "Examples:\n"
            "  photonbench search\n"
            "  photonbench search --case box,square,caustic,volume --k 8,50,500 --search all --json search.json\n"
            "  photonbench search --search recursive,iterative --order random,coherent\n"
            "  photonbench search --radius auto:50 --search wide,grid,recursive --front on,off\n"
            "  photonbench search --photons 10000,100000,1000000,10000000 --threads 1\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
