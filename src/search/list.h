/* Every search, one row each. The first row is the default where nothing else is asked: the fastest.
 * Beside the rows: list.c (this list as data); wide_hints.c (where `wide` begins); wide_plain.c, wide_v2.c, wide_avx2.c
 * and wide_avx512.c (the kernels of `wide` by SIMD width); grid_plain.c, grid_v2.c, grid_avx2.c and grid_avx512.c
 * (those of `grid`). */
#define PM_SEARCH_LIST(X) \
    X(wide)               \
    X(recursive)          \
    X(iterative)          \
    X(stackfree)          \
    X(unbalanced)         \
    X(grid)               \
    X(brute)
