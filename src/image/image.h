/* Images in memory, and OpenEXR files of them: scanlines, ZIP, 32-bit float, through OpenEXR's C API. */
#ifndef PM_IMAGE_IMAGE_H
#define PM_IMAGE_IMAGE_H

#include "../base/status.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { PM__MOST_PIXELS = 1 << 28, PM__LONGEST_SIDE = 1 << 20 }; /* of an image */

typedef struct pm__image {
    size_t width, height;
    int channels;  /* 3: R G B; 1: Y */
    float *values; /* row by row from the top, a pixel's channels together */
} pm__image;

/* All 0. ENOMEM; EINVAL for no pixels or too many, or neither 1 nor 3 channels. *image is then empty. */
pm_status pm__image_create(size_t width, size_t height, int channels, pm__image *image, pm_error *error);
void pm__image_free(pm__image *image); /* an empty one is allowed */

/* Header attributes, beside those that the format wants: a name has 1 to 31 bytes and is none of the format's own. */
typedef struct pm__attribute {
    const char *name;
    const char *text; /* NULL: a number */
    double number;
} pm__attribute;

/* Writes the image to an open file, which need not be seekable, and flushes it. half: 16-bit floats instead, rounded to
 * nearest, ties to even, from 65520 on to infinity. Values that are not finite are written as they are. The same image
 * and attributes give the same bytes. Holds the whole file in memory. EIO, ENOMEM, EINVAL for an empty image or an
 * attribute that the format does not take; the file's owner checks its close. */
pm_status pm__exr_write(FILE *file, const pm__image *image, bool half, const pm__attribute *attributes, size_t count,
                        pm_error *error);

/* Reads R G B or Y (any pixel type, other channels passed over) from a file, or from memory that `name` stands for in
 * messages: one part of scanlines, no channel subsampled, compressed without loss or as PXR24. The image is the data
 * window. Whatever the bytes, memory stays below a fixed multiple of their number, and *image is whole or empty. EIO,
 * EFORMAT (error names the file and what was expected), ENOMEM. */
pm_status pm__exr_read(const char *path, pm__image *image, pm_error *error);
pm_status pm__exr_read_memory(const void *bytes, size_t size, const char *name, pm__image *image, pm_error *error);

/* A text attribute of the file's header, or a number's spelling that reads back exactly. ENAME: there is none of that
 * name and kind. EINVAL: it takes more than `size` bytes with its NUL. Else as pm__exr_read. */
pm_status pm__exr_attribute(const char *path, const char *name, char *text, size_t size, pm_error *error);

/* Gives each attribute that is text or a number (spelt so) to `take`, by name, from a file in memory as above. The text
 * may hold any bytes, has no NUL of its own at the end, and is there for the call alone. EFORMAT, ENOMEM. */
typedef void pm__attribute_taker(void *context, const char *name, const char *text, size_t length);
pm_status pm__exr_each_attribute(const void *bytes, size_t size, const char *name, pm__attribute_taker *take,
                                 void *context, pm_error *error);

#endif
