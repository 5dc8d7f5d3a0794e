/* The kernels of `wide` in this width; the Makefile compiles this file for it. */
#define PM__SIMD_WIDTH 0
#include "wide_kernel.h"

const pm__wide_kernel pm__wide_plain = {find, find_batch};
