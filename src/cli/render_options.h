/* Options of `render` that others do not take, or not so, and its operands. */
#ifndef PM_CLI_RENDER_OPTIONS_H
#define PM_CLI_RENDER_OPTIONS_H

#include "options.h"

extern const pm__option pm__render_option_method, pm__render_option_estimator, pm__render_option_k;
extern const pm__option pm__render_option_radius, pm__render_option_photons, pm__render_option_size;
extern const pm__option pm__render_option_spp, pm__render_option_seconds, pm__render_option_trials;
extern const pm__option pm__render_option_sampler, pm__render_option_aov, pm__render_option_plan;
extern const pm__option pm__render_option_no_skip, pm__render_option_half, pm__render_option_eye;
extern const pm__option pm__render_option_look, pm__render_option_up, pm__render_option_angle, pm__render_option_output;

/* The operands as scenes, appended to settings->cases: NAME[:params], with or without `scene:` before it, comma lists
 * too; `all`. ENAME, EINVAL (no operand at all among them), ENOMEM. */
pm_status pm__render_take_scenes(pm__settings *settings, pm_error *error);

#endif
