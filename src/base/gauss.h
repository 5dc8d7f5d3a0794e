/* Gauss-Legendre quadrature on [0, 1]. */
#ifndef PM_BASE_GAUSS_H
#define PM_BASE_GAUSS_H

/* The n nodes (ascending) and weights (summing to 1) of the rule exact for polynomials of degree 2n - 1; to about
 * 1e-15. 1 <= n <= 512. Cost: O(n^2). */
void pm__gauss_legendre(int n, double *nodes, double *weights);

#endif
