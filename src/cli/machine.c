/* What the numbers were measured on. */
#include "results.h"
#include "parallel.h"
#include "refused.h"

#include "../search/wide.h"

#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#ifndef PM_BUILD_FLAGS
#define PM_BUILD_FLAGS ""
#endif

#if defined(__clang__)
#define COMPILER "clang " __clang_version__
#elif defined(__GNUC__)
#define COMPILER "gcc " __VERSION__
#else
#define COMPILER "unknown"
#endif

/* The first line of a file that starts with `prefix`, from its value on; freed by the caller. NULL if there is none. */
static char *find_line(const char *path, const char *prefix)
{
    FILE *const file = fopen(path, "r");
    char *line = NULL, *found = NULL;
    size_t size = 0;
    if (!file && errno == ENOMEM)
        pm__refused_note();
    if (!file)
        return NULL;
    while (!found && getline(&line, &size, file) > 0) {
        if (strncmp(line, prefix, strlen(prefix)) != 0)
            continue;
        const char *const value = line + strlen(prefix) + strspn(line + strlen(prefix), " \t:");
        if (!pm__refused_if_null(found = strndup(value, strcspn(value, "\n"))))
            break;
    }
    free(line);
    (void)fclose(file);
    return found;
}

/* Owned text as JSON, null for NULL. */
static json_t *text_or_null(char *text)
{
    json_t *const value = text ? json_string(text) : NULL;
    free(text);
    return value ? value : json_null();
}

/* The width that maps use unless told otherwise. */
static char *simd_width(void)
{
    pm_simd simd;
    return pm__choose_simd(PM_SIMD_AUTO, &simd, NULL) == PM_OK
               ? pm__refused_if_null(strdup(pm__simd_name(simd)))
               : NULL;
}

/* The number at the start of a file's line, in units of `unit`; INFINITY where there is none. */
static double bytes_in(const char *path, const char *prefix, double unit)
{
    char *const line = find_line(path, prefix), *end = NULL;
    const double number = line ? strtod(line, &end) : 0.0;
    const bool found = line && end != line;
    free(line);
    return found ? unit * number : INFINITY;
}

double pm__free_memory(void)
{
    const double group = fmin(bytes_in("/sys/fs/cgroup/memory.max", "", 1.0),
                              bytes_in("/sys/fs/cgroup/memory/memory.limit_in_bytes", "", 1.0));
    const double free_bytes = fmin(bytes_in("/proc/meminfo", "MemAvailable", 1024.0), group);
    return isfinite(free_bytes) ? free_bytes : 0.0;
}

json_t *pm__machine(void)
{
    double load;
    json_t *const machine = json_object();
    (void)json_object_set_new(machine, "cpu", text_or_null(find_line("/proc/cpuinfo", "model name")));
    (void)json_object_set_new(machine, "cores", json_integer(pm__usable_processors()));
    (void)json_object_set_new(machine, "simd", text_or_null(simd_width()));
    (void)json_object_set_new(machine, "governor",
                              text_or_null(find_line("/sys/devices/system/cpu/cpu0/cpufreq/scaling_governor", "")));
    (void)json_object_set_new(machine, "load", getloadavg(&load, 1) == 1 ? json_real(load) : json_null());
    (void)json_object_set_new(machine, "compiler", json_string(COMPILER));
    (void)json_object_set_new(machine, "flags", json_string(PM_BUILD_FLAGS));
    return machine;
}
