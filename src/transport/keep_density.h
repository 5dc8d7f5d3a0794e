/* Density control by redistribution: Suykens and Willems 2000; [C02] 3.5.2.
 *
 * Surface is taken in plots, of each of which up to M photons are required, from a quarter of that on (plots.h). A
 * photon is stored where fewer are stored in its plot than are required, D_cur = stored / area < D_r; else its power
 * waits in the plot, and is handed out at the end, in equal parts to those of its photons that face it. Where none
 * does it is stored after all (errata 42). So flux is kept exactly: what waits are doubles, rounded once. Nothing goes
 * to where it matters from where it does not, or back: so flux is kept of important places alone too. The printed
 * D_cur is that of the M nearest, M / (pi r_M^2), and ends at 1.31 D_r (errata 41); here as many are stored as are
 * required of the plot on average over what comes to it, the next whole number, and where a plot is cut by the end of
 * what it lies on, of the rectangle that photons fall on. Cost: one look-up a photon; no search. */
#ifndef PM_TRANSPORT_KEEP_DENSITY_H
#define PM_TRANSPORT_KEEP_DENSITY_H

#include "policies/policy.h"

extern const pm__keeping pm__keep_density;

bool pm__density_needs(const pm__spec *policy);
double pm__density_required(const pm__spec *policy, pm__map_kind kind, const pm__importance *importance, double there);

/* accept: step: stored if D_cur < D_r; cosine: with the chance (1 + cos(pi s / 2)) / 2 of s = D_cur / D_r, 0 from 2
 * on. power: [SW00] 3.2: of a caustic photon s is times (L_g / L_c)^power, L_g of config->global, L_c of all that came
 * to the plot, 1 at least. */
#define PM__DENSITY_PARAMS                                                                                          \
    {"caustic", PM__REAL, 8.0,  1e-3, 1e6, "", NULL, "photons of the caustic map to the pixel"},                    \
        {"global", PM__REAL, 2.0, 1e-3, 1e6, "", NULL, "photons of the global map to the pixel"},                   \
        {"constant", PM__REAL, 0.0, 0.0, 1e12, "1/m2", NULL, "required density everywhere; 0: by importance"},      \
        {"floor", PM__REAL, 0.02, 1e-4, 1.0, "", NULL, "least required density, of that at mean importance"},       \
        {"accept", PM__CHOICE, 0, 0, 1, "", "step|cosine", "stored up to the required density, or about up to it"}, \
        {"neighbors", PM__INTEGER, 20.0, 2.0, 200.0, "", NULL, "that power is shared out among, at most"},        \
        {"power", PM__INTEGER, 0.0, 0.0, 3.0, "", NULL, "of all light over caustics, in their convergence; 0: off"}
enum { PM__DENSITY_PARAM_COUNT = 7 };

#endif
