/* From trials to rows and fronts. */
#include "equal.h"
#include "job.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static double mean_of(const double *x, size_t count)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += x[i];
    return count ? sum / (double)count : (double)NAN;
}

/* scratch: [count]. What holds up one trial moves a median little. */
static double median_of(const double *x, size_t count, double *scratch)
{
    memcpy(scratch, x, count * sizeof *x);
    return count ? pm__median(scratch, count) : (double)NAN;
}

/* The quotient of two means over the same trials. */
static pm__interval interval_of_ratio(const double *above, const double *below, size_t trials, double *without)
{
    const double a = mean_of(above, trials), b = mean_of(below, trials), n = (double)trials;
    for (size_t t = 0; t < trials; t++)
        without[t] = (n * a - above[t]) / (n * b - below[t]);
    const double half = pm__jackknife_half(without, trials);
    return (pm__interval){a / b - half, a / b + half};
}

static void fill_flux(const pm__storage_job *job, pm__storage_item *item, double *without)
{
    pm__storage_row *const row = &item->row;
    const size_t expecting = job->expecting[row->map], trials = row->trials;
    const pm__storage_item *const all = expecting == SIZE_MAX ? NULL : &job->items[expecting];
    const double came = mean_of(item->came[PM__EVERYWHERE], trials);
    for (int p = 0; p < PM__PARTS; p++) {
        row->flux[p] = mean_of(item->flux[p], trials);
        row->expected[p] = all ? mean_of(all->came[p], all->row.trials) : (double)NAN;
        row->flux_ci95[p] = (pm__interval){(double)NAN, (double)NAN};
        if (row->expected[p] > 0.0)
            row->flux_ci95[p] = interval_of_ratio(item->flux[p], all->came[p],
                                                  trials < all->row.trials ? trials : all->row.trials, without);
    }
    row->kept = came > 0.0 ? row->flux[PM__EVERYWHERE] / came : (double)NAN;
}

/* s, median: until the photons are stored, without importance and map. NULL: NAN. */
static double cost_of(const pm__storage_item *item, double *scratch)
{
    const size_t trials = item ? item->row.trials : 0;
    for (size_t t = 0; t < trials; t++)
        scratch[t] = item->trace_s[t] + item->policy_s[t];
    return trials ? pm__median(scratch, trials) : (double)NAN;
}

/* `all`, asked for as many; NULL: there is none. */
static const pm__storage_item *all_beside(const pm__storage_job *job, const pm__storage_row *row)
{
    for (size_t i = 0; i < job->item_count && !job->items[i].hidden; i++) {
        const pm__storage_row *const other = &job->items[i].row;
        if (pm__storage_is_all(other) && other->map == row->map && other->photons == row->photons &&
            other->wanted == row->wanted)
            return &job->items[i];
    }
    return NULL;
}

static void fill_row(const pm__storage_job *job, pm__storage_item *item, double *without)
{
    pm__storage_row *const row = &item->row;
    const bool needs = pm__policy_needs_importance(row->policy);
    row->importons = needs ? pm__importance_count(job->importance, row->map) : 0;
    row->emitted = item->emitted / (double)row->trials;
    row->stored = mean_of(item->stored, row->trials);
    row->importance_s = needs ? job->importance_s : 0.0;
    row->trace_s = median_of(item->trace_s, row->trials, without);
    row->policy_s = median_of(item->policy_s, row->trials, without);
    row->build_s = median_of(item->build_s, row->trials, without);
    row->total_s = median_of(item->total_s, row->trials, without);
    row->cost_added = cost_of(item, without) / cost_of(all_beside(job, row), without) - 1.0;
    row->error = pm__tally_error(&item->tally);
    fill_flux(job, item, without);
}

/* ---- Fronts ------------------------------------------------------------------------------------ */

typedef enum cost { STORED, TRACE, TIME, COSTS } cost;

/* A policy's items of one map: items[first .. first + count - 1], and the row of the first. */
typedef struct span {
    const pm__storage_item *items;
    size_t count, row, trials;
    bool whole;           /* errors are those of the whole image */
    const double **lists; /* [cost + 1][count], the errors last */
} span;

static bool is_shown(const pm__storage_item *item)
{
    return !item->hidden && item->row.trials >= 2;
}

static pm_status list_span(const pm__storage_item *items, size_t count, size_t row, bool whole, span *s)
{
    *s = (span){items, count, row, SIZE_MAX, whole, pm__alloc((COSTS + 1) * count, sizeof *s->lists)};
    if (!s->lists)
        return PM_ENOMEM;
    for (size_t i = 0; i < count; i++) {
        s->lists[STORED * count + i] = items[i].stored;
        s->lists[TRACE * count + i] = items[i].trace_s;
        s->lists[TIME * count + i] = items[i].total_s;
        s->lists[COSTS * count + i] = whole ? items[i].tally.square : items[i].tally.added;
        s->trials = items[i].row.trials < s->trials ? items[i].row.trials : s->trials;
    }
    return PM_OK;
}

static pm__sizes sizes_of(const span *s, cost what, size_t trials)
{
    return (pm__sizes){s->count, trials, (const double *const *)(s->lists + COSTS * s->count),
                       (const double *const *)(s->lists + (size_t)what * s->count)};
}

static void compare(const span *mine, const span *all, pm__storage_front *front)
{
    const size_t trials = mine->trials < all->trials ? mine->trials : all->trials;
    double *const ratios[COSTS] = {&front->stored_ratio, &front->trace_ratio, &front->time_ratio};
    pm__interval *const intervals[COSTS] = {&front->stored_ci95, &front->trace_ci95, &front->time_ci95};
    for (int c = 0; c < COSTS; c++) {
        const pm__sizes own = sizes_of(mine, (cost)c, trials), other = sizes_of(all, (cost)c, trials);
        const pm__equal equal = pm__equal_error(&own, &other);
        *ratios[c] = equal.ratio;
        *intervals[c] = equal.ci95;
        if (c == STORED)
            front->rel_error = equal.error;
        if (c == STORED && equal.why)
            (void)snprintf(front->detail, sizeof front->detail, "%s", equal.why);
    }
}

static pm_status list_front(const span *s, cost what, size_t **front, size_t *count)
{
    const pm__sizes sizes = sizes_of(s, what, s->trials);
    *front = malloc((s->count + 1) * sizeof **front);
    if (!*front)
        return PM_ENOMEM;
    *count = pm__undominated(&sizes, *front);
    for (size_t i = 0; i < *count; i++)
        (*front)[i] += s->row;
    return PM_OK;
}

static pm_status fill_front(const span *mine, const span *all, pm__storage_front *front)
{
    const pm__interval none = {(double)NAN, (double)NAN};
    *front = (pm__storage_front){.policy = mine->items->row.policy, .map = mine->items->row.map,
                                 .rel_error = (double)NAN, .whole = mine->whole, .stored_ratio = (double)NAN,
                                 .trace_ratio = (double)NAN,
                                 .time_ratio = (double)NAN, .stored_ci95 = none, .trace_ci95 = none,
                                 .time_ci95 = none};
    if (all)
        compare(mine, all, front);
    else
        (void)snprintf(front->detail, sizeof front->detail, "all is not among the policies");
    const pm_status status = list_front(mine, STORED, &front->stored_front, &front->stored_count);
    return status ? status : list_front(mine, TIME, &front->time_front, &front->time_count);
}

/* The items of one policy and map from `first` on. */
static size_t run_length(const pm__storage_job *job, size_t first)
{
    size_t end = first;
    while (end < job->item_count && !job->items[end].hidden &&
           job->items[end].row.policy == job->items[first].row.policy &&
           job->items[end].row.map == job->items[first].row.map)
        end++;
    return end - first;
}

static bool all_shown(const pm__storage_job *job, size_t first, size_t count)
{
    for (size_t i = first; i < first + count; i++)
        if (!is_shown(&job->items[i]))
            return false;
    return true;
}

/* That of `all`, all 0 where there is none. */
static pm_status find_all(const pm__storage_job *job, pm__map_kind kind, bool whole, span *all)
{
    *all = (span){0};
    for (size_t i = 0, count; i < job->item_count && !job->items[i].hidden; i += count) {
        count = run_length(job, i);
        const pm__storage_row *const row = &job->items[i].row;
        if (row->map == kind && pm__storage_is_all(row) && all_shown(job, i, count))
            return list_span(&job->items[i], count, 0, whole, all);
    }
    return PM_OK;
}

/* Does some row of the map add nothing to the error of large maps, while all are clear of the reference's own? */
static bool by_whole_error(const pm__storage_job *job, pm__map_kind kind)
{
    bool added = true, whole = true;
    for (size_t i = 0; i < job->item_count; i++) {
        const pm__storage_row *const row = &job->items[i].row;
        if (row->map != kind || !is_shown(&job->items[i]))
            continue;
        added = added && row->error.added > 0.0;
        whole = whole && row->error.rmse > 0.0;
    }
    return !added && whole;
}

static pm_status make_fronts(pm__storage_job *job)
{
    pm__storage_result *const r = job->result;
    const bool whole[PM__MAP_KINDS] = {by_whole_error(job, PM__CAUSTIC_MAP), by_whole_error(job, PM__GLOBAL_MAP)};
    pm_status status = PM_OK;
    size_t row = 0;
    for (size_t i = 0, count; i < job->item_count && !job->items[i].hidden && status == PM_OK; i += count) {
        span mine = {0}, all = {0};
        count = run_length(job, i);
        if (!all_shown(job, i, count))
            break; /* it was interrupted here: the rest has even fewer */
        status = list_span(&job->items[i], count, row, whole[job->items[i].row.map], &mine);
        if (status == PM_OK)
            status = find_all(job, job->items[i].row.map, mine.whole, &all);
        if (status == PM_OK)
            status = fill_front(&mine, all.items ? &all : NULL, &r->fronts[r->front_count++]);
        free(mine.lists);
        free(all.lists);
        row += count;
    }
    return status;
}

pm_status pm__storage_summarize(pm__storage_job *job, pm_error *error)
{
    pm__storage_result *const r = job->result;
    double *const without = pm__alloc(job->wish->trials, sizeof *without);
    r->rows = calloc(job->item_count + 1, sizeof *r->rows);
    r->fronts = calloc(job->item_count + 1, sizeof *r->fronts);
    pm_status status = without && r->rows && r->fronts ? PM_OK : PM_ENOMEM;
    for (size_t i = 0; i < job->item_count && status == PM_OK; i++)
        if (is_shown(&job->items[i])) {
            fill_row(job, &job->items[i], without);
            r->rows[r->row_count++] = job->items[i].row;
        }
    if (status == PM_OK)
        status = make_fronts(job);
    free(without);
    return status ? pm__fail(error, status, "out of memory") : PM_OK;
}
