/* Every search, one row each. The first row is the default where nothing else is asked: the fastest.
 * list.c holds this list as data. */
#define PM_SEARCH_LIST(X) \
    X(recursive)          \
    X(iterative)          \
    X(brute)
