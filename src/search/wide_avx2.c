/* The kernels of `wide` in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__SIMD_WIDTH 8
#include "wide_kernel.h"

const pm__wide_kernel pm__wide_avx2 = {find, find_batch};
#endif
