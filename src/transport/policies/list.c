#include "list.h"

static const pm__entry *const entries[] = {
#define X(name) &pm__policy_##name.entry,
    PM_POLICY_LIST(X)
#undef X
};

const pm__catalogue pm__policies = {"policy", entries, sizeof entries / sizeof *entries};
