/* The list of point sets as data. */
#include "list.h"

#include "../workloads.h"

#define X(name) extern const pm__workload pm__workload_##name;
PM_WORKLOAD_LIST(X)
#undef X

static const pm__entry *const entries[] = {
#define X(name) &pm__workload_##name.entry,
    PM_WORKLOAD_LIST(X)
#undef X
};

const pm__catalogue pm__workloads = {"case", entries, sizeof entries / sizeof *entries};
