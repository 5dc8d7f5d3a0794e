/* Files of what metrics found in each pixel: numbers (OpenEXR) and false colour (PNG). */
#include "compare_images.h"
#include "file_names.h"
#include "results.h"
#include "same_file.h"
#include "version.h"

#include "../image/false_colour.h"
#include "../image/png.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { TEXT = 300, EXTENSIONS = 2 };
static const char *const extensions[EXTENSIONS] = {"exr", "png"};
static const double least_shown = 1e-3; /* of what ends at 1 */

int pm__map_path(const char *name, const pm__spec *metric, const char *extension, char **path)
{
    char safe[PM__MAX_SPEC];
    pm__safe_name(metric, safe, sizeof safe);
    const int written = asprintf(path, "%.*s.%s.%s", pm__stem_length(name), name, safe, extension);
    if (written < 0)
        *path = NULL;
    return written < 0 ? -1 : 0;
}

static pm_status check_path(const pm__settings *s, const char *path, bool open, pm_error *error)
{
    const char *const taken[] = {s->operands[0], s->operands[1], s->json, s->csv, s->markdown};
    for (size_t i = 0; i < sizeof taken / sizeof *taken; i++)
        if (taken[i] && pm__same_file(taken[i], path))
            return pm__fail(error, PM_EINVAL, "-o: its '%.200s' would take the place of '%.200s'", path, taken[i]);
    pm__sink sink;
    const pm_status status = open ? pm__sink_open(path, &sink, error) : PM_OK;
    if (status == PM_OK && open)
        pm__sink_discard(&sink);
    return status;
}

pm_status pm__maps_check(const pm__settings *s, pm_error *error)
{
    pm_status status = PM_OK;
    if (s->output && strcmp(s->output, "-") == 0)
        return pm__fail(error, PM_EINVAL, "-o: maps are several files, and '-' is no name for them");
    for (size_t i = 0; s->output && i < EXTENSIONS * s->metrics.count && status == PM_OK; i++) {
        char *path;
        if (pm__map_path(s->output, &s->metrics.items[i / EXTENSIONS], extensions[i % EXTENSIONS], &path))
            return pm__fail(error, PM_ENOMEM, "out of memory");
        status = check_path(s, path, i == 0, error);
        free(path);
    }
    return status;
}

static pm_status write_exr(FILE *file, const pm__settings *s, const pm__spec *metric, const pm__measured *m,
                           const char *a, const char *b, const pm__image *image, pm_error *error)
{
    char name[PM__MAX_SPEC];
    pm__spec_format(metric, name, sizeof name);
    const pm__attribute list[] = {{"software", "photonbench " PM_VERSION, 0.0},
                                  {"command", s->command_line, 0.0},
                                  {"metric", name, 0.0},
                                  {"tested", a, 0.0},
                                  {"reference", b, 0.0},
                                  {"unit", *m->unit ? m->unit : "1", 0.0},
                                  {"mean", NULL, m->mean}};
    return pm__exr_write(file, image, false, list, sizeof list / sizeof *list, error);
}

/* One scale for all images where the metric has an end; dissimilarity where larger is better. */
static pm_status write_png(FILE *file, const pm__spec *metric, const pm__measured *m, pm__image *image,
                           pm_error *error)
{
    char text[TEXT];
    pm__picture picture;
    double low = least_shown, high = 1.0;
    for (size_t p = 0; m->larger_is_better && p < image->width * image->height; p++)
        image->values[p] = (float)(1.0 - m->map[p]);
    if (!m->within_1)
        pm__colour_range(image, &low, &high);
    (void)snprintf(text, sizeof text, "%s%s, logarithmic: %g dark blue to %g red; dark grey: 0",
                   m->larger_is_better ? "1 - " : "", metric->entry->name, low, high);
    pm_status status = pm__colour_scale(image, low, high, &picture, error);
    if (status == PM_OK)
        status = pm__png_write(file, (const uint8_t(*)[3])picture.pixels, picture.width, picture.height,
                               metric->entry->name, text, error);
    pm__picture_free(&picture);
    return status;
}

pm_status pm__maps_write(const pm__settings *s, const pm__spec *metric, const pm__measured *m, const char *a,
                         const char *b, pm_error *error)
{
    pm__image image;
    pm_status status = pm__measured_image(m, &image, error);
    for (int i = 0; i < EXTENSIONS && status == PM_OK; i++) {
        pm__sink sink = {.wanted = false};
        char *path = NULL;
        status = pm__map_path(s->output, metric, extensions[i], &path) ? pm__fail(error, PM_ENOMEM, "out of memory")
                                                                       : pm__sink_open(path, &sink, error);
        if (status == PM_OK) {
            FILE *const file = pm__sink_file(&sink);
            status = i ? write_png(file, metric, m, &image, error) : write_exr(file, s, metric, m, a, b, &image, error);
            if (status == PM_OK)
                status = pm__sink_close(&sink, error);
            else
                pm__sink_discard(&sink);
        }
        free(path);
    }
    pm__image_free(&image);
    return status;
}
