#include "parallel.h"

#include <sched.h>
#include <unistd.h>
#ifdef _OPENMP
#include <omp.h>
#endif

int pm__usable_processors(void)
{
    cpu_set_t set;
    if (sched_getaffinity(0, sizeof set, &set) == 0)
        return CPU_COUNT(&set);
    const long online = sysconf(_SC_NPROCESSORS_ONLN);
    return online > 0 ? (int)online : 1;
}

static void run(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
#ifdef _OPENMP
    const int threads = (int)*(const size_t *)context;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
#else
    (void)context;
#endif
    for (size_t i = 0; i < count; i++)
        task(argument, i);
}

pm_parallel pm__parallel_for(size_t *threads)
{
#ifdef _OPENMP
    if (!*threads)
        *threads = (size_t)omp_get_max_threads();
#else
    *threads = 1;
#endif
    return (pm_parallel){run, threads};
}
