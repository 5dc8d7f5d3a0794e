/* estimate: irradiance at a user's points from a user's photons. */
#include "commands.h"
#include "estimate.h"
#include "interrupt.h"
#include "parallel.h"
#include "progress.h"
#include "results.h"

#include "../search/search.h"

#include "../base/clock.h"

#include <string.h>

enum { DEFAULT_K = 50 };

/* CSV is all but the last two. */
static const char *const fields[] = {"query", "e_r", "e_g", "e_b", "radius", "count", "status", "detail"};
enum { FIELD_COUNT = 8, PLAIN_COUNT = 6 };

/* The limit in effect as it was given, not as it is in single precision; 0: none. */
static double limit_of(const pm__estimate *e)
{
    if (e->radius > 0.0)
        return e->radius;
    return isfinite(e->lookup.max_radius) ? pm__decimal_of_float(e->lookup.max_radius) : 0.0;
}

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    const pm__estimate *const e = context;
    const pm_estimation *const estimation = &e->estimations[index];
    const bool ok = e->statuses[index] == PM_OK;
    cells[0] = pm__count_cell(index);
    for (size_t c = 0; c < 3 && ok; c++)
        cells[1 + c] = pm__number_cell(estimation->value[c]);
    const bool at_limit = (float)estimation->radius == e->lookup.max_radius;
    cells[4] = pm__number_cell(at_limit ? limit_of(e) : estimation->radius);
    cells[5] = pm__count_cell(estimation->count);
    cells[6] = pm__text_cell(ok ? "ok" : "degenerate");
    cells[7] = pm__text_cell(ok ? NULL : pm_status_text(e->statuses[index]));
}

static json_t *options_of(const pm__settings *s, const pm__estimate *e)
{
    char name[PM__MAX_SPEC], lookup[48];
    json_t *const options = json_object();
    const double radius = limit_of(e);
    pm__spec_format(e->spec, name, sizeof name);
    pm__lookup_format(&s->lookup, lookup);
    (void)json_object_set_new(options, "photons", json_string(s->photon_file));
    (void)json_object_set_new(options, "queries", json_string(s->query_file));
    (void)json_object_set_new(options, "estimator", json_string(name));
    (void)json_object_set_new(options, "k", e->lookup.k ? json_integer((json_int_t)e->lookup.k) : json_null());
    (void)json_object_set_new(options, "radius", radius > 0.0 ? json_real(radius) : json_null());
    (void)json_object_set_new(options, "search", json_string(s->search));
    (void)json_object_set_new(options, "lookup", json_string(lookup));
    (void)json_object_set_new(options, "front", json_string(s->lookup.front_only ? "on" : "off"));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)s->threads));
    return options;
}

static pm_status write_rows(const pm__settings *s, pm__estimate *e, double wall_s, pm__sinks *sinks, pm_error *error)
{
    json_t *const options = options_of(s, e);
    const pm__results results = {.command = "estimate",
                                 .options = options,
                                 .settings = s,
                                 .seeded = true,
                                 .wall_s = wall_s,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = PLAIN_COUNT,
                                 .row_count = e->point_count,
                                 .row = fill_row,
                                 .context = e};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}

static void count_missing(const pm__settings *s, const pm__estimate *e)
{
    size_t missing = 0;
    for (size_t i = 0; i < e->point_count; i++)
        missing += e->statuses[i] != PM_OK;
    if (missing && !s->quiet)
        pm__complain("estimate", "%zu of %zu queries have no estimate: %s", missing, e->point_count,
                     pm_status_text(PM_EDEGENERATE));
}

/* The screen form is CSV here, so -o names a CSV file. */
static pm_status fill_defaults(pm__settings *s, pm_error *error)
{
    if (!s->photon_file)
        return pm__fail(error, PM_EINVAL, "--photons FILE is needed");
    if (!s->query_file)
        return pm__fail(error, PM_EINVAL, "--queries FILE is needed");
    if (s->output && s->csv)
        return pm__fail(error, PM_EINVAL, "--csv and -o both ask for the rows as CSV: give one");
    if (s->output || (!s->csv && !s->json && !s->markdown))
        s->csv = s->output ? s->output : "-";
    s->output = NULL;
    if (!s->search)
        s->search = pm__searches.entries[0]->name;
    return s->estimators.count ? PM_OK : pm__spec_parse_list(&pm__estimators, "disc", &s->estimators.items,
                                                             &s->estimators.count, error);
}

static void configure(const pm__settings *s, const pm_parallel *parallel, pm__estimate *e)
{
    memset(e, 0, sizeof *e);
    e->spec = s->estimators.items;
    pm_query_init(&e->lookup);
    e->lookup.k = s->ks.count ? s->ks.items[0] : s->radius > 0.0 ? 0 : DEFAULT_K;
    e->radius = s->radius;
    e->lookup.max_radius = s->radius > 0.0 ? (float)s->radius : INFINITY;
    e->lookup.shape = s->lookup.shape;
    e->lookup.shape_parameter = (float)s->lookup.parameter;
    e->lookup.front_only = s->lookup.front_only;
    e->lookup.search = pm_search_find(s->search);
    e->auto_threshold = s->auto_threshold;
    e->seed = s->seed;
    e->parallel = parallel;
    e->threads = s->threads;
    e->memory = pm__free_memory();
    e->canceled = pm__interrupted;
}

/* Everything after the inputs are there: maps, estimates, rows. */
static pm_status work(const pm__settings *s, pm__estimate *e, double start, pm_error *error)
{
    pm__sinks sinks;
    pm__interrupt_watch(); /* reading, which asks nothing, a signal may end at once */
    pm_status status = pm__sinks_open(s, false, &sinks, error);
    if (status != PM_OK)
        return status;
    status = pm__estimate_build(e, error);
    if (status == PM_OK)
        status = pm__estimate_run(e, error);
    if (status == PM_OK)
        status = write_rows(s, e, pm__seconds() - start, &sinks, error);
    else
        pm__sinks_discard(&sinks);
    return status;
}

static int run(pm__settings *settings)
{
    pm_error error = {""};
    pm__estimate estimate;
    const double start = pm__seconds();
    const pm_parallel parallel = pm__parallel_for(&settings->threads);
    pm_status status = fill_defaults(settings, &error);
    int exit_status = pm__exit_status(status);
    if (status == PM_OK) {
        configure(settings, &parallel, &estimate);
        status = pm__estimate_check(&estimate, &error);
        exit_status = pm__exit_status(status);
        if (status == PM_OK) {
            status = pm__estimate_load(&estimate, settings->photon_file, settings->query_file, &error);
            exit_status = pm__exit_status_of_input(status);
        }
        if (status == PM_OK) {
            status = work(settings, &estimate, start, &error);
            exit_status = status == PM_ENONFINITE ? PM__EXIT_INPUT : pm__exit_status(status);
        }
        if (status == PM_OK)
            count_missing(settings, &estimate);
        pm__estimate_free(&estimate);
    }
    if (status == PM_ECANCELED)
        pm__complain("estimate", "interrupted: nothing was written");
    else if (status != PM_OK)
        pm__complain("estimate", "%s", *error.text ? error.text : pm_status_text(status));
    return exit_status;
}

static const pm__option *const options_taken[] = {
    &pm__option_photon_file, &pm__option_query_file, &pm__option_one_estimator, &pm__option_one_k,
    &pm__option_radius,      &pm__option_search,     &pm__option_lookup,        &pm__option_front,
    &pm__option_seed,        &pm__option_threads,    &pm__option_json,          &pm__option_csv,
    &pm__option_markdown,    &pm__option_output,     &pm__option_quiet};

const pm__command pm__command_estimate = {
    .name = "estimate",
    .operands = "",
    .job = "irradiance (W/m2) at your query points from your photons; CSV unless told otherwise",
    .text = "Both files are PLY, ascii or binary little-endian, element vertex. One row a query, in input order\n"
            "from 0: query,e_r,e_g,e_b,radius,count (JSON also says why an estimate does not exist). With fewer\n"
            "than k photons in the map all are used, and count says how many; with none the estimate is 0.\n\n"
            "Examples:\n"
            "  photonbench estimate --photons p.ply --queries q.ply --estimator cone:k=1.1 --k 50 --csv -\n"
            "  photonbench estimate --photons p.ply --queries q.ply --radius 0.1 -o irradiance.csv\n"
            "  photonbench estimate --photons p.ply --queries q.ply --radius auto --lookup ellipsoid:3 --json -\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
