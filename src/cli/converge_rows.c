/* The rows of `converge` as data, its fits and watched points. */
#include "converge_task.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const pm__converge_quantity_names[PM__QUANTITIES] = {
    [PM__VARIANCE] = "variance", [PM__BIAS] = "bias", [PM__RMSE] = "rmse"};

/* What tells series apart, in rows of each kind. */
#define SERIES_FIELDS(X, Y)                      \
    X(scene, pm__text_cell(from->scene))         \
    Y                                            \
    X(method, pm__text_cell(from->method))       \
    X(estimator, pm__text_cell(from->estimator)) \
    X(alpha, pm__number_cell(item->alpha))

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define ROW_FIELDS(X)                                                         \
    SERIES_FIELDS(X, X(paths, pm__text_cell(series->paths)))                  \
    X(pass, pm__positive_cell(row->pass))                                     \
    X(photons, pm__positive_cell(row->photons))                               \
    X(seconds, pm__number_cell(row->seconds))                                 \
    X(rel_bias, pm__number_cell(row->rel_bias))                               \
    X(rel_noise, pm__number_cell(row->rel_noise))                             \
    X(rel_rmse, pm__number_cell(row->rel_rmse))                               \
    X(rel_rmse_ci95, pm__interval_cell(row->rel_rmse_ci95))                   \
    X(points, pm__positive_cell(series->points))                              \
    X(trials, pm__positive_cell(series->trials))                              \
    X(truth, pm__text_cell(series->truth))                                    \
    X(truth_mean, pm__number_cell(series->truth_mean))                        \
    X(rel_bias_ci95, pm__interval_cell(row->rel_bias_ci95))                   \
    X(rms_bias, pm__number_cell(row->rms_bias))                               \
    X(rms_bias_ci95, pm__interval_cell(row->rms_bias_ci95))                   \
    X(rel_noise_ci95, pm__interval_cell(row->rel_noise_ci95))                 \
    X(predicted_rel_bias, pm__number_cell(row->predicted_rel_bias))           \
    X(predicted_rms_bias, pm__number_cell(row->predicted_rms_bias))           \
    X(predicted_rel_noise, pm__number_cell(row->predicted_rel_noise))         \
    X(estimated_rel_rmse, pm__number_cell(row->estimated_rel_rmse))           \
    X(estimated_rel_rmse_mean, pm__number_cell(row->estimated_rel_rmse_mean)) \
    X(estimate_right, pm__number_cell(row->estimate_right))                   \
    X(status, pm__text_cell(item->status))                                    \
    X(detail, pm__text_cell(*item->detail ? item->detail : NULL))

#define FIT_FIELDS(X)                                                      \
    SERIES_FIELDS(X, )                                                     \
    X(quantity, pm__text_cell(pm__converge_quantity_names[fit->quantity])) \
    X(first_pass, pm__positive_cell(fit->fits ? fit->first_pass : 0))      \
    X(last_pass, pm__positive_cell(fit->fits ? fit->last_pass : 0))        \
    X(slope, pm__number_cell(fit->fits ? fit->slope : (double)NAN))        \
    X(slope_ci95, pm__interval_cell(fit->fits ? fit->slope_ci95 : none))   \
    X(predicted, pm__number_cell(fit->predicted))                          \
    X(asymptote, pm__number_cell(fit->asymptote))                          \
    X(status, pm__text_cell(fit->fits ? "ok" : "unfit"))                   \
    X(detail, pm__text_cell(*fit->detail ? fit->detail : NULL))

#define POINT_FIELDS(X)                                                           \
    SERIES_FIELDS(X, )                                                            \
    X(x, pm__count_cell(point->point % item->series.width))                       \
    X(y, pm__count_cell(point->point / item->series.width))                       \
    X(pass, pm__positive_cell(point->pass))                                       \
    X(radius, pm__number_cell(point->radius > 0.0 ? point->radius : (double)NAN)) \
    X(count, pm__number_cell(point->count))                                       \
    X(radiance, triple(point->radiance))                                          \
    X(truth, triple(point->truth))

#define X(name, value) #name,
static const char *const row_fields[] = {ROW_FIELDS(X)};
static const char *const fit_fields[] = {FIT_FIELDS(X)};
static const char *const point_fields[] = {POINT_FIELDS(X)};
#undef X

enum {
    ROW_COUNT = sizeof row_fields / sizeof *row_fields,
    FIT_COUNT = sizeof fit_fields / sizeof *fit_fields,
    POINT_COUNT = sizeof point_fields / sizeof *point_fields
};

/* Row `index` of one kind is number `at` of a series. */
typedef struct place {
    const pm__converge_item *item;
    size_t at;
} place;

typedef struct source {
    const pm__converge_task *task;
    place *rows, *fits, *points;
    size_t row_count, fit_count, point_count;
    char scene[PM__MAX_SPEC], method[PM__MAX_SPEC], estimator_name[PM__MAX_SPEC];
    const char *estimator;
} source;

static const pm__interval none = {(double)NAN, (double)NAN};

/* None of what is counted here is ever 0 where it exists. */
static json_t *number_or_null(double value)
{
    return isfinite(value) ? json_real(value) : json_null();
}

static pm__cell triple(const double v[3])
{
    return (pm__cell){.type = PM__TREE,
                      .tree = json_pack("[o, o, o]", number_or_null(v[0]), number_or_null(v[1]), number_or_null(v[2]))};
}

static const pm__converge_item *take(source *from, const place *p)
{
    const pm__converge_item *const item = p->item;
    pm__spec_format(item->scene, from->scene, sizeof from->scene);
    pm__spec_format(item->method, from->method, sizeof from->method);
    from->estimator = item->estimator ? from->estimator_name : NULL;
    if (item->estimator)
        pm__spec_format(item->estimator, from->estimator_name, sizeof from->estimator_name);
    return item;
}

/* Of a series without rows: why. */
static const pm__converge_row no_row = {
    .seconds = (double)NAN, .rel_bias = (double)NAN, .rms_bias = (double)NAN, .rel_noise = (double)NAN,
    .rel_rmse = (double)NAN, .rel_bias_ci95 = {(double)NAN, (double)NAN}, .rms_bias_ci95 = {(double)NAN, (double)NAN},
    .rel_noise_ci95 = {(double)NAN, (double)NAN}, .rel_rmse_ci95 = {(double)NAN, (double)NAN},
    .predicted_rel_bias = (double)NAN, .predicted_rms_bias = (double)NAN, .predicted_rel_noise = (double)NAN,
    .estimated_rel_rmse = (double)NAN, .estimated_rel_rmse_mean = (double)NAN, .estimate_right = (double)NAN};

#define X(name, value) value,

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const place *const p = &from->rows[index];
    const pm__converge_item *const item = take(from, p);
    static const pm__converge_series unmeasured = {.truth_mean = (double)NAN};
    const pm__converge_series *const series = item->series.row_count ? &item->series : &unmeasured;
    const pm__converge_row *const row = item->series.row_count ? &series->rows[p->at] : &no_row;
    const pm__cell filled[ROW_COUNT] = {ROW_FIELDS(X)};
    memcpy(cells, filled, sizeof filled);
}

static void fill_fit(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const place *const p = &from->fits[index];
    const pm__converge_item *const item = take(from, p);
    const pm__converge_fit *const fit = &item->series.fits[p->at];
    const pm__cell filled[FIT_COUNT] = {FIT_FIELDS(X)};
    memcpy(cells, filled, sizeof filled);
}

static void fill_point(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const place *const p = &from->points[index];
    const pm__converge_item *const item = take(from, p);
    const pm__converge_point *const point = &item->series.watched[p->at];
    const pm__cell filled[POINT_COUNT] = {POINT_FIELDS(X)};
    memcpy(cells, filled, sizeof filled);
}

#undef X

static place *list_places(place *at, const pm__converge_item *item, size_t how_many)
{
    for (size_t i = 0; i < how_many; i++)
        at[i] = (place){item, i};
    return at + how_many;
}

/* Points are shown one after the other, not pass by pass: a graph each. */
static place *list_points(place *at, const pm__converge_item *item)
{
    const size_t watched = item->series.watched_count;
    for (size_t i = 0; i < watched; i++)
        for (size_t r = 0; r < item->series.row_count; r++)
            *at++ = (place){item, r * watched + i};
    return at;
}

static pm_status find_places(source *from, pm_error *error)
{
    const pm__converge_task *const task = from->task;
    size_t rows = 0, points = 0;
    for (size_t i = 0; i < task->count; i++) {
        rows += task->items[i].series.row_count + 1;
        points += task->items[i].series.row_count * task->items[i].series.watched_count;
    }
    from->rows = calloc(rows + 1, sizeof *from->rows);
    from->fits = calloc(task->count * PM__QUANTITIES + 1, sizeof *from->fits);
    from->points = calloc(points + 1, sizeof *from->points);
    if (!from->rows || !from->fits || !from->points)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    place *row = from->rows, *fit = from->fits, *point = from->points;
    for (size_t i = 0; i < task->count; i++) {
        const pm__converge_item *const item = &task->items[i];
        const size_t measured = item->series.row_count;
        row = list_places(row, item, measured ? measured : item->status && strcmp(item->status, "unsupported") == 0);
        fit = list_places(fit, item, measured ? PM__QUANTITIES : 0);
        point = list_points(point, item);
    }
    from->row_count = (size_t)(row - from->rows);
    from->fit_count = (size_t)(fit - from->fits);
    from->point_count = (size_t)(point - from->points);
    return PM_OK;
}

static json_t *number_option(double value)
{
    return value > 0.0 ? json_real(value) : json_null();
}

static json_t *count_option(size_t value)
{
    return value ? json_integer((json_int_t)value) : json_null();
}

static json_t *alphas_of(const pm__converge_options *c)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < c->alpha_count; i++)
        (void)json_array_append_new(list, json_real(c->alphas[i]));
    return list;
}

static json_t *pixels_of(const pm__converge_options *c)
{
    json_t *const list = json_array();
    for (size_t i = 0; i < c->at_count; i++)
        (void)json_array_append_new(list, json_pack("[I, I]", (json_int_t)c->at[i][0], (json_int_t)c->at[i][1]));
    return list;
}

json_t *pm__converge_options_of(const pm__converge_task *task)
{
    const pm__settings *const s = task->settings;
    const pm__converge_options *const c = &s->converge;
    const pm__progressive_config *const p = &task->config.progressive;
    char size[48];
    json_t *const options = json_object();
    (void)snprintf(size, sizeof size, p->width ? "%zux%zu" : "auto", p->width, p->height);
    (void)json_object_set_new(options, "scene", pm__spec_names(s->cases.items, s->cases.count));
    (void)json_object_set_new(options, "method", pm__spec_names(c->methods.items, c->methods.count));
    (void)json_object_set_new(options, "estimator", pm__spec_names(s->estimators.items, s->estimators.count));
    (void)json_object_set_new(options, "alpha", alphas_of(c));
    (void)json_object_set_new(options, "trials", json_integer((json_int_t)s->trials));
    (void)json_object_set_new(options, "passes", json_integer((json_int_t)c->passes));
    (void)json_object_set_new(options, "photons_per_pass", json_integer((json_int_t)p->photons));
    (void)json_object_set_new(options, "photons", count_option(c->photons));
    (void)json_object_set_new(options, "radius", number_option(s->radius));
    (void)json_object_set_new(options, "k", json_integer((json_int_t)p->k));
    (void)json_object_set_new(options, "size", json_string(size));
    (void)json_object_set_new(options, "seconds", number_option(s->seconds));
    (void)json_object_set_new(options, "error", number_option(c->error));
    (void)json_object_set_new(options, "at", pixels_of(c));
    (void)json_object_set_new(options, "sampler", pm__spec_names(s->samplers.items, s->samplers.count));
    (void)json_object_set_new(options, "search", json_string(task->search));
    (void)json_object_set_new(options, "front", json_string(p->front_only ? "on" : "off"));
    (void)json_object_set_new(options, "profile", json_string(s->full ? "full" : "quick"));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)s->threads));
    return options;
}

pm_status pm__converge_write(const pm__converge_task *task, double wall_s, bool interrupted, pm__sinks *sinks,
                             pm_error *error)
{
    source from = {.task = task};
    pm_status status = find_places(&from, error);
    json_t *const options = pm__converge_options_of(task);
    const pm__side_rows beside[] = {{"fits", fit_fields, FIT_COUNT, from.fit_count, fill_fit, &from},
                                    {"points", point_fields, POINT_COUNT, from.point_count, fill_point, &from}};
    const pm__results results = {.command = "converge",
                                 .options = options,
                                 .settings = task->settings,
                                 .seeded = true,
                                 .wall_s = wall_s,
                                 .interrupted = interrupted,
                                 .fields = row_fields,
                                 .field_count = ROW_COUNT,
                                 .plain_count = ROW_COUNT,
                                 .row_count = from.row_count,
                                 .row = fill_row,
                                 .context = &from,
                                 .beside = beside,
                                 .beside_count = sizeof beside / sizeof *beside};
    if (status == PM_OK)
        status = pm__sinks_finish(sinks, &results, error);
    else
        pm__sinks_discard(sinks);
    json_decref(options);
    free(from.rows);
    free(from.fits);
    free(from.points);
    return status;
}
