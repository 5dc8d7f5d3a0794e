/* Threads of the program: the library's parallel-for on OpenMP, or on threads alone where that is left out
 * (`make OPENMP=`). */
#ifndef PM_CLI_PARALLEL_H
#define PM_CLI_PARALLEL_H

#include "../photonmap.h"

/* Processors that this process may run on. */
int pm__usable_processors(void);

/* threads: how many, 0 for what OpenMP would take: the processors that the process may use, or OMP_NUM_THREADS; fewer
 * where the system has no room for so many. *threads is set to the number in use and must outlive the result. */
pm_parallel pm__parallel_for(size_t *threads);

#endif
