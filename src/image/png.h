/* PNG files of colours, for people to look at: 8 bits a channel, through libpng. */
#ifndef PM_IMAGE_PNG_H
#define PM_IMAGE_PNG_H

#include "../base/status.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* pixels: R G B, row by row from the top. title, description: texts of the file, NULL: none. The same pixels and texts
 * give the same bytes with the same library. EIO; ENOMEM; EINVAL: no pixels, or too many. The file's owner checks its
 * close. */
pm_status pm__png_write(FILE *file, const uint8_t (*pixels)[3], size_t width, size_t height, const char *title,
                        const char *description, pm_error *error);

#endif
