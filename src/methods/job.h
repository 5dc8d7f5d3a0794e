/* A render taken apart: set up once, then passes at will. What pm__render is made of, and what times its parts. */
#ifndef PM_METHODS_JOB_H
#define PM_METHODS_JOB_H

#include "film.h"

/* Everything but maps: nothing is traced yet. EINVAL, ENOMEM as pm__render; then there is nothing to close. */
pm_status pm__job_open(pm__render_job *job, const pm__render_config *config, pm__plan *plan, pm_error *error);
void pm__job_close(pm__render_job *job);

/* One sample of every pixel into the film. state: of the method's prepare, for this trial, or NULL where its `sample`
 * allows that. *cut: canceled before all tiles were done. ENOMEM and what the method says. */
pm_status pm__job_pass(const pm__render_job *job, const void *state, size_t pass, size_t trial, pm__film *film,
                       bool *cut);

#endif
