/* Names of the files that commands write beside each other. */
#ifndef PM_CLI_FILE_NAMES_H
#define PM_CLI_FILE_NAMES_H

#include "../base/param.h"

#include <stddef.h>

/* A spec as a part of a file's name: without `scene:`, only the parameters that are not the defaults, so that names
 * stay short, and stay when a thing learns another one. Characters outside A-Za-z0-9=._- become -. */
void pm__safe_name(const pm__spec *spec, char *text, size_t size);

/* The length of a path without the .exr or .png that it may end in. */
int pm__stem_length(const char *path);

#endif
