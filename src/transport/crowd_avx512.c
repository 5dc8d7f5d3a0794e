/* The search of crowd.h in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__SIMD_WIDTH 16
#include "crowd_kernel.h"

const pm__crowd_kernel pm__crowd_avx512 = {find, farthest, give};
#endif
