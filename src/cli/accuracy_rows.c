#include "accuracy_rows.h"

#include <string.h>

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define FIELDS(X)                                                     \
    X(case, pm__text_cell(case_name))                                 \
    X(region, pm__text_cell(row->region))                             \
    X(paths, pm__text_cell(row->paths))                               \
    X(estimator, pm__text_cell(estimator_name))                       \
    X(kind, pm__text_cell(row->knn ? "knn" : "radius"))               \
    X(k, row->knn ? pm__count_cell(row->k) : absent)                  \
    X(radius, pm__number_cell(row->radius))                           \
    X(lookup, pm__text_cell(lookup_name))                             \
    X(front, pm__text_cell(config->lookup.front_only ? "on" : "off")) \
    X(photons, pm__count_cell(row->photons))                          \
    X(sampler, pm__text_cell(sampler_name))                           \
    X(search, pm__text_cell(row->search))                             \
    X(trials, pm__count_cell(row->trials))                            \
    X(probes, pm__count_cell(row->probes))                            \
    X(truth_mean, pm__number_cell(row->truth_mean))                   \
    X(rel_bias, pm__number_cell(row->rel_bias))                       \
    X(rel_bias_ci95, pm__interval_cell(row->rel_bias_ci95))           \
    X(rms_bias, pm__number_cell(row->rms_bias))                       \
    X(rms_bias_ci95, pm__interval_cell(row->rms_bias_ci95))           \
    X(rel_noise, pm__number_cell(row->rel_noise))                     \
    X(rel_noise_ci95, pm__interval_cell(row->rel_noise_ci95))         \
    X(rel_rmse, pm__number_cell(row->rel_rmse))                       \
    X(rel_rmse_ci95, pm__interval_cell(row->rel_rmse_ci95))           \
    X(predicted_rel_bias, pm__number_cell(row->predicted_rel_bias))   \
    X(predicted_rel_noise, pm__number_cell(row->predicted_rel_noise)) \
    X(ns_per_query, pm__number_cell(row->ns_per_query))               \
    X(ns_per_query_ci95, pm__interval_cell(row->ns_per_query_ci95))   \
    X(cost_s, pm__number_cell(row->cost_s))                           \
    X(efficiency, pm__number_cell(row->efficiency))                   \
    X(pareto, pm__flag_cell(row->pareto))                             \
    X(status, pm__text_cell(row->status))                             \
    X(detail, pm__text_cell(*row->detail ? row->detail : NULL))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

typedef struct source {
    const pm__accuracy_config *config;
    const pm__accuracy_row *rows;
    char case_name[PM__MAX_SPEC], estimator_name[PM__MAX_SPEC], sampler_name[PM__MAX_SPEC];
    char lookup_name[48];
} source;

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const pm__accuracy_row *const row = &from->rows[index];
    const pm__accuracy_config *const config = from->config;
    char *const case_name = from->case_name, *const estimator_name = from->estimator_name;
    char *const sampler_name = from->sampler_name, *const lookup_name = from->lookup_name;
    const pm__cell absent = {.type = PM__ABSENT};
    pm__spec_format(row->case_spec, case_name, PM__MAX_SPEC);
    pm__spec_format(row->estimator_spec, estimator_name, PM__MAX_SPEC);
    pm__spec_format(row->sampler_spec, sampler_name, PM__MAX_SPEC);
    pm__lookup_format(&config->lookup, lookup_name);
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

/* A number, "auto:0.05" or null. */
static json_t *radius_option(const pm__accuracy_config *config)
{
    char text_form[48] = "auto:", threshold[32];
    if (!(config->auto_threshold > 0.0))
        return config->radius > 0.0 ? json_real(config->radius) : json_null();
    pm__format_double(config->auto_threshold, threshold);
    return json_string(strcat(text_form, threshold));
}

/* Everything that is needed to run the same again. */
static json_t *options_of(const pm__settings *s, const pm__accuracy_config *config)
{
    char lookup[48];
    json_t *const options = json_object();
    pm__lookup_format(&config->lookup, lookup);
    (void)json_object_set_new(options, "case", pm__spec_names(config->cases, config->case_count));
    (void)json_object_set_new(options, "estimator", pm__spec_names(config->estimators, config->estimator_count));
    (void)json_object_set_new(options, "k", pm__number_list(config->ks, config->k_count));
    (void)json_object_set_new(options, "radius", radius_option(config));
    (void)json_object_set_new(options, "photons", pm__number_list(config->photons, config->photon_count));
    (void)json_object_set_new(options, "sampler", pm__spec_names(config->samplers, config->sampler_count));
    (void)json_object_set_new(options, "trials", json_integer((json_int_t)config->trials));
    (void)json_object_set_new(options, "probes", json_integer((json_int_t)config->probes_all));
    (void)json_object_set_new(options, "search", json_string(config->search));
    (void)json_object_set_new(options, "lookup", json_string(lookup));
    (void)json_object_set_new(options, "front", json_string(config->lookup.front_only ? "on" : "off"));
    (void)json_object_set_new(options, "profile", json_string(s->full ? "full" : "quick"));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)s->threads));
    return options;
}

pm_status pm__accuracy_write(const pm__settings *settings, const pm__accuracy_config *config,
                             const pm__accuracy_row *rows, size_t count, double wall_s, bool interrupted,
                             pm__sinks *sinks, pm_error *error)
{
    source from = {.config = config, .rows = rows};
    json_t *const options = options_of(settings, config);
    const pm__results results = {.command = "accuracy",
                                 .options = options,
                                 .settings = settings,
                                 .seeded = true,
                                 .wall_s = wall_s,
                                 .interrupted = interrupted,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT,
                                 .row_count = count,
                                 .row = fill_row,
                                 .context = &from};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}
