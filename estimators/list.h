/* Every estimator, one row each, in the order in which tables show them. kernel.h is shared by some of them.
 * list.c holds this list as data. */
#define PM_ESTIMATOR_LIST(X) \
    X(disc)                  \
    X(cone)                  \
    X(gaussian)              \
    X(epanechnikov)          \
    X(biweight)              \
    X(differential)          \
    X(hull)                  \
    X(combined)              \
    X(precomputed)           \
    X(oracle)
