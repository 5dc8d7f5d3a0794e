/* The rows of `storage` as data, and its fronts. */
#include "storage_task.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define ROW_FIELDS(X)                                                                                 \
    X(scene, pm__text_cell(from->scene))                                                              \
    X(policy, pm__text_cell(from->policy))                                                            \
    X(map, pm__text_cell(from->map))                                                                  \
    X(emitted, pm__number_cell(row->emitted))                                                         \
    X(stored, pm__number_cell(row->stored))                                                           \
    X(importons, pm__positive_cell(row->importons))                                                   \
    X(trace_s, pm__number_cell(row->trace_s))                                                         \
    X(total_s, pm__number_cell(row->total_s))                                                         \
    X(flux_stored, pm__number_cell(row->flux[PM__EVERYWHERE]))                                        \
    X(flux_expected, pm__number_cell(row->expected[PM__EVERYWHERE]))                                  \
    X(power_spread, pm__number_cell(row->spread))                                                     \
    X(rel_bias, pm__number_cell(row->error.bias))                                                     \
    X(rel_noise, pm__number_cell(row->error.noise))                                                   \
    X(rel_rmse, pm__number_cell(row->error.rmse))                                                     \
    X(rel_rmse_ci95, pm__interval_cell(row->error.rmse_ci95))                                         \
    X(rel_bias_ci95, pm__interval_cell(row->error.bias_ci95))                                         \
    X(rms_bias, pm__number_cell(row->error.rms_bias))                                                 \
    X(rel_added, pm__number_cell(row->error.added))                                                   \
    X(rel_added_ci95, pm__interval_cell(row->error.added_ci95))                                       \
    X(photons, pm__positive_cell(row->photons))                                                       \
    X(wanted, pm__positive_cell(row->wanted))                                                         \
    X(trials, pm__positive_cell(row->trials))                                                         \
    X(importance_s, pm__number_cell(row->importance_s))                                               \
    X(policy_s, pm__number_cell(row->policy_s))                                                       \
    X(build_s, pm__number_cell(row->build_s))                                                         \
    X(cost_added, pm__number_cell(row->cost_added))                                                   \
    X(flux_kept, pm__number_cell(row->kept))                                                          \
    X(flux_ratio, pm__number_cell(row->flux[PM__EVERYWHERE] / row->expected[PM__EVERYWHERE]))         \
    X(flux_ratio_ci95, pm__interval_cell(row->flux_ci95[PM__EVERYWHERE]))                             \
    X(flux_important_stored, pm__number_cell(row->flux[PM__IMPORTANT]))                               \
    X(flux_important_expected, pm__number_cell(row->expected[PM__IMPORTANT]))                         \
    X(flux_important_ratio, pm__number_cell(row->flux[PM__IMPORTANT] / row->expected[PM__IMPORTANT])) \
    X(flux_important_ratio_ci95, pm__interval_cell(row->flux_ci95[PM__IMPORTANT]))                    \
    X(unmet, from->unsupported ? absent : pm__count_cell(row->unmet))                                 \
    X(spp, pm__positive_cell(from->scene_item->result.spp))                                           \
    X(truth_mean, pm__number_cell(from->scene_item->result.truth_mean > 0.0 ?                         \
                         from->scene_item->result.truth_mean : (double)NAN))                          \
    X(status, pm__text_cell(from->scene_item->status))                                                \
    X(detail, pm__text_cell(*from->detail ? from->detail : NULL))

#define FRONT_FIELDS(X)                                                             \
    X(scene, pm__text_cell(from->scene))                                            \
    X(policy, pm__text_cell(from->policy))                                          \
    X(map, pm__text_cell(from->map))                                                \
    X(measure, pm__text_cell(front->whole ? "rmse" : "added"))                      \
    X(rel_error, pm__number_cell(front->rel_error))                                 \
    X(stored_ratio, pm__number_cell(front->stored_ratio))                           \
    X(stored_ratio_ci95, pm__interval_cell(front->stored_ci95))                     \
    X(trace_ratio, pm__number_cell(front->trace_ratio))                             \
    X(trace_ratio_ci95, pm__interval_cell(front->trace_ci95))                       \
    X(time_ratio, pm__number_cell(front->time_ratio))                               \
    X(time_ratio_ci95, pm__interval_cell(front->time_ci95))                         \
    X(stored_front, pairs(from, front, false))                                      \
    X(time_front, pairs(from, front, true))                                         \
    X(status, pm__text_cell(isfinite(front->stored_ratio) ? "ok" : "incomparable")) \
    X(detail, pm__text_cell(*front->detail ? front->detail : NULL))

#define X(name, value) #name,
static const char *const row_fields[] = {ROW_FIELDS(X)};
static const char *const front_fields[] = {FRONT_FIELDS(X)};
#undef X

enum { ROW_COUNT = sizeof row_fields / sizeof *row_fields, FRONT_COUNT = sizeof front_fields / sizeof *front_fields };

typedef struct source {
    const pm__storage_task *task;
    const pm__storage_scene *scene_item;
    bool unsupported;
    char scene[PM__MAX_SPEC], policy_name[PM__MAX_SPEC], detail[PM__STORAGE_DETAIL + 120];
    const char *policy, *map;
} source;

static const pm__cell absent = {.type = PM__ABSENT};

/* None of what is counted here is ever 0 where it exists. */
/* [[cost, error], ...] */
static pm__cell pairs(const source *from, const pm__storage_front *front, bool time)
{
    const size_t *const rows = time ? front->time_front : front->stored_front;
    const size_t row_count = time ? front->time_count : front->stored_count;
    json_t *const list = json_array();
    for (size_t i = 0; i < row_count; i++) {
        const pm__storage_row *const row = &from->scene_item->result.rows[rows[i]];
        (void)json_array_append_new(list, json_pack("[f, f]", time ? row->total_s : row->stored,
                                                    front->whole ? row->error.rmse : row->error.added));
    }
    return (pm__cell){.type = PM__TREE, .tree = list};
}

static const pm__interval none = {(double)NAN, (double)NAN};

/* Of a scene without rows: why. */
static pm__storage_row no_row(void)
{
    const double nan = (double)NAN;
    pm__storage_row row = {.emitted = nan, .stored = nan, .importance_s = nan, .trace_s = nan, .policy_s = nan,
                           .build_s = nan, .total_s = nan, .cost_added = nan, .kept = nan, .spread = nan,
                           .error = {nan, nan, nan, nan, nan, none, none, none}};
    for (int p = 0; p < PM__PARTS; p++) {
        row.flux[p] = row.expected[p] = nan;
        row.flux_ci95[p] = none;
    }
    return row;
}

/* How many rows a scene has: one that cannot be measured has one. */
static size_t rows_of(const pm__storage_scene *scene)
{
    const bool unsupported = scene->status && strcmp(scene->status, "unsupported") == 0;
    return unsupported ? 1 : scene->result.row_count;
}

static size_t fronts_of(const pm__storage_scene *scene)
{
    return scene->result.front_count;
}

/* The scene that row or front `index` is of; *at: its number there. */
static const pm__storage_scene *find_scene(const pm__storage_task *task, size_t index,
                                           size_t (*many)(const pm__storage_scene *scene), size_t *at)
{
    const pm__storage_scene *scene = task->scenes;
    for (; index >= many(scene); scene++)
        index -= many(scene);
    *at = index;
    return scene;
}

static void take(source *from, const pm__storage_scene *scene, const pm__spec *policy, pm__map_kind map)
{
    from->scene_item = scene;
    pm__spec_format(scene->scene, from->scene, sizeof from->scene);
    from->policy = policy ? from->policy_name : NULL;
    from->map = policy ? pm__map_names[map] : NULL;
    if (policy)
        pm__spec_format(policy, from->policy_name, sizeof from->policy_name);
}

/* What the row itself has to say, or else the scene. */
static void describe(source *from, const pm__storage_row *row)
{
    (void)snprintf(from->detail, sizeof from->detail, "%s", from->scene_item->detail);
    if (*from->detail)
        return;
    if (row->starved)
        (void)snprintf(from->detail, sizeof from->detail, "so many were not stored of %.0f sent", row->emitted);
    else if (row->unmet)
        (void)snprintf(from->detail, sizeof from->detail, "what the policy requires was not reached in %zu of %zu "
                                                          "trials", row->unmet, row->trials);
}

#define X(name, value) value,

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    size_t at;
    const pm__storage_scene *const scene = find_scene(from->task, index, rows_of, &at);
    const pm__storage_row unmeasured = no_row();
    from->unsupported = !scene->result.row_count;
    const pm__storage_row *const row = from->unsupported ? &unmeasured : &scene->result.rows[at];
    take(from, scene, row->policy, row->map);
    describe(from, row);
    const pm__cell filled[ROW_COUNT] = {ROW_FIELDS(X)};
    memcpy(cells, filled, sizeof filled);
}

static void fill_front(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    size_t at;
    const pm__storage_scene *const scene = find_scene(from->task, index, fronts_of, &at);
    const pm__storage_front *const front = &scene->result.fronts[at];
    take(from, scene, front->policy, front->map);
    const pm__cell filled[FRONT_COUNT] = {FRONT_FIELDS(X)};
    memcpy(cells, filled, sizeof filled);
}

#undef X

static json_t *maps_of(const pm__storage_wish *wish)
{
    json_t *const list = json_array();
    for (int kind = 0; kind < PM__MAP_KINDS; kind++)
        if (wish->maps[kind])
            (void)json_array_append_new(list, json_string(pm__map_names[kind]));
    return list;
}

static json_t *options_of(const pm__storage_task *task)
{
    const pm__settings *const s = task->settings;
    const pm__storage_wish *const w = &task->wish;
    char size[48];
    json_t *const options = json_object();
    (void)snprintf(size, sizeof size, w->width ? "%zux%zu" : "auto", w->width, w->height);
    (void)json_object_set_new(options, "scene", pm__spec_names(s->cases.items, s->cases.count));
    (void)json_object_set_new(options, "policy", pm__spec_names(w->policies, w->policy_count));
    (void)json_object_set_new(options, "photons", pm__number_list(w->photons, w->photon_count));
    (void)json_object_set_new(options, "stored", pm__number_list(w->stored, w->stored_count));
    (void)json_object_set_new(options, "map", maps_of(w));
    (void)json_object_set_new(options, "k", json_integer((json_int_t)w->k));
    (void)json_object_set_new(options, "trials", json_integer((json_int_t)w->trials));
    (void)json_object_set_new(options, "paths", json_integer((json_int_t)w->paths));
    (void)json_object_set_new(options, "importance", json_string(s->storage.importance));
    (void)json_object_set_new(options, "share", json_real(w->share));
    (void)json_object_set_new(options, "size", json_string(size));
    (void)json_object_set_new(options, "spp", w->spp ? json_integer((json_int_t)w->spp) : json_string("auto"));
    (void)json_object_set_new(options, "seconds", w->seconds > 0.0 ? json_real(w->seconds) : json_null());
    (void)json_object_set_new(options, "profile", json_string(s->full ? "full" : "quick"));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)s->threads));
    return options;
}

pm_status pm__storage_write(const pm__storage_task *task, double wall_s, bool interrupted, pm__sinks *sinks,
                            pm_error *error)
{
    source from = {.task = task};
    size_t rows = 0, fronts = 0;
    json_t *const options = options_of(task);
    for (size_t i = 0; i < task->count; i++) {
        rows += rows_of(&task->scenes[i]);
        fronts += fronts_of(&task->scenes[i]);
    }
    const pm__side_rows beside = {"fronts", front_fields, FRONT_COUNT, fronts, fill_front, &from};
    const pm__results results = {.command = "storage",
                                 .options = options,
                                 .settings = task->settings,
                                 .seeded = true,
                                 .wall_s = wall_s,
                                 .interrupted = interrupted,
                                 .fields = row_fields,
                                 .field_count = ROW_COUNT,
                                 .plain_count = ROW_COUNT,
                                 .row_count = rows,
                                 .row = fill_row,
                                 .context = &from,
                                 .beside = &beside,
                                 .beside_count = 1};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}
