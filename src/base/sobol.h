/* Sobol' points with Owen's nested scrambling, in up to 4 dimensions. */
#ifndef PM_BASE_SOBOL_H
#define PM_BASE_SOBOL_H

#include <stdint.h>

enum { PM__SOBOL_DIMENSIONS = 4 };

/* Coordinate `dimension` of point `index` of the plain sequence, as a fraction of 2^32. Unchecked. */
uint32_t pm__sobol(uint32_t index, int dimension);

/* A random permutation of fractions of 2^32 that is nested in Owen's sense: digit b of the result is digit b of x,
 * flipped or not by a bit that depends only on the digits above it and the keys. Uniform keys make each x
 * uniform. Owen 1995; built from carries that run from high digits to low, as in Laine and Karras 2011. */
uint32_t pm__owen_scramble(uint32_t x, const uint32_t keys[4]);

#endif
