/* Progressive photon mapping ([H09]): points are found once, and each keeps statistics of its own that shrink. */
#include "shrink.h"

/* What a point sees of lights is the same in all passes, and counted where answers are read. */
static void take(const pm__run *run, const pm__found *found, double *state)
{
    pm__found dark = *found;
    dark.emitted[0] = dark.emitted[1] = dark.emitted[2] = 0.0;
    pm__shrink_take(run, &dark, state);
}

const pm__progressive pm__progressive_ppm = {
    .entry = {.name = "ppm",
              .summary = "progressive photon mapping: fixed points, radii that shrink by what each has found",
              .citation = "Hachisuka, Ogaki and Jensen 2008; errata 27 to 31",
              .params = pm__shrink_params,
              .param_count = 2},
    .uses_photons = true,
    .shrinks = true,
    .summed = true,
    .fields = PM__SHRINK_FIELDS,
    .begin = pm__shrink_begin,
    .ask = pm__shrink_ask,
    .take = take,
    .answer = pm__shrink_answer,
    .averages = pm__shrink_averages,
    .view = pm__shrink_view,
    .law = PM__LAW_SHRINKING,
    .schedule = pm__shrink_schedule,
};
