/* What `storage` shows on the screen, 100 columns. */
#include "progress.h"
#include "storage_task.h"
#include "table.h"
#include "wrap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void print_heading(FILE *file, const pm__storage_scene *scene, bool colourful)
{
    const pm__storage_result *const r = &scene->result;
    char name[PM__MAX_SPEC], text[300];
    pm__spec_format(scene->scene, name, sizeof name);
    (void)snprintf(text, sizeof text, "%zux%zu pixels of %zu paths beside the stored reference, mean %.6g W/(m2 sr); "
                                      "%zu trials", r->width, r->height, r->spp, r->truth_mean, r->trials);
    (void)fprintf(file, "\n%s%s%s: ", colourful ? "\033[1m" : "", name, colourful ? "\033[0m" : "");
    pm__wrap(file, r->row_count ? text : scene->detail, (int)strlen(name) + 2, 4);
}

static void print_count(FILE *file, int width, double value)
{
    if (value < 1e7)
        (void)fprintf(file, " %*.0f", width - 1, value);
    else
        (void)fprintf(file, " %*.2e", width - 1, value);
}

static const double rounding = 1e-6; /* relative: powers are floats */

/* The share of what is expected, in percent, marked where its interval does not hold 100. */
static void print_share(FILE *file, int width, double stored, double expected, pm__interval interval)
{
    const bool off = interval.low > 1.0 + rounding || interval.high < 1.0 - rounding;
    if (isfinite(stored / expected))
        (void)fprintf(file, "%*.2f%c", width - 1, 100.0 * stored / expected, off ? '!' : ' ');
    else
        (void)fprintf(file, "%*s ", width - 1, "-");
}

static void print_row(FILE *file, const pm__storage_row *row)
{
    print_count(file, 10, row->emitted);
    print_count(file, 9, row->stored);
    (void)fputc(' ', file);
    for (int p = 0; p < PM__PARTS; p++)
        print_share(file, 8, row->flux[p], row->expected[p], row->flux_ci95[p]);
    pm__table_number(file, 6, row->spread, 0);
    (void)fputc(' ', file);
    pm__table_number(file, 6, 100.0 * row->error.rmse, 0);
    pm__table_interval(file, row->error.rmse_ci95, 0);
    (void)fputc(' ', file);
    pm__table_number(file, 6, 100.0 * row->error.noise, 0);
    (void)fputc(' ', file);
    pm__table_number(file, 6, 100.0 * row->error.added, 0);
    const double times[] = {row->trace_s, row->policy_s, row->total_s};
    for (int i = 0; i < 3; i++)
        pm__table_number(file, 6, times[i], 0);
    (void)fputc('\n', file);
}

static void print_map(FILE *file, const pm__storage_result *r, pm__map_kind map, bool colourful)
{
    const pm__spec *before = NULL;
    bool any = false;
    for (size_t i = 0; i < r->row_count; i++) {
        const pm__storage_row *const row = &r->rows[i];
        char name[PM__MAX_SPEC];
        if (row->map != map)
            continue;
        if (!any)
            (void)fprintf(file,
                          "  %s%s map%s\n      sent   stored    flux  import. spread   rmse    95 %% interval  noise  "
                          "added trace polic total\n", colourful ? "\033[1m" : "", pm__map_names[map],
                          colourful ? "\033[0m" : "");
        any = true;
        if (row->policy != before) {
            pm__spec_format_short(row->policy, name, sizeof name);
            (void)fprintf(file, "    %s%s\n", name, row->importons ? "" : " (without importance)");
        }
        before = row->policy;
        print_row(file, row);
    }
}

/* ---- Fronts ------------------------------------------------------------------------------------ */

static double rank_of(const pm__storage_front *front)
{
    return isfinite(front->stored_ratio) ? front->stored_ratio : 0.0;
}

/* By map, then the largest ratio first. */
static int by_ratio(const void *a, const void *b)
{
    const pm__storage_front *const p = *(const pm__storage_front *const *)a;
    const pm__storage_front *const q = *(const pm__storage_front *const *)b;
    const double x = rank_of(p), y = rank_of(q);
    return p->map != q->map ? (p->map < q->map ? -1 : 1) : x > y ? -1 : x < y ? 1 : p < q ? -1 : p > q;
}

static void print_ratio(FILE *file, double ratio, pm__interval interval)
{
    if (isfinite(ratio))
        (void)fprintf(file, " %7.3g", ratio);
    else
        (void)fprintf(file, " %7s", "-");
    if (interval.low >= 0.001 && interval.high < 1000.0)
        (void)fprintf(file, " [%5.3g,%5.3g]", interval.low, interval.high);
    else
        (void)fprintf(file, " %13s", "any"); /* as good as */
}

static void print_front(FILE *file, const pm__storage_front *front)
{
    char name[PM__MAX_SPEC];
    pm__spec_format_short(front->policy, name, sizeof name);
    (void)fprintf(file, "    %-17s", name);
    if (strlen(name) > 17)
        (void)fprintf(file, "\n%21s", "");
    if (!isfinite(front->stored_ratio)) {
        (void)fputs("     - ", file);
        pm__wrap(file, front->detail, 28, 28);
        return;
    }
    pm__table_number(file, 6, 100.0 * front->rel_error, 0);
    print_ratio(file, front->stored_ratio, front->stored_ci95);
    print_ratio(file, front->trace_ratio, front->trace_ci95);
    print_ratio(file, front->time_ratio, front->time_ci95);
    (void)fputc('\n', file);
}

static bool is_all(const pm__spec *policy)
{
    return strcmp(policy->entry->name, "all") == 0;
}

static void print_fronts(FILE *file, const pm__storage_result *r, bool colourful)
{
    const pm__storage_front **const order = calloc(r->front_count + 1, sizeof *order);
    bool any = false;
    for (size_t i = 0; order && i < r->front_count; i++) {
        order[i] = &r->fronts[i];
        any |= is_all(r->fronts[i].policy);
    }
    if (any && r->front_count > 1) {
        qsort(order, r->front_count, sizeof(const pm__storage_front *), by_ratio);
        (void)fprintf(file, "  %sat equal error `all` needs so many times as much%s\n%22serror  stored"
                            "  95 %% interv.  tracing  95 %% interv.   in all  95 %% interv.\n",
                      colourful ? "\033[1m" : "", colourful ? "\033[0m" : "", "");
        for (size_t i = 0; i < r->front_count; i++) {
            if (!i || order[i]->map != order[i - 1]->map)
                (void)fprintf(file, "    %s map, by %s\n", pm__map_names[order[i]->map],
                              order[i]->whole ? "rmse" : "what is added");
            if (!is_all(order[i]->policy))
                print_front(file, order[i]);
        }
    }
    free(order);
}

static void print_scene(FILE *file, const pm__storage_scene *scene, bool colourful)
{
    const bool refused = strcmp(scene->status, "unsupported") == 0;
    print_heading(file, scene, colourful);
    if (scene->result.row_count && *scene->detail) {
        (void)fprintf(file, "  %s", refused ? "unsupported: " : "");
        pm__wrap(file, scene->detail, refused ? 15 : 2, 4);
    }
    for (int map = 0; map < PM__MAP_KINDS; map++)
        print_map(file, &scene->result, (pm__map_kind)map, colourful);
    print_fronts(file, &scene->result, colourful);
}

void pm__storage_print(FILE *file, const pm__storage_task *task)
{
    const bool colourful = pm__colourful(file);
    bool any = false;
    for (size_t i = 0; i < task->count; i++) {
        if (!task->scenes[i].status)
            continue;
        print_scene(file, &task->scenes[i], colourful);
        any |= task->scenes[i].result.row_count != 0;
    }
    if (!any)
        return;
    (void)fputc('\n', file);
    pm__wrap(file,
             "flux, import.: stored, in % of what comes with even sending, everywhere and in important places alone; "
             "! the 95 % interval does not hold 100. spread: the largest power within k neighbours over their median. "
             "rmse, noise: of the image, in % of its mean; added: what this map adds to the error of large maps, "
             "sqrt(rmse^2 - theirs^2). trace, polic, total: seconds of sending, of the "
             "policy, and until the map is there, importance included; medians over trials. sent, stored: means of a "
             "trial. -: does not exist.",
             0, 0);
}
