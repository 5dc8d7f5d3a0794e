/* The exact law of a kernel estimate of independent photons: docs/errata.md, "Exact laws".
 *
 * Of N photons a lookup of radius r accepts each with probability p(r) = mass(r) / power. The k-th nearest has p(r_k)
 * distributed as Beta(k, N-k+1); given r_k the k-1 inner photons are independent with the distribution p(s)/p(r_k),
 * and the k-th lies on the rim. Mean and variance of  sum w(d/r) flux / (c measure(r))  follow by quadrature, for any
 * irradiance whose mass function is known. With a maximum radius R the number found is binomial. */
#ifndef PM_ACCURACY_LAW_H
#define PM_ACCURACY_LAW_H

#include "bench.h"

enum { PM__LAW_CELLS = 48, PM__LAW_INNER = 24, PM__LAW_OUTER = 48 };

/* Quadrature nodes and weights on (0, 1), made once. */
typedef struct pm__law_rule {
    double inner[PM__LAW_INNER], inner_weight[PM__LAW_INNER];
    double outer[PM__LAW_OUTER], outer_weight[PM__LAW_OUTER];
} pm__law_rule;

void pm__law_rule_init(pm__law_rule *rule);

/* p(s) on [0, reach], tabulated as p/s^d, which is smooth where E is. */
typedef struct pm__radial {
    int dimensions;
    double reach;                    /* m */
    double ratio[PM__LAW_CELLS + 1]; /* p(s)/s^d at s = i reach / cells */
    double total;                    /* p(reach) */
} pm__radial;

/* p(s), cubic between the nodes. */
double pm__radial_at(const pm__radial *radial, double s);

/* ln of a p beyond which the k-th of N photons surely lies: the table must reach that far, or as far as the cut. */
double pm__largest_log_p(size_t k, size_t photons);

/* The distribution of what is found: radii of the k-th photon with their probabilities, and what happens at the cut.
 * One serves every kernel. */
typedef struct pm__law_grid {
    size_t k, photons;
    int dimensions;
    size_t count;                   /* radii; 0 for a fixed radius */
    double probability[PM__LAW_OUTER], radius[PM__LAW_OUTER], p[PM__LAW_OUTER];
    double inner_p[PM__LAW_OUTER][PM__LAW_INNER]; /* p(r t) at the inner nodes t */
    bool cut;                       /* may fewer than k be found? */
    double cut_radius, cut_p, cut_inner_p[PM__LAW_INNER];
    double cut_mean, cut_square;    /* E[j; cut], E[j^2; cut] of the number j found */
} pm__law_grid;

/* with_inner: false leaves out what kernels other than the disc need. k = 0: fixed radius. radius: INFINITY where
 * nothing cuts. False where fewer than k may be accepted and nothing cuts: that estimate has no law here. */
bool pm__law_grid_init(pm__law_grid *grid, const pm__law_rule *rule, bool with_inner, const pm__radial *radial,
                       size_t k, size_t photons, double radius);

/* A kernel's constants. With I1, I2 the integrals of w dp and w^2 dp over a lookup of radius r, by parts:
 * I1 = w(1) p(r) - integral of w'(t) p(r t) dt. */
typedef struct pm__kernel_law {
    double rim; /* w(1) */
    double first[PM__LAW_INNER], second[PM__LAW_INNER];
    double norm, last;
} pm__kernel_law;

/* False where the variant is no kernel estimate, or its weight is not smooth enough for the rule. */
bool pm__kernel_law_init(pm__kernel_law *law, const pm__law_rule *rule, const pm__variant *variant, int dimensions);

typedef struct pm__moments {
    double mean, variance; /* W/m2 (W/m3), and its square */
} pm__moments;

/* The disc with the share `last` of its k-th photon: needs no inner nodes. */
pm__moments pm__disc_moments(const pm__law_grid *grid, double flux, double last);

/* Of photons that each carry `flux` W. */
pm__moments pm__kernel_moments(const pm__kernel_law *law, const pm__law_grid *grid, double flux);

#endif
