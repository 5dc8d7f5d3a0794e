#include "list.h"

static const pm__entry *const entries[] = {
#define X(name) &pm__method_##name.entry,
    PM_METHOD_LIST(X)
#undef X
};

const pm__catalogue pm__methods = {"method", entries, sizeof entries / sizeof *entries};
