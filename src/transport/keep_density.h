/* Density control by redistribution: Suykens and Willems 2000; [C02] 3.5.2.
 *
 * A photon is stored where fewer lie than required, D_cur = M / (pi r_M^2) < D_r with r_M the distance of the M-th
 * nearest that is stored; else its power goes in equal parts to those of the M nearest that face it, and where none
 * does it is stored after all (errata 42). So flux is kept exactly: powers are doubles while a map grows, and are
 * rounded once. Nothing goes to where it matters from where it does not, or back: so flux is kept of important places
 * alone too. Photons are found as crowd.h has it: where D_r jumps, the sparse side and the dense one do not see each
 * other, and light does not leak across. */
#ifndef PM_TRANSPORT_KEEP_DENSITY_H
#define PM_TRANSPORT_KEEP_DENSITY_H

#include "policies/policy.h"

extern const pm__keeping pm__keep_density;

bool pm__density_needs(const pm__spec *policy);
double pm__density_required(const pm__spec *policy, pm__map_kind kind, const pm__importance *importance, double there);

/* accept: step: stored if D_cur < D_r; cosine: with the chance (1 + cos(pi s / 2)) / 2 of s = D_cur / D_r, 0 from 2 on.
 * power: [SW00] 3.2: of a caustic photon s is times (L_g / L_c)^power, L_g of config->global, L_c of the neighbours, 1
 * at least. Where s below 1 must be known and fewer than M lie within twice the radius at which it is 1, D_cur is that
 * of those that do. */
#define PM__DENSITY_PARAMS                                                                                          \
    {"caustic", PM__REAL, 25.0, 1e-3, 1e6, "", NULL, "photons of the caustic map to the pixel"},                    \
        {"global", PM__REAL, 2.0, 1e-3, 1e6, "", NULL, "photons of the global map to the pixel"},                   \
        {"constant", PM__REAL, 0.0, 0.0, 1e12, "1/m2", NULL, "required density everywhere; 0: by importance"},      \
        {"floor", PM__REAL, 0.02, 1e-4, 1.0, "", NULL, "least required density, of that at mean importance"},       \
        {"accept", PM__CHOICE, 0, 0, 1, "", "step|cosine", "stored up to the required density, or about up to it"}, \
        {"neighbors", PM__INTEGER, 20.0, 2.0, 200.0, "", NULL, "that a photon's power is shared out among"},        \
        {"power", PM__INTEGER, 0.0, 0.0, 3.0, "", NULL, "of all light over caustics, in their convergence; 0: off"}
enum { PM__DENSITY_PARAM_COUNT = 7 };

#endif
