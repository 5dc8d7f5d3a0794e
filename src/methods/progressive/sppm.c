/* Stochastic progressive photon mapping (Hachisuka and Jensen 2009): each pass draws a point of the pixel anew, and all
 * of a pixel's points share their statistics, whose flux is that of the whole pixel. */
#include "shrink.h"

const pm__progressive pm__progressive_sppm = {
    .entry = {.name = "sppm",
              .summary = "stochastic progressive photon mapping: points drawn anew, statistics shared by a pixel",
              .citation = "Hachisuka and Jensen 2009",
              .params = pm__shrink_params,
              .param_count = 2},
    .uses_photons = true,
    .redraws = true,
    .shrinks = true,
    .fields = PM__SHRINK_FIELDS,
    .begin = pm__shrink_begin,
    .ask = pm__shrink_ask,
    .take = pm__shrink_take,
    .answer = pm__shrink_answer,
    .averages = pm__shrink_averages,
    .view = pm__shrink_view,
    .law = PM__LAW_SHRINKING,
    .schedule = pm__shrink_schedule,
};
