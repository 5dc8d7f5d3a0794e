/* Runs the caller's parallel-for, or a plain loop where there is none. */
#ifndef PM_BASE_PARALLEL_H
#define PM_BASE_PARALLEL_H

#include "../photonmap.h"

static inline void pm__for(const pm_parallel *parallel, size_t count, void (*task)(void *argument, size_t index),
                           void *argument)
{
    if (parallel && count > 1)
        parallel->run(parallel->context, count, task, argument);
    else
        for (size_t i = 0; i < count; i++)
            task(argument, i);
}

/* So many things in pieces, of `size` each but the last: how many pieces, and the end of one of them, by number. */
static inline size_t pm__pieces(size_t count, size_t size)
{
    return count / size + (count % size != 0);
}

static inline size_t pm__piece_end(size_t piece, size_t size, size_t count)
{
    return count - piece * size > size ? (piece + 1) * size : count;
}

#endif
