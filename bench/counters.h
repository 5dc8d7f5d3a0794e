/* Cycles and instructions of the calling thread, in user mode, where kernel and machine give them. */
#ifndef PM_BENCH_COUNTERS_H
#define PM_BENCH_COUNTERS_H

#include <stdbool.h>

typedef struct pm__counters {
    int cycles, instructions; /* file descriptors; -1: not there */
} pm__counters;

/* Never fails: what is not wanted or not to be had reads as NAN (a virtual machine, perf_event_paranoid, seccomp). */
void pm__counters_open(bool wanted, pm__counters *counters);
void pm__counters_start(const pm__counters *counters);
void pm__counters_stop(const pm__counters *counters, double *cycles, double *instructions);
void pm__counters_close(pm__counters *counters);

#endif
