/* The loops of batch.h in this width; the Makefile compiles this file for it. */
#define PM__LANES 2
#include "batch_kernel.h"
#include "batch_surfaces.h"

const pm__batch_kernel pm__batch_plain = PM__BATCH_KERNEL;
