/* The rows of `render` as data, and as lines of the screen. */
#include "render_task.h"
#include "wrap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define FIELDS(X)                                                               \
    X(scene, text(from->scene))                                                 \
    X(method, text(from->method))                                               \
    X(estimator, row->estimator ? text(from->estimator) : absent)               \
    X(k, row->estimator && config->k ? pm__count_cell(config->k) : absent)      \
    X(radius, row->estimator ? number(config->radius) : absent)                 \
    X(photons, pm__count_cell(config->photons))                                 \
    X(emitted, pm__count_cell((size_t)row->emitted))                            \
    X(stored, pm__count_cell(row->stored))                                      \
    X(width, pm__count_cell(config->width))                                     \
    X(height, pm__count_cell(config->height))                                   \
    X(spp, pm__count_cell(row->passes))                                         \
    X(trials, pm__count_cell(row->trials))                                      \
    X(truth, text(row->truth))                                                  \
    X(rel_error_mean, number(row->mean_error))                                  \
    X(rel_error_rms, number(row->rms_error))                                    \
    X(trace_s, number(row->trace_s))                                            \
    X(build_s, number(row->build_s))                                            \
    X(image_s, number(row->image_s))                                            \
    X(total_s, number(row->total_s))                                            \
    X(file, text(row->file))                                                    \
    X(status, text(row->status))                                                \
    X(detail, text(*row->detail ? row->detail : NULL))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

typedef struct source {
    const pm__render_task *task;
    const pm__render_row *rows;
    char scene[PM__MAX_SPEC], method[PM__MAX_SPEC], estimator[PM__MAX_SPEC];
} source;

static pm__cell text(const char *value)
{
    return pm__text_cell(value);
}

static pm__cell number(double value)
{
    return pm__number_cell(value);
}

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const pm__render_row *const row = &from->rows[index];
    const pm__render_config *const config = &from->task->config;
    const pm__cell absent = {.type = PM__ABSENT};
    pm__spec_format(row->scene, from->scene, PM__MAX_SPEC);
    pm__spec_format(config->method, from->method, PM__MAX_SPEC);
    if (row->estimator)
        pm__spec_format(row->estimator, from->estimator, PM__MAX_SPEC);
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

static json_t *triple(bool given, const double v[3])
{
    return given ? json_pack("[f, f, f]", v[0], v[1], v[2]) : json_null();
}

/* Of the camera, what was given; degrees. */
static json_t *view_of(const pm__render_options *r)
{
    static const double pi = 3.14159265358979323846;
    return json_pack("{s:o, s:o, s:o, s:o}", "eye", triple(r->eye, r->view.eye), "look", triple(r->at, r->view.at),
                     "up", triple(r->up, r->view.up), "angle",
                     r->angle ? json_real(r->view.angle / pi * 180.0) : json_null());
}

static json_t *count_or_null(size_t count)
{
    return count ? json_integer((json_int_t)count) : json_null();
}

json_t *pm__render_options_tree(const pm__render_task *task)
{
    const pm__settings *const s = task->settings;
    const pm__render_config *const c = &task->config;
    char lookup[48], size[48];
    json_t *const options = json_object(), *const method = pm__spec_names(c->method, 1);
    pm__lookup_format(&c->lookup, lookup);
    (void)snprintf(size, sizeof size, "%zux%zu", c->width, c->height);
    (void)json_object_set_new(options, "scene", pm__spec_names(task->scenes, task->scene_count));
    (void)json_object_set(options, "method", json_array_get(method, 0));
    (void)json_object_set_new(options, "estimator",
                              pm__spec_names(task->estimators, task->estimates ? task->estimator_count : 0));
    (void)json_object_set_new(options, "k", count_or_null(c->k));
    (void)json_object_set_new(options, "radius", isfinite(c->radius) ? json_real(c->radius) : json_null());
    (void)json_object_set_new(options, "photons", json_integer((json_int_t)c->photons));
    (void)json_object_set_new(options, "size", json_string(size));
    (void)json_object_set_new(options, "spp", count_or_null(c->spp));
    (void)json_object_set_new(options, "seconds", c->seconds > 0.0 ? json_real(c->seconds) : json_null());
    (void)json_object_set_new(options, "trials", json_integer((json_int_t)c->trials));
    (void)json_object_set_new(options, "sampler", pm__spec_names(s->samplers.items, s->samplers.count));
    (void)json_object_set_new(options, "search", json_string(task->search));
    (void)json_object_set_new(options, "lookup", json_string(lookup));
    (void)json_object_set_new(options, "front", json_string(c->lookup.front_only ? "on" : "off"));
    (void)json_object_set_new(options, "aov", json_boolean(c->aov));
    (void)json_object_set_new(options, "no_skip", json_boolean(c->no_skip));
    (void)json_object_set_new(options, "view", view_of(&s->render));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)s->threads));
    json_decref(method);
    return options;
}

/* Only --aov asks for a truth. */
static void print_error(FILE *file, const pm__render_config *config, const pm__render_row *row)
{
    if (row->truth && isfinite(row->mean_error) && isfinite(row->rms_error))
        (void)fprintf(file, "; error %+.3g %%, rms %.3g %% (%s)", 100.0 * row->mean_error, 100.0 * row->rms_error,
                      strcmp(row->truth, "exact") == 0 ? "exact truth" : row->truth);
    else if (config->aov)
        (void)fputs("; no truth known", file);
}

void pm__render_print(FILE *file, const pm__render_task *task, const pm__render_row *row)
{
    const pm__render_config *const c = &task->config;
    char *line = NULL;
    size_t size = 0;
    FILE *const memory = open_memstream(&line, &size);
    if (!memory)
        return;
    (void)fprintf(memory, "%s: %zux%zu, %zu %s%s; ", row->file ? row->file : "(no file)", c->width, c->height,
                  row->passes, row->passes == 1 ? "sample" : "samples",
                  strcmp(row->status, "interrupted") == 0 ? " (interrupted)" : "");
    if (row->emitted)
        (void)fprintf(memory, "%llu photons emitted, %zu stored; ", (unsigned long long)row->emitted, row->stored);
    (void)fprintf(memory, "trace %.3g s, build %.3g s, image %.3g s", row->trace_s, row->build_s, row->image_s);
    print_error(memory, c, row);
    if (fclose(memory) == 0)
        pm__wrap(file, line, 0, 4);
    (void)fflush(file);
    free(line);
}

pm_status pm__render_write(const pm__render_task *task, const pm__render_row *rows, size_t count, double wall_s,
                           bool interrupted, pm__sinks *sinks, pm_error *error)
{
    source from = {.task = task, .rows = rows};
    json_t *const options = pm__render_options_tree(task);
    const pm__results results = {.command = "render",
                                 .options = options,
                                 .settings = task->settings,
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
