/* What stored photons stand for where that is known only when tracing has ended. */
#ifndef PM_TRANSPORT_SHARES_H
#define PM_TRANSPORT_SHARES_H

#include "harvest.h"

/* Powers of photons without a share, each of which stands for `share`, to W. EINVAL: more than a float holds. */
pm_status pm__share_alike(const pm__shoot_config *config, pm__harvest *harvest, double share, pm_error *error);

/* The same for config->count photons or more, with marks, of independent paths that ended with the one by which there
 * were so many: leaves exactly as many. power: W, that is sent. EINVAL: less than a float holds, too. */
pm_status pm__share_wanted(const pm__shoot_config *config, pm__harvest *harvest, double power, pm_error *error);

/* EINVAL: photons of so much of `power` W are less than a float holds. */
pm_status pm__check_smallness(double power, double share, pm_error *error);

#endif
