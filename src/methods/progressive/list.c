#include "list.h"

static const pm__entry *const entries[] = {
#define X(name) &pm__progressive_##name.entry,
    PM_PROGRESSIVE_LIST(X)
#undef X
};

const pm__catalogue pm__progressives = {"progressive method", entries, sizeof entries / sizeof *entries};
