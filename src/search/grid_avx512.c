/* The kernels of `grid` in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__SIMD_WIDTH 16
#include "grid_kernel.h"

const pm__grid_kernel pm__grid_avx512 = {find_in_grid, find_all_in_grid};
#endif
