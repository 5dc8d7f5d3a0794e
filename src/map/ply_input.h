/* The bytes of a PLY file: buffered, bounded, and able to say where they are. */
#ifndef PM_MAP_PLY_INPUT_H
#define PM_MAP_PLY_INPUT_H

#include "../base/quote.h"
#include "../base/status.h"

#include <locale.h>
#include <stdio.h>

enum { PM__PLY_LINE = 4096, PM__PLY_TOKEN = 4096 };

typedef struct pm__ply_input {
    FILE *file;
    locale_t locale; /* numbers are written as in C, whatever the caller's locale is */
    char *buffer;    /* a NUL stands behind the last byte */
    size_t at, end;  /* the unread part of the buffer */
    uint64_t offset; /* in the file, of buffer[0] */
    uint64_t line;   /* 1-based, of the byte at `at`, as far as the file was read as text */
    uint64_t size;   /* of a regular file, else UINT64_MAX */
    bool ended;      /* the buffer holds the file's last byte */
    bool binary;     /* places are told as bytes, not lines */
    int error;       /* errno of a failed read, or 0 */
    char name[PM__NAME_SIZE];
} pm__ply_input;

/* EIO or ENOMEM; nothing is to be closed then. */
pm_status pm__ply_input_open(const char *path, pm__ply_input *input, pm_error *error);
void pm__ply_input_close(pm__ply_input *input);

/* Tries to have `wanted` bytes (at most PM__PLY_TOKEN) in the buffer; returns how many unread ones there are. */
size_t pm__ply_fill(pm__ply_input *input, size_t wanted);

static inline size_t pm__ply_available(pm__ply_input *input, size_t wanted)
{
    const size_t available = input->end - input->at;
    return available >= wanted ? available : pm__ply_fill(input, wanted);
}

/* Bytes of the file not yet read; UINT64_MAX where it has no known size. */
uint64_t pm__ply_remaining(const pm__ply_input *input);

/* The next line without its end (LF or CRLF), NUL-terminated. */
pm_status pm__ply_line(pm__ply_input *input, char line[PM__PLY_LINE + 1], pm_error *error);

/* The next number of a text; line ends before it are skipped only if `across_lines`. Infinite and NaN values are
 * passed on. false: there is none; pm__ply_expected tells why. */
bool pm__ply_number(pm__ply_input *input, bool across_lines, double *value);

/* Nothing but blanks may stand before the end of the line (or file). */
pm_status pm__ply_end_of_line(pm__ply_input *input, pm_error *error);

/* Fails with EFORMAT (EIO where a read has failed): "FILE, line N: expected WHAT, found ...", the place and what
 * is there being taken from the input. */
pm_status pm__ply_expected(const pm__ply_input *input, const char *what, pm_error *error);

/* "FILE, line N" or "FILE, byte N", for other errors. */
enum { PM__PLY_PLACE = PM__NAME_SIZE + 32 };
void pm__ply_place(const pm__ply_input *input, char place[PM__PLY_PLACE]);

#endif
