/* Keeping by importance: [C02] 3.5.1 (Keller and Wald 2000). */
#ifndef PM_TRANSPORT_KEEP_PROBABILITY_H
#define PM_TRANSPORT_KEEP_PROBABILITY_H

#include "policies/policy.h"

/* Where a photon carries what one does that is sent evenly, P = min(1, importance / (full x its mean over importons)),
 * and never below `least`: that is for flux where nobody looks, which would be lost at P = 0. One that carries f times
 * as much is kept with f P: so what is stored depends on the place, not on how photons were sent. Parameters: full,
 * least. */
extern const pm__keeping pm__keep_probability;

#define PM__PROBABILITY_PARAMS                                                                               \
    {"full", PM__REAL, 1.0, 1e-6, 1e6, "", NULL, "all are stored where importance is so many times its mean"}, \
    {"least", PM__REAL, 0.02, 1e-6, 1.0, "", NULL, "probability of being stored, at least"}
enum { PM__PROBABILITY_PARAM_COUNT = 2 };

#endif
