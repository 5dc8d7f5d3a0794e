#include "list.h"

static const pm__entry *const entries[] = {
#define X(name) &pm__metric_##name.entry,
    PM_METRIC_LIST(X)
#undef X
};

const pm__catalogue pm__metrics = {"metric", entries, sizeof entries / sizeof *entries};
