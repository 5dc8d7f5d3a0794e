/* Numbers at random for fuzz tests, the same at each run. */
#ifndef PM_TESTS_FUZZ_DICE_H
#define PM_TESTS_FUZZ_DICE_H

#include "../../src/base/random.h"
#include "../test.h"

#include <stddef.h>

/* The numbers of one file or line, of one test: no two share any. */
typedef struct dice {
    uint64_t number;
    uint32_t test, next;
} dice;

/* Below `below`; 0 for 0. */
static inline size_t roll(dice *d, size_t below)
{
    uint32_t words[4];
    pm__random_words(1, PM__FOR_TESTS, d->test, d->number, d->next++, words);
    return below ? words[0] % below : 0;
}

#endif
