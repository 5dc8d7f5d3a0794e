/* Options of `storage` that others do not take, or not so. */
#ifndef PM_CLI_STORAGE_OPTIONS_H
#define PM_CLI_STORAGE_OPTIONS_H

#include "options.h"

extern const pm__option pm__storage_option_policy, pm__storage_option_photons, pm__storage_option_stored;
extern const pm__option pm__storage_option_map, pm__storage_option_k, pm__storage_option_trials;
extern const pm__option pm__storage_option_paths, pm__storage_option_importance, pm__storage_option_share;
extern const pm__option pm__storage_option_size, pm__storage_option_spp, pm__storage_option_seconds;
extern const pm__option pm__storage_option_output;

#endif
