#include "file_names.h"

#include <stdbool.h>
#include <stdio.h>
#include <string.h>

enum { SCENE_PREFIX = sizeof "scene:" - 1 };

void pm__safe_name(const pm__spec *spec, char *text, size_t size)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789=._-";
    char name[PM__MAX_SPEC];
    pm__spec_format_short(spec, name, sizeof name);
    (void)snprintf(text, size, "%s", name + (strncmp(name, "scene:", SCENE_PREFIX) == 0 ? SCENE_PREFIX : 0));
    for (char *p = text; *(p += strspn(p, plain)); p++)
        *p = '-';
}

int pm__stem_length(const char *path)
{
    const size_t length = strlen(path);
    const bool known = length > 4 && (strcmp(path + length - 4, ".exr") == 0 || strcmp(path + length - 4, ".png") == 0);
    return (int)(known ? length - 4 : length);
}
