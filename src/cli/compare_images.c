/* compare: two images by metrics. The first is tested, the second the reference. */
#include "compare_images.h"
#include "commands.h"
#include "file_names.h"
#include "option_values.h"
#include "progress.h"
#include "results.h"
#include "wrap.h"

#include "../base/clock.h"

#include <fcntl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

typedef struct finding {
    pm__measured measured; /* without its map */
    bool undefined;
    char *image;           /* the file of the map, or NULL; owned */
    char detail[sizeof(pm_error)];
} finding;

typedef struct comparing {
    const pm__settings *settings;
    pm__image images[2];
    char names[2][PM__NAME_SIZE];
    finding *findings; /* [settings->metrics.count] */
    char metric[PM__MAX_SPEC];
} comparing;

/* ---- Options ----------------------------------------------------------------------------------- */

static pm_status set_metric(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__metrics, text, &s->metrics, error);
}

static pm_status set_output(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->output, error);
}

const pm__option pm__compare_option_metric = {"metric", 0, "METRIC,...", "of images: what is measured, or all (all)",
                                              set_metric};
const pm__option pm__compare_option_output = {
    "output", 'o', "FILE", "results: what would go to the screen; images: what the names of maps start with (none)",
    set_output};

/* ---- Rows -------------------------------------------------------------------------------------- */

#define FIELDS(X)                                                                    \
    X(metric, pm__text_cell(all->metric))                                            \
    X(better, pm__text_cell(m->larger_is_better ? "larger" : "smaller"))             \
    X(unit, pm__text_cell(*m->unit ? m->unit : NULL))                                \
    X(mean, pm__number_cell(m->mean))                                                \
    X(median, pm__number_cell(m->median))                                            \
    X(p95, pm__number_cell(m->p95))                                                  \
    X(worst, pm__number_cell(m->worst))                                              \
    X(worst_x, f->undefined ? absent : pm__count_cell(m->worst_x))                   \
    X(worst_y, f->undefined ? absent : pm__count_cell(m->worst_y))                   \
    X(exposures, pm__positive_cell(m->shown.count))                                  \
    X(exposure_start, m->shown.count ? pm__number_cell(m->shown.start) : absent)     \
    X(exposure_stop, m->shown.count ? pm__number_cell(m->shown.stop) : absent)       \
    X(image, pm__text_cell(f->image))                                                \
    X(status, pm__text_cell(f->undefined ? "undefined" : "ok"))                      \
    X(detail, pm__text_cell(*f->detail ? f->detail : NULL))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    comparing *const all = context;
    const finding *const f = &all->findings[index];
    const pm__measured *const m = &f->measured;
    const pm__cell absent = {.type = PM__ABSENT};
    pm__spec_format(&all->settings->metrics.items[index], all->metric, sizeof all->metric);
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

static json_t *options_of(const comparing *all)
{
    const pm__specs *const metrics = &all->settings->metrics;
    json_t *const options = json_object();
    (void)json_object_set_new(options, "a", json_string(all->names[0]));
    (void)json_object_set_new(options, "b", json_string(all->names[1]));
    (void)json_object_set_new(options, "kind", json_string("images"));
    (void)json_object_set_new(options, "width", json_integer((json_int_t)all->images[1].width));
    (void)json_object_set_new(options, "height", json_integer((json_int_t)all->images[1].height));
    (void)json_object_set_new(options, "metric", pm__spec_names(metrics->items, metrics->count));
    return options;
}

/* ---- The screen -------------------------------------------------------------------------------- */

static void print_finding(FILE *file, const comparing *all, size_t index)
{
    const finding *const f = &all->findings[index];
    const pm__measured *const m = &f->measured;
    char name[PM__MAX_SPEC], place[48], more[80];
    pm__spec_format_short(&all->settings->metrics.items[index], name, sizeof name);
    (void)fprintf(file, "%-14s ", name);
    if (f->undefined) {
        pm__wrap(file, f->detail, 15, 15);
        return;
    }
    (void)snprintf(place, sizeof place, "(%zu, %zu)", m->worst_x, m->worst_y);
    if (m->shown.count > 1)
        (void)snprintf(more, sizeof more, "%.1f to %.1f stops", m->shown.start, m->shown.stop);
    else if (m->shown.count)
        (void)snprintf(more, sizeof more, "%.1f stops", m->shown.start);
    else
        (void)snprintf(more, sizeof more, "%s", m->unit);
    (void)fprintf(file, "%10.4g %10.4g %10.4g %10.4g at %-*s%s\n", m->mean, m->median, m->p95, m->worst,
                  *more ? 14 : 0, place, more);
}

static void print_screen(FILE *file, const comparing *all)
{
    (void)fprintf(file, "A: %s (tested)\nB: %s (the reference)\n%zu x %zu pixels\n\n", all->names[0], all->names[1],
                  all->images[1].width, all->images[1].height);
    (void)fprintf(file, "%-14s %10s %10s %10s %10s\n", "metric", "mean", "median", "95 %", "worst");
    for (size_t i = 0; i < all->settings->metrics.count; i++)
        print_finding(file, all, i);
    (void)fputc('\n', file);
    pm__wrap(file,
             "0 is equal; of ssim 1 is. 95 % of the pixels are as good as that or better; the worst is at (x, y) from "
             "the top left. Stops: the exposures at which both are looked at, 0 shows 1 W/(m2 sr) as 1. 'photonbench "
             "list metrics' says what each is.",
             0, 0);
    if (all->settings->output)
        (void)fprintf(file, "Maps: %.*s.METRIC.exr, .png\n", pm__stem_length(all->settings->output),
                      all->settings->output);
}

/* ---- The work ---------------------------------------------------------------------------------- */

bool pm__is_image_file(const char *path)
{
    static const unsigned char magic[] = {0x76, 0x2f, 0x31, 0x01};
    unsigned char bytes[sizeof magic];
    struct stat status;
    if (stat(path, &status) != 0 || !S_ISREG(status.st_mode))
        return false;
    const int file = open(path, O_RDONLY | O_CLOEXEC); /* no stream, which memory could be refused for */
    if (file < 0)
        return false;
    const bool is = read(file, bytes, sizeof bytes) == (ssize_t)sizeof bytes && memcmp(bytes, magic, sizeof magic) == 0;
    (void)close(file);
    return is;
}

/* What is of the wrong kind is a mistake of usage, values that are not numbers are the file's. */
static int load(comparing *all, pm_error *error)
{
    pm_status status = PM_OK;
    for (int i = 0; i < 2 && status == PM_OK; i++) {
        pm__quote_path(all->settings->operands[i], all->names[i]);
        status = pm__exr_read(all->settings->operands[i], &all->images[i], error);
        if (status == PM_OK)
            status = pm__metric_check(&all->images[i], all->names[i], error);
    }
    const pm__image *const a = &all->images[0], *const b = &all->images[1];
    if (status == PM_OK && (a->width != b->width || a->height != b->height))
        status = pm__fail(error, PM_EINVAL, "images of different sizes: %.120s has %zu x %zu pixels, %.120s %zu x %zu",
                          all->names[0], a->width, a->height, all->names[1], b->width, b->height);
    return status == PM_EINVAL ? PM__EXIT_USAGE : pm__exit_status_of_input(status);
}

static pm_status check_memory(const pm__image *image, pm_error *error)
{
    const double wanted = pm__metric_bytes(image->width * image->height), memory = pm__free_memory();
    if (memory > 0.0 && wanted > memory)
        return pm__fail(error, PM_ENOMEM, "%zu x %zu pixels take %.3g GB of memory; %.3g GB are free", image->width,
                        image->height, 1e-9 * wanted, 1e-9 * memory);
    return PM_OK;
}

static pm_status measure(comparing *all, size_t index, pm_error *error)
{
    const pm__spec *const metric = &all->settings->metrics.items[index];
    finding *const f = &all->findings[index];
    pm__measured *const m = &f->measured;
    pm_status status = pm__metric_measure(metric, &all->images[0], &all->images[1], m, &f->undefined, error);
    if (f->undefined) {
        (void)snprintf(f->detail, sizeof f->detail, "%s", error->text);
        *error = (pm_error){""};
        m->mean = m->median = m->p95 = m->worst = (double)NAN;
        status = PM_OK;
    } else if (status == PM_OK && all->settings->output) {
        status = pm__maps_write(all->settings, metric, m, all->names[0], all->names[1], error);
        if (status == PM_OK && pm__map_path(all->settings->output, metric, "exr", &f->image))
            status = pm__fail(error, PM_ENOMEM, "out of memory");
    }
    free(m->map);
    m->map = NULL;
    return status;
}

static pm_status measure_all(comparing *all, pm_error *error)
{
    const pm__specs *const metrics = &all->settings->metrics;
    pm__progress progress;
    pm_status status = PM_OK;
    pm__progress_start(&progress, all->settings->quiet);
    for (size_t i = 0; i < metrics->count && status == PM_OK; i++) {
        pm__progress_update(&progress, (double)i / (double)metrics->count, metrics->items[i].entry->name);
        status = measure(all, i, error);
    }
    pm__progress_end(&progress);
    return status;
}

static pm_status finish(comparing *all, double start, pm__sinks *sinks, pm_error *error)
{
    json_t *const options = options_of(all);
    const pm__results results = {.command = "compare",
                                 .options = options,
                                 .settings = all->settings,
                                 .wall_s = pm__seconds() - start,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT,
                                 .row_count = all->settings->metrics.count,
                                 .row = fill_row,
                                 .context = all};
    if (pm__sinks_screen(sinks))
        print_screen(pm__sinks_screen(sinks), all);
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    return status;
}

/* -o names maps here. */
static pm_status work(comparing *all, double start, pm_error *error)
{
    pm__sinks sinks;
    pm__settings rows = *all->settings;
    rows.output = NULL;
    all->findings = calloc(rows.metrics.count, sizeof *all->findings);
    if (!all->findings)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm_status status = check_memory(&all->images[1], error);
    if (status == PM_OK)
        status = pm__maps_check(all->settings, error);
    if (status == PM_OK)
        status = pm__sinks_open(&rows, !rows.quiet, &sinks, error);
    if (status != PM_OK)
        return status;
    status = measure_all(all, error);
    if (status != PM_OK) {
        pm__sinks_discard(&sinks);
        return status;
    }
    return finish(all, start, &sinks, error);
}

int pm__compare_images(pm__settings *settings)
{
    pm_error error = {""};
    comparing all = {.settings = settings};
    const double start = pm__seconds();
    const pm_status status = pm__default_specs(&pm__metrics, "all", &settings->metrics, &error);
    int exit_status = status == PM_OK ? load(&all, &error) : pm__exit_status(status);
    if (exit_status == PM__EXIT_DONE)
        exit_status = pm__exit_status(work(&all, start, &error));
    if (*error.text)
        pm__complain("compare", "%s", error.text);
    for (size_t i = 0; all.findings && i < settings->metrics.count; i++)
        free(all.findings[i].image);
    free(all.findings);
    pm__image_free(&all.images[0]);
    pm__image_free(&all.images[1]);
    return exit_status;
}
