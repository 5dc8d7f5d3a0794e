/* Images: reduced to what a page shows, and packed again as OpenEXR of 16-bit floats. */
#include "report.h"

#include "../base/memory.h"
#include "../image/image.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define LARGEST_HALF 65504.0F

enum { MOST_ATTRIBUTES = 64, LONGEST_ATTRIBUTE = 4096 /* bytes */ };

static size_t smaller(size_t a, size_t b)
{
    return a < b ? a : b;
}

/* The mean over a block of pixels, which is cut off at the image's right and lower edge. One that is not finite makes
 * the mean so: a truth that is known in part only is not known. */
static float mean_of_block(const pm__image *from, size_t x, size_t y, size_t side, size_t channel)
{
    const size_t channels = (size_t)from->channels;
    const size_t right = smaller(x + side, from->width), bottom = smaller(y + side, from->height);
    double sum = 0.0;
    for (size_t row = y; row < bottom; row++)
        for (size_t column = x; column < right; column++)
            sum += (double)from->values[(row * from->width + column) * channels + channel];
    return (float)(sum / (double)((right - x) * (bottom - y)));
}

static pm_status reduce(pm__image *image, pm_error *error)
{
    const size_t longest = image->width > image->height ? image->width : image->height;
    const size_t side = (longest + PM__REPORT_SIDE - 1) / PM__REPORT_SIDE, channels = (size_t)image->channels;
    pm__image small;
    if (side == 1)
        return PM_OK;
    const pm_status status = pm__image_create((image->width + side - 1) / side, (image->height + side - 1) / side,
                                              image->channels, &small, error);
    if (status != PM_OK)
        return status;
    for (size_t y = 0; y < small.height; y++)
        for (size_t x = 0; x < small.width; x++)
            for (size_t c = 0; c < channels; c++)
                small.values[(y * small.width + x) * channels + c] =
                    mean_of_block(image, x * side, y * side, side, c);
    pm__image_free(image);
    *image = small;
    return PM_OK;
}

/* Brighter than a 16-bit float can be is as bright as it can be: infinite pixels could not be looked at. */
static size_t clip(pm__image *image)
{
    size_t clipped = 0;
    for (size_t i = 0; i < image->width * image->height * (size_t)image->channels; i++)
        if (isfinite(image->values[i]) && fabsf(image->values[i]) > LARGEST_HALF) {
            image->values[i] = copysignf(LARGEST_HALF, image->values[i]);
            clipped++;
        }
    return clipped;
}

static pm_status pack(const pm__image *image, pm__report_image *kept, pm_error *error)
{
    char *bytes = NULL;
    size_t size = 0;
    FILE *const file = open_memstream(&bytes, &size);
    if (!file)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm_status status = pm__exr_write(file, image, true, NULL, 0, error);
    if (fclose(file) != 0 && status == PM_OK)
        status = pm__fail(error, PM_ENOMEM, "out of memory");
    kept->exr = (unsigned char *)bytes;
    kept->exr_size = size;
    return status == PM_EIO ? PM_ENOMEM : status; /* the file is memory */
}

static void keep_attribute(void *context, const char *name, const char *text, size_t length)
{
    json_t *const attributes = context;
    if (json_object_size(attributes) < MOST_ATTRIBUTES && length <= LONGEST_ATTRIBUTE)
        (void)json_object_set_new(attributes, name, pm__report_text(text, length));
}

static pm_status load(const char *path, const char *bytes, size_t size, pm__report_image *kept, pm_error *error)
{
    pm__image image = {0};
    kept->attributes = json_object();
    if (!kept->attributes)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm_status status = pm__exr_each_attribute(bytes, size, path, keep_attribute, kept->attributes, error);
    if (status == PM_OK)
        status = pm__exr_read_memory(bytes, size, path, &image, error);
    if (status == PM_OK)
        status = reduce(&image, error);
    if (status == PM_OK) {
        const size_t clipped = clip(&image);
        if (clipped)
            (void)json_object_set_new(kept->attributes, "clipped", json_sprintf("%zu", clipped));
        kept->width = image.width;
        kept->height = image.height;
        kept->channels = image.channels;
        status = pack(&image, kept, error);
    }
    pm__image_free(&image);
    return status;
}

/* What may stand in a link and in any file system. */
static void name_file(const char *path, char file[PM__NAME_SIZE])
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789=._-";
    const char *const slash = strrchr(path, '/');
    pm__quote_path(slash ? slash + 1 : path, file);
    for (char *p = file; *(p += strspn(p, plain)); p++)
        *p = '-';
    if (*file == '.') /* would be hidden */
        *file = '-';
}

static bool same_pixels(const pm__report_image *a, const pm__report_image *b)
{
    return strcmp(a->scene, b->scene) == 0 && a->exr_size == b->exr_size && memcmp(a->exr, b->exr, a->exr_size) == 0;
}

/* A truth comes with each estimator's image. */
static bool is_known_truth(const pm__report *report, const pm__report_image *image)
{
    for (size_t i = 0; i < report->image_count; i++)
        if (strcmp(image->kind, "truth") == 0 && strcmp(report->images[i].kind, "truth") == 0 &&
            same_pixels(&report->images[i], image))
            return true;
    return false;
}

static pm_status refuse_twice(const pm__report *report, const pm__report_image *image, pm_error *error)
{
    for (size_t i = 0; i < report->image_count; i++)
        if (strcmp(report->images[i].file, image->file) == 0)
            return pm__fail(error, PM_EINVAL, "two images are called %s: each needs a name of its own", image->file);
    return PM_OK;
}

static pm_status add(pm__report *report, const pm__report_image *image, pm_error *error)
{
    void *images = report->images;
    const int refused = pm__grow(&images, &report->image_capacity, report->image_count + 1, sizeof *image);
    report->images = images;
    if (refused)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    report->images[report->image_count++] = *image;
    return PM_OK;
}

pm_status pm__report_add_image(pm__report *report, const char *path, char *bytes, size_t size, pm_error *error)
{
    pm__report_image image = {.kind = "other"};
    char stem[PM__NAME_SIZE];
    name_file(path, image.file);
    memcpy(stem, image.file, sizeof stem);
    const size_t length = strlen(stem);
    if (length > 4 && strcmp(stem + length - 4, ".exr") == 0)
        stem[length - 4] = '\0';
    pm_status status = refuse_twice(report, &image, error);
    if (status == PM_OK)
        status = load(path, bytes, size, &image, error);
    free(bytes);
    if (status == PM_OK) {
        pm__report_describe(&image, stem);
        if (!is_known_truth(report, &image)) {
            status = add(report, &image, error);
            if (status == PM_OK)
                return PM_OK;
        }
    }
    free(image.exr);
    json_decref(image.attributes);
    return status;
}
