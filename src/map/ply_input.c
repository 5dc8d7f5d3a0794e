#include "ply_input.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { BUFFER = 1 << 16 };

static pm_status io_error(const pm__ply_input *input, int number, pm_error *error)
{
    return pm__fail(error, number == ENOMEM ? PM_ENOMEM : PM_EIO, "%s: cannot be read: %s", input->name,
                    strerror(number));
}

/* 0, or an errno. A directory opens but cannot be read; its size is left unknown where the system gives none. */
static int examine(pm__ply_input *input)
{
    struct stat status;
    if (fstat(fileno(input->file), &status) != 0)
        return errno;
    if (S_ISDIR(status.st_mode))
        return EISDIR;
    /* Files made up by the kernel are regular and have size 0. */
    input->size = S_ISREG(status.st_mode) && status.st_size > 0 ? (uint64_t)status.st_size : UINT64_MAX;
    return 0;
}

pm_status pm__ply_input_open(const char *path, pm__ply_input *input, pm_error *error)
{
    memset(input, 0, sizeof *input);
    input->line = 1;
    pm__quote_path(path, input->name);
    int number = 0;
    input->file = fopen(path, "rbe");
    if (!input->file)
        return io_error(input, errno, error);
    number = examine(input);
    input->locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!number && !input->locale)
        number = ENOMEM;
    if (!number && !(input->buffer = malloc(BUFFER + 1)))
        number = ENOMEM;
    if (!number) {
        input->buffer[0] = '\0';
        return PM_OK;
    }
    const pm_status status = io_error(input, number, error);
    pm__ply_input_close(input);
    return status;
}

void pm__ply_input_close(pm__ply_input *input)
{
    if (input->file)
        (void)fclose(input->file);
    if (input->locale)
        freelocale(input->locale);
    free(input->buffer);
    input->file = NULL;
    input->locale = (locale_t)0;
    input->buffer = NULL;
}

size_t pm__ply_fill(pm__ply_input *input, size_t wanted)
{
    size_t available = input->end - input->at;
    if (available >= wanted || input->ended)
        return available;
    memmove(input->buffer, input->buffer + input->at, available);
    input->offset += input->at;
    input->at = 0;
    errno = 0;
    const size_t room = BUFFER - available;
    const size_t got = fread(input->buffer + available, 1, room, input->file);
    if (got < room) {
        input->ended = true;
        if (ferror(input->file))
            input->error = errno ? errno : EIO;
    }
    available += got;
    input->end = available;
    input->buffer[available] = '\0';
    return available;
}

uint64_t pm__ply_remaining(const pm__ply_input *input)
{
    const uint64_t read = input->offset + input->at;
    if (input->size == UINT64_MAX)
        return UINT64_MAX;
    return input->size > read ? input->size - read : 0;
}

void pm__ply_place(const pm__ply_input *input, char place[PM__PLY_PLACE])
{
    if (input->binary)
        (void)snprintf(place, PM__PLY_PLACE, "%s, byte %" PRIu64, input->name, input->offset + input->at);
    else
        (void)snprintf(place, PM__PLY_PLACE, "%s, line %" PRIu64, input->name, input->line);
}

pm_status pm__ply_expected(const pm__ply_input *input, const char *what, pm_error *error)
{
    if (input->error)
        return io_error(input, input->error, error);
    char place[PM__PLY_PLACE], found[PM__QUOTE_SIZE];
    pm__ply_place(input, place);
    const char *const rest = input->buffer + input->at;
    const size_t left = input->end - input->at;
    if (left == 0 || input->binary)
        return pm__fail(error, PM_EFORMAT, "%s: expected %s, found the end of the file", place, what);
    if (*rest == '\n')
        return pm__fail(error, PM_EFORMAT, "%s: expected %s, found the end of the line", place, what);
    size_t length = 0;
    while (length < left && !strchr(" \t\r\n", rest[length])) /* strchr also stops at a NUL byte */
        length++;
    pm__quote(rest, length ? length : 1, found);
    return pm__fail(error, PM_EFORMAT, "%s: expected %s, found \"%s\"", place, what, found);
}

pm_status pm__ply_line(pm__ply_input *input, char line[PM__PLY_LINE + 1], pm_error *error)
{
    const size_t available = pm__ply_available(input, PM__PLY_LINE);
    const char *const start = input->buffer + input->at;
    const size_t limit = available < PM__PLY_LINE ? available : PM__PLY_LINE;
    const char *const end = memchr(start, '\n', limit);
    if (!end && limit == PM__PLY_LINE)
        return pm__ply_expected(input, "a header line of less than 4096 bytes", error);
    if (!end) {
        input->at = input->end;
        return pm__ply_expected(input, "more header lines up to end_header", error);
    }
    size_t length = (size_t)(end - start);
    input->at += length + 1;
    input->line++;
    if (length && start[length - 1] == '\r')
        length--;
    memcpy(line, start, length);
    line[length] = '\0';
    return PM_OK;
}

static bool is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

/* Skips blanks, and line ends if wanted, and leaves a whole token in the buffer. */
static void skip_blanks(pm__ply_input *input, bool lines)
{
    do {
        const char *const buffer = input->buffer;
        for (; input->at < input->end; input->at++) {
            const char c = buffer[input->at];
            if (c == '\n' && lines)
                input->line++;
            else if (!is_blank(c))
                break;
        }
    } while (pm__ply_available(input, PM__PLY_TOKEN) > 0 &&
             (is_blank(input->buffer[input->at]) || (lines && input->buffer[input->at] == '\n')));
}

bool pm__ply_number(pm__ply_input *input, bool across_lines, double *value)
{
    skip_blanks(input, across_lines);
    char *const start = input->buffer + input->at;
    char *end = start;
    /* strtod skips more kinds of white space than a PLY file may hold. */
    if (input->at < input->end && (unsigned char)*start > ' ')
        *value = strtod_l(start, &end, input->locale);
    const size_t length = (size_t)(end - start);
    if (length == 0 || length >= PM__PLY_TOKEN || !(is_blank(*end) || *end == '\n' || *end == '\0'))
        return false;
    input->at += length;
    return true;
}

pm_status pm__ply_end_of_line(pm__ply_input *input, pm_error *error)
{
    skip_blanks(input, false);
    if (input->at == input->end && !input->error)
        return PM_OK;
    if (input->error || input->buffer[input->at] != '\n')
        return pm__ply_expected(input, "the end of the line after a vertex's last property", error);
    input->at++;
    input->line++;
    return PM_OK;
}
