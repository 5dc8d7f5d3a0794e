/* Image files: their names, their headers, complete or absent. */
#include "commands.h"
#include "file_names.h"
#include "interrupt.h"
#include "render_task.h"
#include "version.h"

#include "../base/status.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_FILES = PM__MOST_HELD - 8, MOST_ATTRIBUTES = 32 };

static const struct {
    const char *suffix, *content;
} kinds[PM__IMAGE_KINDS] = {
    [PM__RADIANCE] = {"", "radiance, W/(m2 sr)"},
    [PM__TRUTHS] = {".truth", "true radiance, W/(m2 sr)"},
    [PM__ERRORS] = {".error", "(radiance - truth) / mean truth of the image"},
    [PM__BIASES] = {".bias", "(mean of trials - truth) / mean truth of the image"},
    [PM__NOISES] = {".noise",
                    "standard deviation of trials (one trial of path: its standard error) / mean truth or radiance"},
    [PM__RADII] = {".radius", "radius of the estimate, m"},
    [PM__COUNTS] = {".count", "photons in the estimate"},
};

static bool is_stdout(const char *path)
{
    return strcmp(path, "-") == 0 || strcmp(path, "/dev/stdout") == 0 || strcmp(path, "/dev/fd/1") == 0 ||
           strcmp(path, "/proc/self/fd/1") == 0;
}

bool pm__render_to_stdout(const pm__settings *settings)
{
    return settings->output && is_stdout(settings->output);
}

/* Where the suffix stands that a main file's name ends in. */
static int stem_length(const char *path)
{
    const size_t length = strlen(path);
    return (int)(length > 4 && strcmp(path + length - 4, ".exr") == 0 ? length - 4 : length);
}

/* NULL: out of memory. */
static char *main_path(const pm__render_task *task, size_t scene, size_t estimator)
{
    const char *const given = task->settings->output;
    char scene_name[PM__MAX_SPEC], name[PM__MAX_SPEC], *path = NULL;
    int length;
    pm__safe_name(&task->scenes[scene], scene_name, sizeof scene_name);
    pm__safe_name(task->estimates ? &task->estimators[estimator] : task->config.method, name, sizeof name);
    if (given && task->scene_count * task->estimator_count == 1)
        return strdup(given);
    if (given)
        length = asprintf(&path, "%.*s.%s.%s.exr", stem_length(given), given, scene_name, name);
    else if (task->estimator_count > 1)
        length = asprintf(&path, "%s.%s.exr", scene_name, name);
    else
        length = asprintf(&path, "%s.exr", scene_name);
    return length < 0 ? NULL : path;
}

static char *path_beside(const char *path, const char *suffix)
{
    char *beside = NULL;
    return asprintf(&beside, "%.*s%s.exr", stem_length(path), path, suffix) < 0 ? NULL : beside;
}

static pm_status name_files(const pm__render_task *task, pm__render_files *files, pm_error *error)
{
    for (size_t i = 0; i < files->images; i++) {
        pm__render_file *const file = &files->items[i * files->kinds];
        file[0].path = main_path(task, i / task->estimator_count, i % task->estimator_count);
        for (size_t kind = 1; file[0].path && kind < files->kinds; kind++)
            file[kind].path = path_beside(file[0].path, kinds[kind].suffix);
        for (size_t kind = 0; kind < files->kinds; kind++)
            if (!file[kind].path)
                return pm__fail(error, PM_ENOMEM, "out of memory");
    }
    return PM_OK;
}

/* A pipe or a device holds one image. */
static pm_status refuse_streams(const pm__render_files *files, const char *output, pm_error *error)
{
    struct stat status;
    if (!output || files->images * files->kinds == 1)
        return PM_OK;
    if (is_stdout(output) || (stat(output, &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode)))
        return pm__fail(error, PM_EINVAL, "-o %.200s holds one image, and %zu are asked for", output,
                        files->images * files->kinds);
    return PM_OK;
}

static pm_status refuse_same(const pm__render_files *files, const pm__settings *s, pm_error *error)
{
    const char *const others[] = {s->json, s->csv, s->markdown};
    for (size_t i = 0; i < files->images * files->kinds; i++) {
        const char *const path = files->items[i].path;
        for (size_t j = 0; j < sizeof others / sizeof *others; j++)
            if (others[j] && strcmp(path, "/dev/null") != 0 &&
                (strcmp(path, others[j]) == 0 || (is_stdout(path) && is_stdout(others[j]))))
                return pm__fail(error, PM_EINVAL, "an image and the rows would both be written to '%.200s'", path);
        for (size_t j = 0; j < i; j++)
            if (strcmp(path, files->items[j].path) == 0)
                return pm__fail(error, PM_EINVAL, "two images would be written to '%.200s'", path);
    }
    return PM_OK;
}

static pm_status open_all(pm__render_files *files, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; status == PM_OK && i < files->images * files->kinds; i++)
        status = pm__sink_open(files->items[i].path, &files->items[i].sink, error);
    return status;
}

pm_status pm__render_files_open(const pm__render_task *task, pm__render_files *files, pm_error *error)
{
    *files = (pm__render_files){.images = task->scene_count * task->estimator_count,
                                .kinds = task->config.aov ? PM__IMAGE_KINDS : 1};
    const size_t count = files->images * files->kinds;
    if (count > MOST_FILES) {
        files->images = 0;
        return pm__fail(error, PM_EINVAL, "%zu image files at once; at most %d", count, (int)MOST_FILES);
    }
    files->items = calloc(count, sizeof *files->items);
    if (!files->items) {
        files->images = 0;
        return pm__fail(error, PM_ENOMEM, "out of memory");
    }
    pm_status status = name_files(task, files, error);
    if (status == PM_OK)
        status = refuse_streams(files, task->settings->output, error);
    if (status == PM_OK)
        status = refuse_same(files, task->settings, error);
    return status == PM_OK ? open_all(files, error) : status;
}

/* The names in a header, so that the names last as long as the writing. */
typedef struct header {
    pm__attribute list[MOST_ATTRIBUTES];
    size_t count;
    char scene[PM__MAX_SPEC], estimator[PM__MAX_SPEC], method[PM__MAX_SPEC], sampler[PM__MAX_SPEC];
    char lookup[48], seed[24];
} header;

static void add_text(header *h, const char *name, const char *text)
{
    if (text)
        h->list[h->count++] = (pm__attribute){.name = name, .text = text};
}

static void add_number(header *h, const char *name, double number)
{
    if (isfinite(number))
        h->list[h->count++] = (pm__attribute){.name = name, .number = number};
}

static void add_estimate(header *h, const pm__render_task *task, const pm__render_row *row)
{
    pm__spec_format(row->estimator, h->estimator, sizeof h->estimator);
    pm__lookup_format(&task->config.lookup, h->lookup);
    add_text(h, "estimator", h->estimator);
    if (task->config.k)
        add_number(h, "k", (double)task->config.k);
    add_number(h, "radius", task->config.radius);
    add_text(h, "lookup", h->lookup);
    add_text(h, "search", task->search);
}

static void make_header(header *h, const pm__render_task *task, const pm__render_row *row)
{
    const pm__settings *const s = task->settings;
    h->count = 0;
    pm__spec_format(row->scene, h->scene, sizeof h->scene);
    pm__spec_format(task->config.method, h->method, sizeof h->method);
    pm__spec_format(&s->samplers.items[0], h->sampler, sizeof h->sampler);
    (void)snprintf(h->seed, sizeof h->seed, "%llu", (unsigned long long)s->seed); /* all 63 bits */
    add_text(h, "software", "photonbench " PM_VERSION);
    add_text(h, "command", s->command_line);
    add_text(h, "seed", h->seed);
    add_text(h, "scene", h->scene);
    add_text(h, "method", h->method);
    if (row->estimator)
        add_estimate(h, task, row);
    add_text(h, "sampler", h->sampler);
    add_number(h, "photons", (double)row->stored);
    add_number(h, "emitted", (double)row->emitted);
    add_number(h, "passes", (double)row->passes);
    add_number(h, "trials", (double)row->trials);
    add_text(h, "truth", row->truth);
    add_number(h, "rel_error_mean", row->mean_error);
    add_number(h, "rel_error_rms", row->rms_error);
    add_number(h, "trace_s", row->trace_s);
    add_number(h, "build_s", row->build_s);
    add_number(h, "image_s", row->image_s);
    add_number(h, "total_s", row->total_s);
    if (strcmp(row->status, "interrupted") == 0)
        add_text(h, "interrupted", row->detail);
}

static const pm__image *image_of(const pm__render_images *images, size_t kind)
{
    const pm__image *const all[PM__IMAGE_KINDS] = {
        [PM__RADIANCE] = &images->radiance, [PM__TRUTHS] = &images->truth, [PM__ERRORS] = &images->error,
        [PM__BIASES] = &images->bias,       [PM__NOISES] = &images->noise, [PM__RADII] = &images->radius,
        [PM__COUNTS] = &images->count};
    return all[kind];
}

/* Why an image that was asked for does not exist. */
static const char *reason(const pm__render_task *task, const pm__render_row *row, size_t kind)
{
    if (strcmp(row->status, "interrupted") == 0)
        return "interrupted before there was any of it";
    if (kind == PM__RADII || kind == PM__COUNTS)
        return "the method makes no estimates";
    if ((kind == PM__BIASES || kind == PM__NOISES) && task->config.trials < 2)
        return "it takes --trials 2 at least";
    if (kind == PM__NOISES)
        return "it takes two complete trials";
    return row->misfit ? "its reference is of 128x128 pixels: it takes a --size that is a multiple of that"
                       : "no truth is known of what it shows";
}

/* One line for each reason, with all that are missing for it. */
static void say_missing(const pm__spec *scene, const char *const reasons[PM__IMAGE_KINDS])
{
    char name[PM__MAX_SPEC], names[80] = "";
    pm__spec_format_short(scene, name, sizeof name);
    for (size_t kind = 0; kind < PM__IMAGE_KINDS; kind++) {
        size_t other = 0;
        if (!reasons[kind])
            continue;
        while (reasons[other] != reasons[kind])
            other++;
        if (other < kind)
            continue; /* told with that one */
        *names = '\0';
        for (; other < PM__IMAGE_KINDS; other++)
            if (reasons[other] == reasons[kind])
                (void)snprintf(names + strlen(names), sizeof names - strlen(names), "%s%s", *names ? ", " : "",
                               *kinds[other].suffix ? kinds[other].suffix + 1 : "the radiance");
        pm__complain("render", "%s: no image of %s: %s", name, names, reasons[kind]);
    }
}

/* What the system said of the file tells more than that it could not be written. */
static pm_status give_up(pm__sink *sink, pm_status status, pm_error *error)
{
    pm_error reason_of_file = {""};
    if (ferror(pm__sink_file(sink)) && pm__sink_close(sink, &reason_of_file) != PM_OK)
        return pm__fail(error, PM_EIO, "%s", reason_of_file.text);
    pm__sink_discard(sink);
    return status;
}

static pm_status write_file(pm__render_file *file, const pm__image *image, bool half, header *h, size_t kind,
                            pm_error *error)
{
    const size_t before = h->count;
    add_text(h, "content", kinds[kind].content);
    const pm_status status = pm__exr_write(pm__sink_file(&file->sink), image, half, h->list, h->count, error);
    h->count = before;
    return status == PM_OK ? pm__sink_close(&file->sink, error) : give_up(&file->sink, status, error);
}

pm_status pm__render_files_write(pm__render_files *files, const pm__render_task *task, size_t index,
                                 const pm__render_images *images, pm__render_row *row, pm_error *error)
{
    pm__render_file *const file = &files->items[index * files->kinds];
    const char *reasons[PM__IMAGE_KINDS] = {NULL};
    pm_status status = PM_OK;
    header h;
    make_header(&h, task, row);
    for (size_t kind = 0; status == PM_OK && kind < files->kinds; kind++) {
        const pm__image *const image = image_of(images, kind);
        if (image->values) {
            status = write_file(&file[kind], image, task->settings->render.half, &h, kind, error);
        } else {
            reasons[kind] = reason(task, row, kind);
            pm__sink_discard(&file[kind].sink);
        }
    }
    if (status == PM_OK && image_of(images, PM__RADIANCE)->values)
        row->file = file->path;
    if (!task->settings->quiet && index % task->estimator_count == 0) /* the same for all of the scene */
        say_missing(row->scene, reasons);
    return status;
}

void pm__render_files_free(pm__render_files *files)
{
    for (size_t i = 0; files->items && i < files->images * files->kinds; i++) {
        pm__sink_discard(&files->items[i].sink);
        free(files->items[i].path);
    }
    free(files->items);
    *files = (pm__render_files){.images = 0};
}
