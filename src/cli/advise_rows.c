#include "advise_rows.h"

#include "wrap.h"

#include <math.h>
#include <string.h>

enum { COMMAND = 1200 };

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define FIELDS(X)                                                              \
    X(case, pm__text_cell(from->subject))                                      \
    X(error, pm__number_cell(from->task->config->error))                       \
    X(method, pm__text_cell(from->method))                                     \
    X(estimator, pm__text_cell(row->estimator.entry ? from->estimator : NULL)) \
    X(k, known && row->k ? pm__count_cell(row->k) : absent)                    \
    X(radius, absent)                                                          \
    X(photons, known && row->photons ? pm__count_cell(row->photons) : absent)  \
    X(passes, row->passes ? pm__count_cell(row->passes) : absent)              \
    X(trials, known ? pm__count_cell(row->trials) : absent)                    \
    X(predicted_rel_bias, pm__number_cell(row->predicted_rel_bias))            \
    X(predicted_rel_noise, pm__number_cell(row->predicted_rel_noise))          \
    X(predicted_rel_rmse, pm__number_cell(row->predicted_rel_rmse))            \
    X(predicted_seconds, pm__number_cell(row->predicted_seconds))              \
    X(advised, pm__flag_cell(row->advised))                                    \
    X(command, known ? pm__text_cell(from->command) : absent)                  \
    X(reached_rel_rmse, pm__number_cell(row->reached_rel_rmse))                \
    X(reached_rel_rmse_ci95, pm__interval_cell(row->reached_rel_rmse_ci95))    \
    X(reached_seconds, pm__number_cell(row->reached_seconds))                  \
    X(ratio, pm__number_cell(row->ratio))                                      \
    X(status, pm__text_cell(row->status))                                      \
    X(detail, pm__text_cell(*row->detail ? row->detail : NULL))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

typedef struct source {
    const pm__advise_task *task;
    char subject[PM__MAX_SPEC], method[PM__MAX_SPEC], estimator[PM__MAX_SPEC], command[COMMAND];
} source;

static bool is_known(const pm__advice *row)
{
    return strcmp(row->status, "unsupported") != 0;
}

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const pm__advice *const row = &from->task->advice[index];
    const pm__cell absent = {.type = PM__ABSENT};
    const bool known = is_known(row);
    pm__spec_format(from->task->config->subject, from->subject, sizeof from->subject);
    pm__spec_format(&row->method, from->method, sizeof from->method);
    if (row->estimator.entry)
        pm__spec_format(&row->estimator, from->estimator, sizeof from->estimator);
    pm__advise_command(from->task, row, from->command, sizeof from->command);
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

/* Everything that is needed to run the same again. */
static json_t *options_of(const pm__advise_task *task)
{
    const pm__advise_config *const c = task->config;
    json_t *const options = json_object();
    (void)json_object_set_new(options, "case", pm__spec_names(c->subject, 1));
    (void)json_object_set_new(options, "error", json_real(c->error));
    (void)json_object_set_new(options, "verify", json_boolean(task->settings->advise.verify));
    (void)json_object_set_new(options, "estimator", c->estimator_count
                                                        ? pm__spec_names(c->estimators, c->estimator_count)
                                                        : json_null());
    (void)json_object_set_new(options, "method",
                              c->method_count ? pm__spec_names(c->methods, c->method_count) : json_null());
    (void)json_object_set_new(options, "probes", json_integer((json_int_t)c->probes));
    (void)json_object_set_new(options, "photons", c->most_photons ? json_integer((json_int_t)c->most_photons)
                                                                  : json_null());
    (void)json_object_set_new(options, "seconds", json_real(c->seconds));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)c->threads));
    return options;
}

pm_status pm__advise_write(const pm__advise_task *task, pm__sinks *sinks, pm_error *error)
{
    source from = {.task = task};
    json_t *const options = options_of(task);
    const pm__results results = {.command = "advise",
                                 .options = options,
                                 .settings = task->settings,
                                 .seeded = true,
                                 .wall_s = task->wall_s,
                                 .interrupted = task->interrupted,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT,
                                 .row_count = task->count,
                                 .row = fill_row,
                                 .context = &from};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}

/* ---- The command ------------------------------------------------------------------------------- */

static void write_passes(const pm__advise_task *task, const pm__advice *a, const char *method, const char *estimator,
                         char *out, size_t size)
{
    const pm__progressive *const m = (const pm__progressive *)(const void *)a->method.entry;
    char subject[PM__MAX_SPEC], lookups[PM__MAX_SPEC + 64] = "", shrinking[64] = "", photons[48] = "", alpha[32];
    pm__spec_format_short(task->config->subject, subject, sizeof subject);
    pm__format_double(pm__advise_alpha, alpha);
    if (a->k)
        (void)snprintf(lookups, sizeof lookups, " --estimator %s --k %zu", estimator, a->k);
    if (m->shrinks)
        (void)snprintf(shrinking, sizeof shrinking, " --alpha %s", alpha);
    if (a->photons)
        (void)snprintf(photons, sizeof photons, " --photons-per-pass %zu", a->photons);
    (void)snprintf(out, size, "photonbench converge %s --method %s%s%s%s --passes %zu --size %zux%zu --trials %zu "
                              "--seed %llu",
                   subject + strlen("scene:"), method, lookups, shrinking, photons, (size_t)a->passes, a->width,
                   a->height, a->trials, (unsigned long long)task->config->seed);
}

void pm__advise_command(const pm__advise_task *task, const pm__advice *a, char *out, size_t size)
{
    char subject[PM__MAX_SPEC], method[PM__MAX_SPEC], estimator[PM__MAX_SPEC] = "";
    pm__spec_format_short(task->config->subject, subject, sizeof subject);
    pm__spec_format_short(&a->method, method, sizeof method);
    if (a->estimator.entry)
        pm__spec_format_short(&a->estimator, estimator, sizeof estimator);
    if (a->passes)
        write_passes(task, a, method, estimator, out, size);
    else
        (void)snprintf(out, size,
                       "photonbench accuracy --case %s --estimator %s --k %zu --photons %zu --trials %zu --probes %zu "
                       "--seed %llu",
                       subject, estimator, a->k, a->photons, a->trials, task->config->probes,
                       (unsigned long long)task->config->seed);
}

/* ---- On the screen ----------------------------------------------------------------------------- */

static void percent(double value, char out[16])
{
    if (isfinite(value))
        (void)snprintf(out, 16, "%.3g", 100.0 * value);
    else
        (void)snprintf(out, 16, "-");
}

static void seconds(double value, char out[16])
{
    if (!isfinite(value))
        (void)snprintf(out, 16, "-");
    else
        (void)snprintf(out, 16, value < 99.95 ? "%.3g" : "%.0f", value);
}

static void count(size_t value, char out[24])
{
    if (value)
        (void)snprintf(out, 24, "%zu", value);
    else
        (void)snprintf(out, 24, "-");
}

static void print_row(FILE *file, const pm__advice *a)
{
    char method[PM__MAX_SPEC], estimator[PM__MAX_SPEC] = "-", k[24], photons[24], passes[24];
    char bias[16], noise[16], error[16], time[16];
    const bool known = is_known(a);
    pm__spec_format_short(&a->method, method, sizeof method);
    if (a->estimator.entry)
        pm__spec_format_short(&a->estimator, estimator, sizeof estimator);
    count(known ? a->k : 0, k);
    count(known ? a->photons : 0, photons);
    count(known ? a->passes : 0, passes);
    percent(a->predicted_rel_bias, bias);
    percent(a->predicted_rel_noise, noise);
    percent(a->predicted_rel_rmse, error);
    seconds(a->predicted_seconds, time);
    (void)fprintf(file, "%c %-10.10s %-24.24s %7s %10s %7s %6s %6s %6s %8s\n", a->advised ? '*' : ' ', method,
                  estimator, k, photons, passes, bias, noise, error, time);
    if (*a->detail) {
        (void)fputs("      ", file);
        pm__wrap(file, a->detail, 6, 6);
    }
}

static void print_reached(FILE *file, const pm__advice *a)
{
    (void)fprintf(file, "\nreached %.3g %% [%.3g, %.3g], %.3f of what was asked for, in %.3g s: %s\n",
                  100.0 * a->reached_rel_rmse, 100.0 * a->reached_rel_rmse_ci95.low,
                  100.0 * a->reached_rel_rmse_ci95.high, a->ratio, a->reached_seconds,
                  strcmp(a->status, "ok") ? "missed" : a->ratio < 0.75 ? "better" : "within 25 %");
}

/* Within 100 columns and to be pasted all the same: lines that go on say so, before an option. */
static void print_command(FILE *file, const char *command)
{
    size_t column = 2;
    while (*command) {
        const char *const next = strstr(command + 1, " --");
        const size_t length = next ? (size_t)(next - command) : strlen(command);
        if (column > 2 && column + length > 97) {
            (void)fputs(" \\\n     ", file);
            column = 5;
        }
        (void)fprintf(file, "%.*s", (int)length, command);
        column += length;
        command += length;
    }
    (void)fputc('\n', file);
}

void pm__advise_print(FILE *file, const pm__advise_task *task)
{
    char subject[PM__MAX_SPEC], command[COMMAND];
    const pm__advice *const best = &task->advice[0];
    const pm__advice *image = NULL;
    bool maps = false;
    pm__spec_format_short(task->config->subject, subject, sizeof subject);
    (void)fprintf(file, "%.60s: error %.3g %%\n", subject, 100.0 * task->config->error);
    (void)fprintf(file, "  %-10s %-24s %7s %10s %7s %6s %6s %6s %8s\n", "method", "estimator", "k", "photons", "passes",
                  "bias", "noise", "error", "seconds");
    for (size_t i = 0; i < task->count; i++) {
        print_row(file, &task->advice[i]);
        image = task->advice[i].passes ? &task->advice[i] : image;
        maps |= !task->advice[i].passes && is_known(&task->advice[i]);
    }
    (void)fputs("All predicted; in percent of the mean truth, seconds on one thread", file);
    if (maps)
        (void)fprintf(file, " with %zu lookups a map", task->config->probes);
    (void)fputs(".\n", file);
    if (image)
        (void)fprintf(file, "%s in %zux%zu pixels of the scene's image.\n",
                      maps ? "Maps are judged over the case's region all, other methods" : "Methods are judged",
                      image->width, image->height);
    pm__advise_command(task, best, command, sizeof command);
    (void)fprintf(file, "%s:\n  ", best->advised ? "The least time, marked *, is that of" : "The nearest comes");
    print_command(file, command);
    if (isfinite(best->ratio))
        print_reached(file, best);
}
