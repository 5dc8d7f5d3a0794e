/* Every test, one row each, in the order in which tables show them.
 * Beside the rows: list.c (this list as data); run.c (rows from sets); ask.c and ask_search.c (the library is asked);
 * judge.c, judge_find.c and judge_hull.c (what is due); hood.c (sets of photons). */
#define PM_STRESS_LIST(X) \
    X(duplicates)         \
    X(ties)               \
    X(collinear)          \
    X(cocircular)         \
    X(coincident)         \
    X(single)             \
    X(whole)              \
    X(empty)              \
    X(powers)             \
    X(signs)              \
    X(extents)            \
    X(offsets)            \
    X(stray)              \
    X(grazing)            \
    X(scaling)            \
    X(motion)             \
    X(updates)            \
    X(adapts)             \
    X(sums)
