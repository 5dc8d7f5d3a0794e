#include "search_rows.h"

#include <math.h>
#include <string.h>

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define FIELDS(X)                                                     \
    X(search, pm__text_cell(pm__contender_name(&row->contender)))     \
    X(case, pm__text_cell(row->case_name))                            \
    X(photons, pm__count_cell(row->photons))                          \
    X(kind, pm__text_cell(row->k ? "knn" : "radius"))                 \
    X(k, row->k ? pm__count_cell(row->k) : absent)                    \
    X(radius, pm__number_cell(row->radius))                           \
    X(batch, pm__count_cell(row->batch))                              \
    X(order, pm__text_cell(row->coherent ? "coherent" : "random"))    \
    X(threads, pm__count_cell(row->threads))                          \
    X(build_ms, pm__number_cell(row->build_ms))                       \
    X(build_ms_ci95, pm__interval_cell(row->build_ms_ci95))           \
    X(ns_per_query, pm__number_cell(row->ns))                         \
    X(ns_per_query_ci95, pm__interval_cell(row->ns_ci95))             \
    X(ns_per_query_min, pm__number_cell(row->ns_min))                 \
    X(samples, pm__count_cell(row->samples))                          \
    X(baseline, pm__text_cell(row->baseline))                         \
    X(ratio, pm__number_cell(row->ratio))                             \
    X(ratio_ci95, pm__interval_cell(row->ratio_ci95))                 \
    X(bytes_per_photon, pm__number_cell(row->bytes_per_photon))       \
    X(exact, pm__flag_cell(row->exact))                               \
    X(status, pm__text_cell(row->status))                             \
    X(detail, pm__text_cell(*row->detail ? row->detail : NULL))       \
    X(lookup, pm__text_cell(lookup))                                  \
    X(front, pm__text_cell(row->filter.front_only ? "on" : "off"))    \
    X(count, pm__number_cell(row->count))                             \
    X(outliers, pm__count_cell(row->outliers))                        \
    X(cycles, pm__number_cell(row->cycles))                           \
    X(instructions, pm__number_cell(row->instructions))               \
    X(aa_ratio, pm__number_cell(row->aa_ratio))                       \
    X(aa_ratio_ci95, pm__interval_cell(row->aa_ci95))                 \
    X(aa_false_alarm_rate, pm__number_cell(row->aa_false_alarm_rate)) \
    X(noise, pm__number_cell(row->noise))                             \
    X(warning, pm__text_cell(row->warning))                           \
    X(ratio_samples, samples(row))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

typedef struct source {
    const pm__search_row *rows;
    char lookup[48];
} source;

static pm__cell samples(const pm__search_row *row)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < row->samples && row->ratio_samples; i++)
        (void)json_array_append_new(list,
                                    isfinite(row->ratio_samples[i]) ? json_real(row->ratio_samples[i]) : json_null());
    return (pm__cell){.type = PM__TREE, .tree = list};
}

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const pm__search_row *const row = &from->rows[index];
    const pm__cell absent = {.type = PM__ABSENT};
    char *const lookup = from->lookup;
    pm__lookup_format(&row->filter, lookup);
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

static json_t *names_of_cases(const pm__search_config *config)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < config->case_count && !config->given_name; i++)
        (void)json_array_append_new(list, json_string(config->cases[i].entry->name));
    return list;
}

static json_t *names_of_contenders(const pm__search_config *config)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < config->contender_count; i++)
        (void)json_array_append_new(list, json_string(pm__contender_name(&config->contenders[i])));
    return list;
}

/* A number, "auto:50" or null. */
static json_t *radius_option(const pm__search_config *config)
{
    char automatic[48];
    (void)snprintf(automatic, sizeof automatic, "auto:%zu", config->radius_hits);
    return config->radius_hits    ? json_string(automatic)
           : config->radius > 0.0 ? json_real(config->radius)
                                  : json_null();
}

static json_t *filter_names(const pm__search_config *config)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < config->filter_count; i++) {
        char lookup[48];
        pm__lookup_format(&config->filters[i], lookup);
        (void)json_array_append_new(
            list, json_pack("{s:s, s:s}", "lookup", lookup, "front", config->filters[i].front_only ? "on" : "off"));
    }
    return list;
}

static json_t *order_names(const pm__search_config *config)
{
    json_t *const list = json_array();
    if (config->coherent)
        (void)json_array_append_new(list, json_string("coherent"));
    if (config->random)
        (void)json_array_append_new(list, json_string("random"));
    return list;
}

/* Everything that is needed to run the same again. */
static json_t *options_of(const pm__search_config *config)
{
    json_t *const options = json_object();
    (void)json_object_set_new(options, "case", names_of_cases(config));
    (void)json_object_set_new(options, "input", config->given_name ? json_string(config->given_name) : json_null());
    (void)json_object_set_new(options, "photons",
                              pm__number_list(config->photons, config->given_name ? 0 : config->photon_count));
    (void)json_object_set_new(options, "k", pm__number_list(config->ks, config->k_count));
    (void)json_object_set_new(options, "radius", radius_option(config));
    (void)json_object_set_new(options, "order", order_names(config));
    (void)json_object_set_new(options, "filters", filter_names(config));
    (void)json_object_set_new(options, "search", names_of_contenders(config));
    (void)json_object_set_new(options, "samples",
                              config->samples ? json_integer((json_int_t)config->samples) : json_null());
    (void)json_object_set_new(options, "seconds", json_real(config->seconds));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)config->threads));
    return options;
}

pm_status pm__search_write(const pm__settings *settings, const pm__search_config *config, const pm__search_row *rows,
                           size_t count, double wall_s, bool interrupted, pm__sinks *sinks, pm_error *error)
{
    source from = {.rows = rows};
    json_t *const options = options_of(config);
    const pm__results results = {.command = "search",
                                 .options = options,
                                 .settings = settings,
                                 .seeded = true,
                                 .wall_s = wall_s,
                                 .interrupted = interrupted,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT - 1, /* samples are for JSON */
                                 .row_count = count,
                                 .row = fill_row,
                                 .context = &from};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}
