/* The list of estimators as data. */
#include "list.h"

#include "estimator.h"

#define X(name) extern const pm__estimator pm__estimator_##name;
PM_ESTIMATOR_LIST(X)
#undef X

static const pm__entry *const entries[] = {
#define X(name) &pm__estimator_##name.entry,
    PM_ESTIMATOR_LIST(X)
#undef X
};

const pm__catalogue pm__estimators = {"estimator", entries, sizeof entries / sizeof *entries};
