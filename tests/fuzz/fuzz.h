/* What the libFuzzer targets share: bytes that are taken one by one, a file in memory, and an end that is seen.
 * `make fuzz` builds and runs them; the deterministic tests of the same readers are test_fuzz_*.c. */
#ifndef PM_TESTS_FUZZ_FUZZ_H
#define PM_TESTS_FUZZ_FUZZ_H

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Ends the process, which the fuzzer takes for a crash, and keeps the input. */
#define FUZZ_CHECK(condition, text)                           \
    do {                                                      \
        if (!(condition)) {                                   \
            (void)fprintf(stderr, "%s: %s\n", #condition, text); \
            abort();                                          \
        }                                                     \
    } while (0)

typedef struct bytes {
    const uint8_t *at;
    size_t left;
} bytes;

/* 0 where there are no more. */
static inline uint8_t take_byte(bytes *b)
{
    if (!b->left)
        return 0;
    b->left--;
    return *b->at++;
}

static inline int take_signed(bytes *b)
{
    return (int)(int8_t)take_byte(b);
}

/* Any bits at all. */
static inline float take_float(bytes *b)
{
    uint8_t raw[4];
    float value;
    for (int i = 0; i < 4; i++)
        raw[i] = take_byte(b);
    memcpy(&value, raw, sizeof value);
    return value;
}

/* The bytes as a file that has a name while `*file` is open. */
static inline const char *as_file(const uint8_t *data, size_t size, int *file, char name[40])
{
    *file = memfd_create("input", MFD_CLOEXEC);
    FUZZ_CHECK(*file >= 0 && write(*file, data, size) == (ssize_t)size, "no memory for a file");
    (void)snprintf(name, 40, "/proc/self/fd/%d", *file);
    return name;
}

#endif
