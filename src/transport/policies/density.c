/* No more photons than a place requires; the power of others goes to those nearest. */
#include "../keep_density.h"

static const pm__param params[] = {PM__DENSITY_PARAMS};

const pm__policy pm__policy_density = {
    .entry = {.name = "density",
              .summary = "up to a required density, by importance or constant; the power of others is shared out",
              .citation = "Suykens and Willems 2000; course 43, 3.5.2",
              .params = params,
              .param_count = PM__DENSITY_PARAM_COUNT},
    .keep = &pm__keep_density,
    .by_importance = true,
    .required = pm__density_required,
    .needs = pm__density_needs,
};
