/* The trials of all rows of a scene. */
#include "job.h"

#include "../base/clock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- Trials ------------------------------------------------------------------------------------ */

static pm_status store(pm__storage_job *job, const pm__storage_row *row, size_t trial, pm__stored_photons *set,
                       pm_error *error)
{
    const pm__storage_wish *const w = job->wish;
    const pm__storing_config config = {.scene = job->stage.scene,
                                       .kind = row->map,
                                       .policy = row->policy,
                                       .importance = job->importance,
                                       .global = row->map == PM__CAUSTIC_MAP ? pm__viewing_global(job->viewing) : NULL,
                                       .seed = w->seed,
                                       .trial = (uint32_t)trial,
                                       .emitted = row->photons ? row->photons : PM__MOST_SENT * (uint64_t)row->wanted,
                                       .stored = row->photons ? SIZE_MAX : row->wanted,
                                       .parallel = w->parallel,
                                       .canceled = pm__storage_canceled,
                                       .context = job};
    return pm__store_photons(&config, set, error);
}

static void note(pm__storage_job *job, pm__storage_item *item, size_t trial, const pm__stored_photons *set,
                 double build_s)
{
    const double importance_s = pm__policy_needs_importance(item->row.policy) ? job->importance_s : 0.0;
    item->stored[trial] = (double)set->count;
    item->trace_s[trial] = set->trace_s;
    item->policy_s[trial] = set->policy_s;
    item->build_s[trial] = build_s;
    item->total_s[trial] = importance_s + set->trace_s + set->policy_s + build_s;
    for (int p = 0; p < PM__PARTS; p++) {
        item->flux[p][trial] = set->flux[p];
        item->came[p][trial] = set->came[p];
    }
    item->emitted += (double)set->emitted;
    item->row.unmet += set->unmet;
    item->row.starved += item->row.wanted && set->emitted >= PM__MOST_SENT * (uint64_t)item->row.wanted;
    item->row.trials++;
}

/* The map of a set, its image and what there is to see of it. */
static pm_status look_at(pm__storage_job *job, pm__storage_item *item, size_t trial, const pm__stored_photons *set,
                         pm_error *error)
{
    const pm_map_options options = {.parallel = job->wish->parallel};
    const double start = pm__seconds();
    double spread = (double)NAN;
    pm_map *map = NULL;
    pm_status status = pm_map_create(set->photons, set->count, &options, &map, error);
    const double build_s = pm__seconds() - start;
    if (status == PM_OK)
        status = pm__viewing_errors(job->viewing, item->row.map, map, job->errors);
    if (status == PM_OK)
        status = pm__power_spread(job, item->row.map, set, map, &spread);
    if (status == PM_OK) {
        note(job, item, trial, set, build_s);
        pm__tally_add(&item->tally, job->errors);
        item->row.spread = fmax(item->row.spread, spread); /* passes over NAN */
    }
    if (status == PM_OK && job->wish->images && item->largest && trial == 0)
        status = pm__storage_draw(job, item, map, error);
    pm_map_destroy(map);
    return status;
}

static pm_status run_item(pm__storage_job *job, pm__storage_item *item, size_t trial, pm_error *error)
{
    pm__stored_photons set = {0};
    pm_status status = pm__storage_canceled(job) ? PM_ECANCELED : store(job, &item->row, trial, &set, error);
    if (status == PM_OK && item->hidden)
        note(job, item, trial, &set, 0.0);
    else if (status == PM_OK)
        status = look_at(job, item, trial, &set, error);
    pm__stored_photons_free(&set);
    return status;
}

static void tell_trials(pm__storage_job *job, const pm__storage_item *item)
{
    const pm__storage_row *const row = &item->row;
    job->done += pm__storage_work(job, item);
    if (job->wish->progress)
        job->wish->progress(job->wish->context,
                            (pm__view_work * job->work + job->done) / ((1.0 + pm__view_work) * job->work),
                            row->policy->entry->name);
}

/* Importance is found where photons first ask for it, and kept: done once before the trials, that the first row to ask
 * does not pay for all. By photons of a trial of their own, which are thrown away; what is found is the same whoever
 * asks. It is in no row's time. */
static pm_status warm(pm__storage_job *job, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < job->item_count && status == PM_OK; i++) {
        const pm__storage_row *const row = &job->items[i].row;
        pm__stored_photons set = {0};
        if (!job->items[i].largest || !pm__policy_needs_importance(row->policy))
            continue;
        status = pm__storage_canceled(job) ? PM_ECANCELED : store(job, row, job->wish->trials, &set, error);
        pm__stored_photons_free(&set);
    }
    return status;
}

static pm_status run_trials(pm__storage_job *job, pm_error *error)
{
    const pm__storage_wish *const w = job->wish;
    const double start = pm__seconds();
    pm_status status = PM_OK;
    for (size_t trial = 0; trial < w->trials && status == PM_OK; trial++) {
        if (trial >= 2 && w->seconds > 0.0 && pm__seconds() - start >= w->seconds)
            break;
        for (size_t i = 0; i < job->item_count && status == PM_OK; i++) {
            status = run_item(job, &job->items[i], trial, error);
            tell_trials(job, &job->items[i]);
        }
        job->result->trials += status == PM_OK;
    }
    return status;
}

/* ---- All of it --------------------------------------------------------------------------------- */

static void free_item(pm__storage_item *item)
{
    pm__tally_free(&item->tally);
    free(item->stored);
    free(item->trace_s);
    free(item->policy_s);
    free(item->build_s);
    free(item->total_s);
    for (int p = 0; p < PM__PARTS; p++) {
        free(item->flux[p]);
        free(item->came[p]);
    }
}

static void free_job(pm__storage_job *job)
{
    for (size_t i = 0; i < job->item_count; i++)
        free_item(&job->items[i]);
    free(job->items);
    free(job->errors);
    pm__viewing_destroy(job->viewing);
    pm__importance_destroy(job->importance);
    pm__reference_free(&job->reference);
    pm__stage_close(&job->stage);
}

pm_status pm__storage_measure(const pm__storage_wish *wish, pm__storage_result *result, pm_error *error)
{
    *result = (pm__storage_result){.row_count = 0};
    pm__storage_job job = {.wish = wish, .result = result};
    pm_status status = pm__storage_prepare(&job, error);
    if (status == PM_OK)
        status = warm(&job, error);
    if (status == PM_OK)
        status = run_trials(&job, error);
    result->interrupted = status == PM_ECANCELED;
    if (status == PM_ECANCELED)
        status = PM_OK;
    if (status == PM_OK && result->trials >= 2)
        status = pm__storage_summarize(&job, error);
    free_job(&job);
    if (status != PM_OK && !*error->text)
        (void)pm__fail(error, status, "%s", pm_status_text(status));
    return status;
}

void pm__storage_free(pm__storage_result *result)
{
    for (size_t i = 0; i < result->front_count; i++) {
        free(result->fronts[i].stored_front);
        free(result->fronts[i].time_front);
    }
    for (size_t i = 0; i < result->image_count; i++) {
        pm__image_free(&result->images[i].image);
        pm__image_free(&result->images[i].reached);
    }
    free(result->rows);
    free(result->fronts);
    free(result->images);
    *result = (pm__storage_result){.row_count = 0};
}
