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

/* ---- Threads ----------------------------------------------------------------------------------- */

/* Runs work on this thread and on as many others as there is room for, up to `wanted` in all; how many there were. */
static size_t run_on_threads(size_t wanted, void *(*work)(void *argument), void *argument)
{
    pthread_t *const others = wanted > 1 ? malloc((wanted - 1) * sizeof *others) : NULL;
    size_t made = 0;
    while (others && made + 1 < wanted && pthread_create(&others[made], NULL, work, argument) == 0)
        made++;
    (void)work(argument);
    for (size_t i = 0; i < made; i++)
        (void)pthread_join(others[i], NULL);
    free(others);
    return made + 1;
}

#ifdef _OPENMP

static void run(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    const int threads = (int)*(const size_t *)context;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (size_t i = 0; i < count; i++)
        task(argument, i);
}

/* The first to hold the gate is the one that made the others: none ends before all are there. */
typedef struct gathering {
    pthread_mutex_t gate;
    pthread_t maker;
} gathering;

static void *pass_through(void *argument)
{
    gathering *const g = argument;
    if (pthread_equal(pthread_self(), g->maker)) {
        (void)pthread_mutex_unlock(&g->gate);
        return NULL;
    }
    (void)pthread_mutex_lock(&g->gate);
    (void)pthread_mutex_unlock(&g->gate);
    return NULL;
}

/* OpenMP's library ends the program, with a status of its own, where a thread cannot be had: so only those that can be
 * are asked for, and at once, before other memory takes their place. */
static size_t hire(size_t wanted)
{
    gathering g = {PTHREAD_MUTEX_INITIALIZER, pthread_self()};
    (void)pthread_mutex_lock(&g.gate);
    const size_t threads = run_on_threads(wanted, pass_through, &g);
    const int team = (int)threads;
    atomic_int there = 0;
#pragma omp parallel num_threads(team)
    atomic_fetch_add(&there, 1);
    return threads;
}

static size_t usual_threads(void)
{
    return (size_t)omp_get_max_threads();
}

#else

/* Without OpenMP: threads of our own, for each loop anew. The thread sanitizer, which OpenMP's library is not made for,
 * sees all that these do. */
typedef struct loop {
    void (*task)(void *argument, size_t index);
    void *argument;
    size_t count;
    atomic_size_t next;
} loop;

static void *take_turns(void *argument)
{
    loop *const l = argument;
    for (size_t i; (i = atomic_fetch_add(&l->next, 1)) < l->count;)
        l->task(l->argument, i);
    return NULL;
}

static void run(void *context, size_t count, void (*task)(void *argument, size_t index), void *argument)
{
    const size_t threads = *(const size_t *)context;
    loop l = {task, argument, count, 0};
    (void)run_on_threads(threads < count ? threads : count, take_turns, &l);
}

static size_t hire(size_t wanted)
{
    return wanted;
}

static size_t usual_threads(void)
{
    return (size_t)pm__usable_processors();
}

#endif

pm_parallel pm__parallel_for(size_t *threads)
{
    *threads = hire(*threads ? *threads : usual_threads());
    return (pm_parallel){run, threads};
}
