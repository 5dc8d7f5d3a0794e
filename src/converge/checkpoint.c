#include "checkpoint.h"

#include "../base/quote.h"

#include <errno.h>
#include <fcntl.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static const char magic[16] = {'p', 'h', 'o', 't', 'o', 'n', 'b', 'e', 'n', 'c', 'h', '-', 'c', 'k', 'p', 't'};
static const uint32_t order = 0x04030201, format = 1;
enum { NUMBER = 8, HEADER = sizeof magic + 2 * sizeof(uint32_t) + NUMBER, SMALLEST = HEADER + 4 * NUMBER };

/* FNV-1a: every byte changes the sum in a way that can be undone, so a single wrong byte is always seen. */
static const uint64_t fnv_start = 0xcbf29ce484222325ull, fnv_prime = 0x100000001b3ull;

static uint64_t add_to_sum(uint64_t sum, const void *bytes, size_t count)
{
    const unsigned char *const b = bytes;
    for (size_t i = 0; i < count; i++)
        sum = (sum ^ b[i]) * fnv_prime;
    return sum;
}

/* ---- Writing ----------------------------------------------------------------------------------- */

typedef struct pen {
    FILE *file;
    uint64_t sum;
} pen;

static void put(pen *p, const void *bytes, size_t count)
{
    if (count)
        (void)fwrite(bytes, 1, count, p->file);
    p->sum = add_to_sum(p->sum, bytes, count);
}

static void put_number(pen *p, uint64_t value)
{
    put(p, &value, sizeof value);
}

static void put_text(pen *p, const char *text)
{
    put_number(p, strlen(text));
    put(p, text, strlen(text));
}

static uint64_t size_of(const pm__checkpoint *c)
{
    uint64_t size = SMALLEST + strlen(c->version) + strlen(c->asked);
    for (size_t i = 0; i < c->count; i++)
        size += 2 * NUMBER + c->parts[i].saved.count;
    return size;
}

void pm__checkpoint_write(FILE *file, const pm__checkpoint *checkpoint)
{
    pen p = {file, fnv_start};
    put(&p, magic, sizeof magic);
    put(&p, &order, sizeof order);
    put(&p, &format, sizeof format);
    put_number(&p, size_of(checkpoint));
    put_text(&p, checkpoint->version);
    put_text(&p, checkpoint->asked);
    put_number(&p, checkpoint->count);
    for (size_t i = 0; i < checkpoint->count; i++) {
        const pm__checkpoint_part *const part = &checkpoint->parts[i];
        put_number(&p, part->done);
        put_number(&p, part->saved.count);
        put(&p, part->saved.bytes, part->saved.count);
    }
    const uint64_t sum = p.sum;
    put_number(&p, sum);
}

/* ---- Reading ----------------------------------------------------------------------------------- */

typedef struct page {
    char name[PM__NAME_SIZE];
    unsigned char *bytes;
    size_t at, count;
} page;

static pm_status refuse(const page *p, uint64_t at, const char *expected, pm_error *error)
{
    return pm__fail(error, PM_EFORMAT, "%s, byte %" PRIu64 ": expected %s", p->name, at, expected);
}

static pm_status refuse_number(const page *p, uint64_t at, const char *what, uint64_t wanted, uint64_t found,
                               pm_error *error)
{
    return pm__fail(error, PM_EFORMAT, "%s, byte %" PRIu64 ": expected %s %" PRIu64 ", found %" PRIu64, p->name, at,
                    what, wanted, found);
}

/* Up to `count` bytes; how many there were, or -1 with errno. */
static ssize_t read_all(int fd, unsigned char *bytes, size_t count)
{
    size_t done = 0;
    while (done < count) {
        const ssize_t got = read(fd, bytes + done, count - done);
        if (got == 0)
            break;
        if (got < 0 && errno != EINTR)
            return -1;
        done += got > 0 ? (size_t)got : 0;
    }
    return (ssize_t)done;
}

/* What tells the file from others: it is looked at before memory is taken for the rest. size: of the file. */
static pm_status check_header(const page *p, const unsigned char *header, uint64_t size, pm_error *error)
{
    uint32_t found_order, found_format;
    uint64_t found_size;
    if (size < sizeof magic || memcmp(header, magic, sizeof magic) != 0)
        return refuse(p, 0, "a checkpoint of photonbench", error);
    if (size < SMALLEST)
        return refuse_number(p, size, "at least as many bytes as", SMALLEST, size, error);
    memcpy(&found_order, header + sizeof magic, sizeof found_order);
    memcpy(&found_format, header + sizeof magic + 4, sizeof found_format);
    memcpy(&found_size, header + sizeof magic + 8, sizeof found_size);
    if (found_order != order)
        return refuse(p, sizeof magic, "the byte order of this machine", error);
    if (found_format != format)
        return refuse_number(p, sizeof magic + 4, "format", format, found_format, error);
    if (found_size != size)
        return refuse_number(p, found_size < size ? found_size : size, "a file of as many bytes as", found_size, size,
                             error);
    return PM_OK;
}

static pm_status read_file(int fd, page *p, pm_error *error)
{
    struct stat status;
    unsigned char header[HEADER] = {0};
    if (fstat(fd, &status) != 0)
        return pm__fail(error, PM_EIO, "%s: cannot be read: %s", p->name, strerror(errno));
    if (!S_ISREG(status.st_mode))
        return pm__fail(error, PM_EIO, "%s: cannot be read: it is no regular file", p->name);
    const uint64_t size = (uint64_t)status.st_size;
    ssize_t got = read_all(fd, header, sizeof header);
    const pm_status known = got < 0 ? PM_OK : check_header(p, header, size, error);
    if (known != PM_OK)
        return known;
    p->bytes = got < 0 ? NULL : malloc(size);
    if (got >= 0 && !p->bytes)
        return pm__fail(error, PM_ENOMEM, "%s: out of memory for %" PRIu64 " bytes", p->name, size);
    if (got >= 0) {
        memcpy(p->bytes, header, sizeof header);
        got = read_all(fd, p->bytes + sizeof header, size - sizeof header);
    }
    if (got < 0)
        return pm__fail(error, PM_EIO, "%s: cannot be read: %s", p->name, strerror(errno));
    p->count = (size_t)got + sizeof header;
    return p->count == size ? PM_OK : refuse_number(p, p->count, "a file of as many bytes as", size, p->count, error);
}

/* The sum comes first: what it covers is then as it was written, and lengths within are no accident. */
static pm_status check_sum(page *p, pm_error *error)
{
    uint64_t found;
    p->count -= sizeof found;
    memcpy(&found, p->bytes + p->count, sizeof found);
    const uint64_t sum = add_to_sum(fnv_start, p->bytes, p->count);
    if (sum == found)
        return PM_OK;
    return pm__fail(error, PM_EFORMAT,
                    "%s, byte %zu: expected the checksum %016" PRIx64 " of what stands before, found %016" PRIx64
                    ": the file is damaged",
                    p->name, p->count, sum, found);
}

static pm_status take_number(page *p, const char *what, uint64_t most, uint64_t *value, pm_error *error)
{
    if (p->count - p->at < sizeof *value)
        return refuse(p, p->at, what, error);
    memcpy(value, p->bytes + p->at, sizeof *value);
    if (*value > most)
        return pm__fail(error, PM_EFORMAT, "%s, byte %zu: expected %s of at most %" PRIu64 ", found %" PRIu64, p->name,
                        p->at, what, most, *value);
    p->at += sizeof *value;
    return PM_OK;
}

/* As many bytes as stand before them; NUL-terminated, *bytes is the caller's. */
static pm_status take_bytes(page *p, const char *what, unsigned char **bytes, size_t *count, pm_error *error)
{
    uint64_t length = 0;
    const size_t left = p->count - p->at;
    const pm_status status = take_number(p, what, left < NUMBER ? 0 : left - NUMBER, &length, error);
    if (status != PM_OK)
        return status;
    *bytes = malloc(length + 1);
    if (!*bytes)
        return pm__fail(error, PM_ENOMEM, "%s: out of memory for %" PRIu64 " bytes", p->name, length);
    memcpy(*bytes, p->bytes + p->at, length);
    (*bytes)[length] = '\0';
    *count = length;
    p->at += length;
    return PM_OK;
}

static pm_status take_text(page *p, const char *what, char **text, pm_error *error)
{
    unsigned char *bytes = NULL;
    size_t count = 0;
    const size_t start = p->at;
    const pm_status status = take_bytes(p, what, &bytes, &count, error);
    *text = (char *)bytes;
    return status == PM_OK && strlen(*text) != count ? refuse(p, start + NUMBER, "text", error) : status;
}

static pm_status take_part(page *p, pm__checkpoint_part *part, pm_error *error)
{
    uint64_t done = 0;
    pm_status status = take_number(p, "0 or 1, whether a series is done, a number", 1, &done, error);
    part->done = done != 0;
    part->offset = p->at + NUMBER;
    if (status == PM_OK)
        status = take_bytes(p, "the length of a series", &part->saved.bytes, &part->saved.count, error);
    return status;
}

static pm_status take_all(page *p, pm__checkpoint *c, pm_error *error)
{
    uint64_t count = 0;
    p->at = HEADER;
    pm_status status = take_text(p, "the length of the version", &c->version, error);
    if (status == PM_OK)
        status = take_text(p, "the length of the options", &c->asked, error);
    if (status == PM_OK)
        status = take_number(p, "a number of series", (p->count - p->at) / (2 * NUMBER), &count, error);
    c->parts = status == PM_OK ? calloc(count + 1, sizeof *c->parts) : NULL;
    if (status == PM_OK && !c->parts)
        status = pm__fail(error, PM_ENOMEM, "%s: out of memory for %" PRIu64 " series", p->name, count);
    while (status == PM_OK && c->count < count)
        status = take_part(p, &c->parts[c->count++], error);
    return status == PM_OK && p->at != p->count ? refuse(p, p->at, "the checksum", error) : status;
}

pm_status pm__checkpoint_read(const char *path, pm__checkpoint *checkpoint, pm_error *error)
{
    page p = {.bytes = NULL};
    *checkpoint = (pm__checkpoint){.count = 0};
    pm__quote_path(path, p.name);
    const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
    if (fd < 0)
        return pm__fail(error, PM_EIO, "%s: cannot be opened: %s", p.name, strerror(errno));
    pm_status status = read_file(fd, &p, error);
    (void)close(fd);
    if (status == PM_OK)
        status = check_sum(&p, error);
    if (status == PM_OK)
        status = take_all(&p, checkpoint, error);
    free(p.bytes);
    if (status != PM_OK)
        pm__checkpoint_free(checkpoint);
    return status;
}

void pm__checkpoint_free(pm__checkpoint *checkpoint)
{
    for (size_t i = 0; i < checkpoint->count; i++)
        free(checkpoint->parts[i].saved.bytes);
    free(checkpoint->parts);
    free(checkpoint->version);
    free(checkpoint->asked);
    *checkpoint = (pm__checkpoint){.count = 0};
}
