/* Options of `converge` that others do not take, or not so. */
#ifndef PM_CLI_CONVERGE_OPTIONS_H
#define PM_CLI_CONVERGE_OPTIONS_H

#include "options.h"

extern const pm__option pm__converge_option_method, pm__converge_option_estimator, pm__converge_option_alpha;
extern const pm__option pm__converge_option_trials, pm__converge_option_passes, pm__converge_option_photons_per_pass;
extern const pm__option pm__converge_option_photons, pm__converge_option_radius, pm__converge_option_k;
extern const pm__option pm__converge_option_size, pm__converge_option_seconds, pm__converge_option_at;
extern const pm__option pm__converge_option_sampler, pm__converge_option_error, pm__converge_option_checkpoint;
extern const pm__option pm__converge_option_checkpoint_seconds, pm__converge_option_resume;
extern const pm__option pm__converge_option_search;

#endif
