/* Files damaged at random, the same at each run: what the fuzz tests of file formats share. */
#ifndef PM_TESTS_FUZZ_DAMAGE_H
#define PM_TESTS_FUZZ_DAMAGE_H

#include "dice.h"

#include <stdbool.h>
#include <string.h>
#include <sys/resource.h>

typedef struct sample_file {
    unsigned char content[1 << 14];
    size_t size;
} sample_file;

/* Puts `count` bytes in place of the `removed` ones at `at`, as far as there is room. */
static inline void splice(sample_file *f, size_t at, size_t removed, const void *from, size_t count)
{
    if (removed > f->size - at)
        removed = f->size - at;
    if (f->size - removed + count > sizeof f->content)
        return;
    memmove(f->content + at + count, f->content + at + removed, f->size - at - removed);
    memcpy(f->content + at, from, count);
    f->size = f->size - removed + count;
}

/* Puts one of the words in place of a run of bytes that are `least` or more. */
static inline void replace_run(sample_file *f, size_t at, unsigned char least, const char *const *words, size_t count,
                               dice *d)
{
    while (at > 0 && f->content[at - 1] >= least)
        at--;
    size_t end = at;
    while (end < f->size && f->content[end] >= least)
        end++;
    const char *const word = words[roll(d, count)];
    splice(f, at, end - at, word, strlen(word));
}

/* Damage that knows nothing of the format: at `at` bytes are changed, lost, repeated, replaced by noise, or the end. */
enum { DAMAGES = 6 };
static inline void damage_bytes(sample_file *f, size_t at, size_t kind, dice *d)
{
    unsigned char noise[16], chunk[256];
    for (size_t i = 0; i < sizeof noise; i++)
        noise[i] = (unsigned char)roll(d, 256);
    const size_t length = roll(d, f->size - at < sizeof chunk ? f->size - at : sizeof chunk);
    memcpy(chunk, f->content + at, length);
    switch (kind) {
    case 0:
        f->size = at;
        break;
    case 1:
        splice(f, at, 0, noise, roll(d, sizeof noise));
        break;
    case 2:
        splice(f, at, length, noise, roll(d, sizeof noise));
        break;
    case 3:
        splice(f, roll(d, f->size), 0, chunk, length);
        break;
    case 4:
        splice(f, at, roll(d, 64), "", 0);
        break;
    default:
        if (f->size)
            f->content[at] ^= (unsigned char)(1U << roll(d, 8));
    }
}

/* A false size or count must not be believed: then an allocation fails, and ENOMEM is no status expected here. Address
 * sanitizers need the room themselves. */
static inline void limit_memory(void)
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__clang__)
    const struct rlimit limit = {(rlim_t)1 << 30, (rlim_t)1 << 30};
    ck_assert_int_eq(setrlimit(RLIMIT_AS, &limit), 0);
#endif
}

#endif
