#include "speed_rows.h"

#include "wrap.h"

#include <math.h>
#include <string.h>

/* The fields, in the order that scripts rely on; each with what fills it in. */
#define FIELDS(X)                                                 \
    X(scene, pm__text_cell(from->scene))                          \
    X(quantity, pm__text_cell(pm__quantity_names[row->quantity])) \
    X(method, pm__text_cell(row->method))                         \
    X(photons, pm__count_cell(row->photons))                      \
    X(threads, pm__count_cell(row->threads))                      \
    X(seconds, pm__number_cell(row->seconds))                     \
    X(baseline, pm__text_cell(row->baseline))                     \
    X(baseline_seconds, pm__number_cell(row->baseline_seconds))   \
    X(ratio, pm__number_cell(row->ratio))                         \
    X(ratio_ci95, pm__interval_cell(row->ratio_ci95))             \
    X(promise, pm__number_cell(row->promise))                     \
    X(samples, pm__count_cell(row->samples))                      \
    X(status, pm__text_cell(row->status))                         \
    X(detail, pm__text_cell(*row->detail ? row->detail : NULL))   \
    X(agree, row->compared ? pm__flag_cell(row->agree) : absent)  \
    X(aa_ratio, pm__number_cell(row->aa_ratio))                   \
    X(aa_ratio_ci95, pm__interval_cell(row->aa_ci95))             \
    X(warning, pm__text_cell(row->warning))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

typedef struct source {
    const pm__speed_row *rows;
    char scene[PM__MAX_SPEC];
} source;

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    source *const from = context;
    const pm__speed_row *const row = &from->rows[index];
    const pm__cell absent = {.type = PM__ABSENT};
    pm__spec_format(&row->scene, from->scene, sizeof from->scene);
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

static json_t *names_of_quantities(const pm__speed_config *config)
{
    json_t *const list = json_array();
    for (int q = 0; q < PM__QUANTITIES; q++)
        if (!config->quantities || config->quantities & 1U << q)
            (void)json_array_append_new(list, json_string(pm__quantity_names[q]));
    return list;
}

/* Everything that is needed to run the same again. */
static json_t *options_of(const pm__speed_config *config)
{
    char size[48];
    json_t *const options = json_object();
    (void)snprintf(size, sizeof size, "%zux%zu", config->width, config->height);
    (void)json_object_set_new(options, "scene", config->scene_count
                                                    ? pm__spec_names(config->scenes, config->scene_count)
                                                    : json_null());
    (void)json_object_set_new(options, "quantity", names_of_quantities(config));
    (void)json_object_set_new(options, "photons", json_integer((json_int_t)config->photons));
    (void)json_object_set_new(options, "pass_photons", json_integer((json_int_t)config->pass_photons));
    (void)json_object_set_new(options, "k", json_integer((json_int_t)config->k));
    (void)json_object_set_new(options, "size", json_string(size));
    (void)json_object_set_new(options, "seconds", json_real(config->seconds));
    (void)json_object_set_new(options, "threads", json_integer((json_int_t)config->threads));
    return options;
}

pm_status pm__speed_write(const pm__settings *settings, const pm__speed_config *config, const pm__speed_row *rows,
                          size_t count, double wall_s, bool interrupted, pm__sinks *sinks, pm_error *error)
{
    source from = {.rows = rows};
    json_t *const options = options_of(config);
    const pm__results results = {.command = "speed",
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

/* ---- On the screen ----------------------------------------------------------------------------- */

static void print_head(FILE *file, const pm__speed_row *row)
{
    static const char *const what[PM__QUANTITIES] = {
        "photons traced on one thread; times the rate of Embree alone on the same rays",
        "photons shot on all threads; times the rate of one",
        "the image of a photon map; times the rate of its rays and its bare search",
        "a render of what the scene needs; times the rate with all that is skipped (--no-skip)",
        "a pass of progressive photon mapping; times the rate of its tracing and bare searches",
        "such a pass on all threads; times the rate of one",
        "such a pass, processors' time; times the rate of two million random rays by Embree alone"};
    (void)fprintf(file, "%s: %s\n", pm__quantity_names[row->quantity], what[row->quantity]);
    (void)fprintf(file, "  %-24s %-9s %9s %9s %7s  %-16s %7s\n", "", "", "ms", "baseline", "ratio",
                  "95 % interval", "promise");
}

static void number_text(double value, int digits, char out[24])
{
    if (isfinite(value))
        (void)snprintf(out, 24, "%.*f", digits, value);
    else
        (void)snprintf(out, 24, "-");
}

/* So that no number is wide, however long another program held one of two up. */
static int digits_of(double value)
{
    return value < 9.995 ? 3 : value < 99.95 ? 2 : value < 999.5 ? 1 : 0;
}

static void print_row(FILE *file, const pm__speed_row *row)
{
    char scene[PM__MAX_SPEC], ms[24], base[24], ratio[24], promise[24], low[24], high[24], ci95[52] = "";
    pm__spec_format_short(&row->scene, scene, sizeof scene);
    number_text(1e3 * row->seconds, digits_of(1e3 * row->seconds), ms);
    number_text(1e3 * row->baseline_seconds, digits_of(1e3 * row->baseline_seconds), base);
    number_text(row->ratio, digits_of(row->ratio), ratio);
    number_text(row->promise, 3, promise);
    number_text(row->ratio_ci95.low, digits_of(row->ratio_ci95.low), low);
    number_text(row->ratio_ci95.high, digits_of(row->ratio_ci95.high), high);
    if (isfinite(row->ratio_ci95.low))
        (void)snprintf(ci95, sizeof ci95, "[%s, %s]", low, high);
    (void)fprintf(file, "  %-24.24s %-9s %9s %9s %7s  %-16s %7s  %s\n", scene, row->method ? row->method : "", ms,
                  base, ratio, ci95, promise, row->status);
    if (*row->detail) {
        (void)fputs("      ", file);
        pm__wrap(file, row->detail, 6, 6);
    }
    if (row->warning) {
        (void)fputs("      warning: ", file);
        pm__wrap(file, row->warning, 15, 6);
    }
}

void pm__speed_print(FILE *file, const pm__speed_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (!i || rows[i].quantity != rows[i - 1].quantity) {
            (void)fputs(i ? "\n" : "", file);
            print_head(file, &rows[i]);
        }
        print_row(file, &rows[i]);
    }
}
