/* Every storage policy, one row each, in the order in which tables show them. Beside the rows: list.c (this list as
 * data). */
#ifndef PM_TRANSPORT_POLICIES_LIST_H
#define PM_TRANSPORT_POLICIES_LIST_H

#include "policy.h"

#define PM_POLICY_LIST(X) \
    X(all)                \
    X(percentage)         \
    X(probability)        \
    X(density)            \
    X(emission)           \
    X(peter_pietrek)      \
    X(emission_density)   \
    X(emission_probability)

#define X(name) extern const pm__policy pm__policy_##name;
PM_POLICY_LIST(X)
#undef X

#endif
