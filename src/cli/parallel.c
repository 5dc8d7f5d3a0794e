#include "parallel.h"

#include <pthread.h>
#include <sched.h>
#include <stdatomic.h>
#include <stdlib.h>
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

#ifdef _OPENMP
static void *pass_through(void *gate)
{
    (void)pthread_mutex_lock(gate);
    (void)pthread_mutex_unlock(gate);
    return NULL;
}

/* How many of so many threads the system has room for at once, this one counted. */
static size_t possible_threads(size_t wanted)
{
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    pthread_t *const others = malloc(wanted * sizeof *others);
    size_t made = 0;
    (void)pthread_mutex_lock(&gate); /* none ends before all are there */
    while (others && made + 1 < wanted && pthread_create(&others[made], NULL, pass_through, &gate) == 0)
        made++;
    (void)pthread_mutex_unlock(&gate);
    for (size_t i = 0; i < made; i++)
        (void)pthread_join(others[i], NULL);
    free(others);
    return made + 1;
}

/* OpenMP's library ends the program, with a status of its own, where a thread cannot be had: so only those that can be
 * are asked for, and at once, before other memory takes their place. */
static void hire(size_t *threads)
{
    if (*threads > 1)
        *threads = possible_threads(*threads);
    atomic_int there = 0;
    const int team = (int)*threads;
#pragma omp parallel num_threads(team)
    atomic_fetch_add(&there, 1);
}
#endif

pm_parallel pm__parallel_for(size_t *threads)
{
#ifdef _OPENMP
    if (!*threads)
        *threads = (size_t)omp_get_max_threads();
    hire(threads);
#else
    *threads = 1;
#endif
    return (pm_parallel){run, threads};
}
