/* The kernels of `wide` in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__SIMD_WIDTH 4
#include "wide_kernel.h"

const pm__wide_kernel pm__wide_v2 = {find, find_batch};
#endif
