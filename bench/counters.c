#include "counters.h"

#include <math.h>

#ifdef __linux__

#include <linux/perf_event.h>
#include <stdint.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

static int open_counter(uint64_t what, int group)
{
    struct perf_event_attr attributes;
    memset(&attributes, 0, sizeof attributes);
    attributes.type = PERF_TYPE_HARDWARE;
    attributes.size = sizeof attributes;
    attributes.config = what;
    attributes.disabled = group < 0;
    attributes.exclude_kernel = 1;
    attributes.exclude_hv = 1;
    attributes.read_format = PERF_FORMAT_TOTAL_TIME_ENABLED | PERF_FORMAT_TOTAL_TIME_RUNNING;
    return (int)syscall(SYS_perf_event_open, &attributes, 0, -1, group, PERF_FLAG_FD_CLOEXEC);
}

void pm__counters_open(bool wanted, pm__counters *counters)
{
    *counters = (pm__counters){-1, -1};
    if (wanted)
        counters->cycles = open_counter(PERF_COUNT_HW_CPU_CYCLES, -1);
    if (counters->cycles >= 0)
        counters->instructions = open_counter(PERF_COUNT_HW_INSTRUCTIONS, counters->cycles);
}

void pm__counters_start(const pm__counters *counters)
{
    if (counters->cycles < 0)
        return;
    (void)ioctl(counters->cycles, PERF_EVENT_IOC_RESET, PERF_IOC_FLAG_GROUP);
    (void)ioctl(counters->cycles, PERF_EVENT_IOC_ENABLE, PERF_IOC_FLAG_GROUP);
}

/* How long the counter was enabled and how long it counted; the two differ where counters are shared in turns. */
typedef struct reading {
    uint64_t value, enabled, running;
} reading;

static reading read_counter(int counter)
{
    reading r = {0, 0, 0};
    if (counter < 0 || read(counter, &r, sizeof r) != (ssize_t)sizeof r)
        r.running = 0;
    return r;
}

/* The times since opening are no part of a reset, so what counted only in turns is not scaled but left out. */
static double value_of(int counter)
{
    const reading r = read_counter(counter);
    return r.running && r.running == r.enabled ? (double)r.value : (double)NAN;
}

void pm__counters_stop(const pm__counters *counters, double *cycles, double *instructions)
{
    if (counters->cycles >= 0)
        (void)ioctl(counters->cycles, PERF_EVENT_IOC_DISABLE, PERF_IOC_FLAG_GROUP);
    *cycles = value_of(counters->cycles);
    *instructions = value_of(counters->instructions);
}

void pm__counters_close(pm__counters *counters)
{
    if (counters->instructions >= 0)
        (void)close(counters->instructions);
    if (counters->cycles >= 0)
        (void)close(counters->cycles);
    *counters = (pm__counters){-1, -1};
}

#else

void pm__counters_open(bool wanted, pm__counters *counters)
{
    (void)wanted;
    *counters = (pm__counters){-1, -1};
}

void pm__counters_start(const pm__counters *counters)
{
    (void)counters;
}

void pm__counters_stop(const pm__counters *counters, double *cycles, double *instructions)
{
    (void)counters;
    *cycles = *instructions = (double)NAN;
}

void pm__counters_close(pm__counters *counters)
{
    (void)counters;
}

#endif
