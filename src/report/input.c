/* Files in: read whole, told apart by their first bytes, checked. */
#include "report.h"

#include "../base/memory.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 1 << 16, MOST_JSON = 1 << 28 /* bytes */, BLANKS_SEEN = 64 };

static const unsigned char exr_magic[4] = {0x76, 0x2f, 0x31, 0x01};

static pm_status cannot_read(const char *name, int number, pm_error *error)
{
    return pm__fail(error, number == ENOMEM ? PM_ENOMEM : PM_EIO, "%s: cannot be read: %s", name,
                    strerror(number ? number : EIO));
}

/* A first look, so that what has no end and is neither is not waited for. */
static pm_status tell_apart(const char *name, const char *bytes, size_t size, bool *is_image, pm_error *error)
{
    size_t blanks = 0;
    *is_image = size >= sizeof exr_magic && memcmp(bytes, exr_magic, sizeof exr_magic) == 0;
    if (*is_image)
        return PM_OK;
    while (blanks < size && blanks < BLANKS_SEEN && strchr(" \t\r\n", bytes[blanks]) && bytes[blanks])
        blanks++;
    if (blanks < size && bytes[blanks] == '{')
        return PM_OK;
    if (size == 0)
        return pm__fail(error, PM_EFORMAT, "%s: expected a result file (JSON) or an OpenEXR image, found nothing",
                        name);
    return pm__fail(error, PM_EFORMAT, "%s: byte %zu: expected {, which begins a result file, or an OpenEXR image",
                    name, blanks);
}

static pm_status read_stream(FILE *stream, const char *name, char **bytes, size_t *size, bool *is_image,
                             pm_error *error)
{
    size_t capacity = 0;
    void *buffer = NULL;
    pm_status status = PM_OK;
    for (bool ended = false; status == PM_OK && !ended;) {
        const bool first = *size == 0;
        if (pm__grow(&buffer, &capacity, first ? FIRST_CAPACITY : *size + 1, 1) != 0)
            status = pm__fail(error, PM_ENOMEM, "%s: no memory for its bytes", name);
        if (status != PM_OK)
            break;
        errno = 0;
        *size += fread((char *)buffer + *size, 1, capacity - *size, stream);
        ended = *size < capacity;
        if (ended && ferror(stream))
            status = cannot_read(name, errno, error);
        else if (first)
            status = tell_apart(name, buffer, *size, is_image, error);
        if (status == PM_OK && !*is_image && *size > MOST_JSON)
            status = pm__fail(error, PM_EFORMAT, "%s: expected at most %d bytes of JSON", name, (int)MOST_JSON);
    }
    if (status != PM_OK) {
        free(buffer);
        buffer = NULL;
    }
    *bytes = buffer;
    return status;
}

pm_status pm__report_read_file(const char *path, char **bytes, size_t *size, bool *is_image, pm_error *error)
{
    char name[PM__NAME_SIZE];
    pm__quote_path(path, name);
    *bytes = NULL;
    *size = 0;
    FILE *const stream = fopen(path, "rbe");
    if (!stream)
        return cannot_read(name, errno, error);
    const pm_status status = read_stream(stream, name, bytes, size, is_image, error);
    (void)fclose(stream);
    return status;
}

pm_status pm__report_add(pm__report *report, const char *path, pm_error *error)
{
    char *bytes;
    size_t size;
    bool is_image;
    const pm_status status = pm__report_read_file(path, &bytes, &size, &is_image, error);
    if (status != PM_OK)
        return status;
    return (is_image ? pm__report_add_image : pm__report_add_result)(report, path, bytes, size, error);
}

void pm__report_free(pm__report *report)
{
    for (size_t i = 0; i < report->result_count; i++) {
        free(report->results[i].text);
        json_decref(report->results[i].root);
    }
    for (size_t i = 0; i < report->image_count; i++) {
        free(report->images[i].exr);
        json_decref(report->images[i].attributes);
    }
    free(report->results);
    free(report->images);
    memset(report, 0, sizeof *report);
}
