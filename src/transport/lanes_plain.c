/* The loops of lanes.h in whatever width the compiler takes for any processor. */
#include "lanes_kernel.h"

const pm__lanes pm__lanes_plain = {cut_cells, cut_plots};
