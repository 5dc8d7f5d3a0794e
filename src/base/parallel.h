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

#endif
