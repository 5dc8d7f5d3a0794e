/* Options that `search` has of its own, or reads in its own way. */
#ifndef PM_CLI_SEARCH_OPTIONS_H
#define PM_CLI_SEARCH_OPTIONS_H

#include "options.h"

extern const pm__option pm__search_option_case, pm__search_option_input, pm__search_option_photons;
extern const pm__option pm__search_option_k, pm__search_option_radius, pm__search_option_order;
extern const pm__option pm__search_option_search, pm__search_option_samples, pm__search_option_seconds;
extern const pm__option pm__search_option_threads, pm__search_option_lookup, pm__search_option_front;

#endif
