/* The search of crowd.h in this width; the Makefile compiles this file for it. */
#define PM__SIMD_WIDTH 0
#include "crowd_kernel.h"

const pm__crowd_kernel pm__crowd_plain = {find, farthest, give};
