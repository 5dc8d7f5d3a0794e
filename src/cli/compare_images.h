/* What `compare` does with two images: metrics, their maps as files. */
#ifndef PM_CLI_COMPARE_IMAGES_H
#define PM_CLI_COMPARE_IMAGES_H

#include "../base/quote.h"
#include "../metrics/metrics.h"
#include "options.h"

/* Does the path lead to an OpenEXR image? Only a regular file is asked: what a pipe gives is gone once it was read. */
bool pm__is_image_file(const char *path);

/* The exit status of comparing the images that the two operands name; what goes wrong is said. */
int pm__compare_images(pm__settings *settings);

/* -1: out of memory; else NAME.METRIC.EXTENSION into *path, the caller's (free). compare_maps.c */
int pm__map_path(const char *name, const pm__spec *metric, const char *extension, char **path);

/* Can maps be written? Before the work. EINVAL: one would take the place of a file that is read or written by another
 * option; EIO, ENOMEM. compare_maps.c */
pm_status pm__maps_check(const pm__settings *settings, pm_error *error);

/* Writes the map of one metric as NAME.METRIC.exr and .png. a, b: the images' names. EIO, ENOMEM. compare_maps.c */
pm_status pm__maps_write(const pm__settings *settings, const pm__spec *metric, const pm__measured *measured,
                         const char *a, const char *b, pm_error *error);

extern const pm__option pm__compare_option_metric, pm__compare_option_output;

#endif
