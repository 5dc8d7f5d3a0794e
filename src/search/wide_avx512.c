/* The kernels of `wide` in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__SIMD_WIDTH 16
#include "wide_kernel.h"

const pm__wide_kernel pm__wide_avx512 = {find, find_batch};
#endif
