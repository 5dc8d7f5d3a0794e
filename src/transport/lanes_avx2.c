/* The loops of lanes.h in this width; the Makefile compiles this file for it. */
#ifdef __x86_64__
#include "lanes_kernel.h"

const pm__lanes pm__lanes_avx2 = {cut_cells, cut_plots};
#endif
