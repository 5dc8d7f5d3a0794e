/* The loops of batch.h in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#define PM__LANES 8
#include "batch_kernel.h"
#include "batch_surfaces.h"

const pm__batch_kernel pm__batch_avx512 = PM__BATCH_KERNEL;
#endif
