/* Every point set, one row each, in the order in which tables show them. list.c holds this list as data. */
#define PM_WORKLOAD_LIST(X) \
    X(square)               \
    X(box)                  \
    X(caustic)              \
    X(volume)               \
    X(duplicates)
