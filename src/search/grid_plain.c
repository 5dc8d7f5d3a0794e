/* The kernels of `grid` in this width. */
#define PM__SIMD_WIDTH 0
#include "grid_kernel.h"

const pm__grid_kernel pm__grid_plain = {find_in_grid, find_all_in_grid};
