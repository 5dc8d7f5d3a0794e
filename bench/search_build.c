/* Builds, timed in rounds in which each contender has its turn, in random order. */
#include "search_inside.h"

#include "../src/base/memory.h"

#include <stdio.h>
#include <stdlib.h>

enum { BUILDS = 5 };

/* A permutation of the contenders, another one each round (Fisher and Yates). */
static void shuffle(size_t *order, size_t count, uint64_t seed, size_t round)
{
    for (size_t i = 0; i < count; i++)
        order[i] = i;
    for (size_t i = count; i-- > 1;) {
        uint32_t words[4];
        pm__random_words(seed, PM__FOR_TIMING, 3, round, (uint32_t)i, words);
        const size_t j = (size_t)((uint64_t)words[0] * (i + 1) >> 32), kept = order[i];
        order[i] = order[j];
        order[j] = kept;
    }
}

static void build_one(const pm__search_group *group, pm__built *built, bool keep, double *seconds)
{
    const pm__contender contender = built->index.contender;
    pm_error error = {""};
    const double start = pm__search_clock();
    const pm_status status = pm__bench_index_build(&contender, &group->photons, &built->index, &error);
    *seconds = 1e3 * (pm__search_clock() - start);
    if (status != PM_OK)
        (void)snprintf(built->problem, sizeof built->problem, "%.150s",
                       *error.text ? error.text : pm_status_text(status));
    else if (!keep)
        pm__bench_index_destroy(&built->index);
}

pm_status pm__search_build(pm__search_group *group)
{
    const pm__search_config *const config = group->config;
    const size_t count = group->built_count,
                 rounds = config->samples && config->samples < BUILDS ? config->samples : BUILDS;
    double *const ms = pm__alloc(count * rounds, sizeof *ms);
    size_t *const order = pm__alloc(count, sizeof *order);
    pm_status status = ms && order ? PM_OK : PM_ENOMEM;
    for (size_t round = 0; round < rounds && status == PM_OK; round++) {
        shuffle(order, count, config->seed, round);
        for (size_t i = 0; i < count && status == PM_OK; i++) {
            pm__built *const built = &group->built[order[i]];
            if (config->canceled && config->canceled(config->context))
                status = PM_ECANCELED;
            else if (!*built->problem)
                build_one(group, built, round + 1 == rounds, &ms[order[i] * rounds + round]);
        }
    }
    for (size_t i = 0; i < count && status == PM_OK; i++)
        if (!*group->built[i].problem)
            group->built[i].ms = pm__median_interval(&ms[i * rounds], rounds, &group->built[i].ms_ci95);
    free(ms);
    free(order);
    return status;
}
