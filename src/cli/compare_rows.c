/* Which rows of two files belong together, and what their difference is worth. */
#include "compare.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TRIALS = 1000000 }; /* beyond, Student's t is as good as normal */
enum { EYE_GROUPS = 4 };        /* of storage */
static const double family_error = 0.05;
static const double rounding = 1e-9; /* differences below this part are no differences, whatever the intervals say */

const char *pm__verdict_text(pm__verdict verdict)
{
    static const char *const texts[] = {"improved", "regressed", "not distinguishable", "only in A", "only in B"};
    return texts[verdict];
}

static pm_status append(pm__comparisons *list, const pm__comparison *item, pm_error *error)
{
    void *items = list->items;
    const int refused = pm__grow(&items, &list->capacity, list->count + 1, sizeof *item);
    list->items = items;
    if (refused)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    list->tests += item->tested;
    list->items[list->count++] = *item;
    return PM_OK;
}

static pm__comparison blank(const char *label, const char *quantity, size_t row_a, size_t row_b)
{
    return (pm__comparison){.label = label, .quantity = quantity, .row_a = row_a, .row_b = row_b, .a = (double)NAN,
                            .b = (double)NAN, .change = (double)NAN, .change_ci95 = {(double)NAN, (double)NAN},
                            .p = (double)NAN, .p_family = (double)NAN, .verdict = PM__SAME};
}

/* A value there, and all that a test needs beside it? */
typedef struct presence {
    bool a, b;
} presence;

/* A quantity of a pair of rows: to be tested where both have it, else noted where one has. */
static pm_status add_quantity(pm__comparisons *list, pm__comparison item, presence there, pm_error *error)
{
    if (!there.a && !there.b)
        return PM_OK;
    item.tested = there.a && there.b;
    item.verdict = item.tested ? PM__SAME : there.a ? PM__ONLY_A : PM__ONLY_B;
    return append(list, &item, error);
}

static pm_status has_ratio(const pm__result_file *file, size_t index, bool *there, pm_error *error)
{
    double ratio;
    const json_t *const samples = json_object_get(json_array_get(file->rows, index), "ratio_samples");
    const pm_status status = pm__result_number(file, index, "ratio", &ratio, there, error);
    if (status == PM_OK && *there && !json_is_array(samples))
        return pm__fail(error, PM_EFORMAT, "%s: rows[%zu].ratio_samples: expected an array of numbers", file->name,
                        index);
    *there = *there && json_array_size(samples) > 0;
    return status;
}

/* Is this the baseline's own row, whose ratio is 1 by definition? The same search in batches, or behind a filter, has a
 * ratio of its own. */
static bool is_baseline(const pm__result_file *file, size_t index)
{
    const json_t *const row = json_array_get(file->rows, index);
    const char *const baseline = json_string_value(json_object_get(row, "baseline"));
    return baseline && strcmp(baseline, json_string_value(json_object_get(row, "search"))) == 0 &&
           !(json_number_value(json_object_get(row, "ratio")) != 1.0);
}

static pm_status add_search(const pm__result_file *a, const pm__result_file *b, pm__comparison item,
                            pm__comparisons *list, pm_error *error)
{
    const json_t *const exact_a = json_object_get(json_array_get(a->rows, item.row_a), "exact");
    const json_t *const exact_b = json_object_get(json_array_get(b->rows, item.row_b), "exact");
    presence there = {false, false};
    pm_status status = PM_OK;
    if (json_is_boolean(exact_a) && json_is_boolean(exact_b) && json_is_true(exact_a) != json_is_true(exact_b)) {
        item.quantity = "exact";
        item.a = json_is_true(exact_a);
        item.b = json_is_true(exact_b);
        item.verdict = json_is_true(exact_b) ? PM__IMPROVED : PM__REGRESSED;
        status = append(list, &item, error);
        item = blank(item.label, NULL, item.row_a, item.row_b);
    }
    if (status == PM_OK)
        status = has_ratio(a, item.row_a, &there.a, error);
    if (status == PM_OK)
        status = has_ratio(b, item.row_b, &there.b, error);
    item.quantity = "ratio";
    if (status == PM_OK && !is_baseline(a, item.row_a))
        status = add_quantity(list, item, there, error);
    return status;
}

/* A value with its interval over trials. */
typedef struct estimate {
    double value, trials, dof;
    pm__interval ci95;
    bool there;
} estimate;

/* Intervals of `storage` hold trials and, but for rel_added, four groups of eye paths, whose quantile is the widest:
 * with their degrees of freedom no test is sharper than the interval. */
static double dof_of(const pm__result_file *file, const char *quantity, double trials)
{
    const bool grouped = strcmp(file->command, "storage") == 0 && strcmp(quantity, "rel_added") != 0;
    return grouped ? fmin(trials - 1.0, EYE_GROUPS - 1.0) : trials - 1.0;
}

static pm_status read_estimate(const pm__result_file *file, size_t index, const char *quantity, estimate *e,
                               pm_error *error)
{
    char field[64];
    bool there, interval, trials;
    (void)snprintf(field, sizeof field, "%s_ci95", quantity);
    pm_status status = pm__result_number(file, index, quantity, &e->value, &there, error);
    if (status == PM_OK)
        status = pm__result_interval(file, index, field, &e->ci95, &interval, error);
    if (status == PM_OK)
        status = pm__result_number(file, index, "trials", &e->trials, &trials, error);
    if (status != PM_OK)
        return status;
    e->there = there && interval;
    e->trials = fmin(e->trials, MOST_TRIALS);
    e->dof = dof_of(file, quantity, e->trials);
    if (e->there && !(trials && e->trials >= 2.0))
        return pm__fail(error, PM_EFORMAT, "%s: rows[%zu].trials: expected a number, at least 2", file->name, index);
    return PM_OK;
}

/* Of `storage` only rel_rmse and rel_added have intervals; accuracy has no rel_added. */
static const char *const errors_compared[] = {"rel_bias", "rel_noise", "rel_rmse", "rel_added"};

static pm_status add_errors(const pm__result_file *a, const pm__result_file *b, pm__comparison item,
                            pm__comparisons *list, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < sizeof errors_compared / sizeof *errors_compared && status == PM_OK; i++) {
        estimate of_a, of_b;
        item.quantity = errors_compared[i];
        status = read_estimate(a, item.row_a, item.quantity, &of_a, error);
        if (status == PM_OK)
            status = read_estimate(b, item.row_b, item.quantity, &of_b, error);
        if (status == PM_OK)
            status = add_quantity(list, item, (presence){of_a.there, of_b.there}, error);
    }
    return status;
}

typedef struct place {
    const char *label;
    size_t row;
} place;

static int by_label(const void *a, const void *b)
{
    const place *const x = a, *const y = b;
    const int order = strcmp(x->label, y->label);
    return order ? order : (x->row > y->row) - (x->row < y->row);
}

static place *sorted_places(const pm__result_file *file)
{
    place *const places = pm__alloc(file->count, sizeof *places);
    for (size_t i = 0; places && i < file->count; i++)
        places[i] = (place){file->labels[i], i};
    if (places)
        qsort(places, file->count, sizeof *places, by_label);
    return places;
}

/* match[i]: the row of b for row i of a, or SIZE_MAX; taken[j] is set for those. Equal labels match in order. */
static int match_rows(const pm__result_file *a, const pm__result_file *b, size_t *match, bool *taken)
{
    place *const of_a = sorted_places(a), *const of_b = sorted_places(b);
    for (size_t i = 0, j = 0; of_a && of_b && i < a->count; i++) {
        while (j < b->count && strcmp(of_b[j].label, of_a[i].label) < 0)
            j++;
        const bool same = j < b->count && strcmp(of_b[j].label, of_a[i].label) == 0;
        match[of_a[i].row] = same ? of_b[j].row : SIZE_MAX;
        if (same)
            taken[of_b[j++].row] = true;
    }
    const int refused = of_a && of_b ? 0 : -1;
    free(of_a);
    free(of_b);
    return refused;
}

static pm_status list_rows(const pm__result_file *a, const pm__result_file *b, const size_t *match, const bool *taken,
                           pm__comparisons *list, pm_error *error)
{
    const bool search = strcmp(a->command, "search") == 0;
    pm_status status = PM_OK;
    for (size_t i = 0; i < a->count && status == PM_OK; i++) {
        pm__comparison item = blank(a->labels[i], NULL, i, match[i]);
        item.verdict = match[i] == SIZE_MAX ? PM__ONLY_A : PM__SAME;
        if (match[i] == SIZE_MAX)
            status = append(list, &item, error);
        else
            status = search ? add_search(a, b, item, list, error) : add_errors(a, b, item, list, error);
    }
    for (size_t j = 0; j < b->count && status == PM_OK; j++) {
        pm__comparison item = blank(b->labels[j], NULL, SIZE_MAX, j);
        item.verdict = PM__ONLY_B;
        if (!taken[j])
            status = append(list, &item, error);
    }
    return status;
}

static pm_status test_ratio(const pm__result_file *a, const pm__result_file *b, double level, pm__comparison *item,
                            pm_error *error)
{
    double *of_a = NULL, *of_b = NULL;
    pm_status status = pm__result_logs(a, item->row_a, "ratio_samples", &of_a, &item->samples_a, error);
    if (status == PM_OK)
        status = pm__result_logs(b, item->row_b, "ratio_samples", &of_b, &item->samples_b, error);
    if (status == PM_OK) {
        pm__shift shift;
        pm__interval unused;
        pm__rank_shift(of_a, item->samples_a, of_b, item->samples_b, level, log1p(PM__RATIO_TOLERANCE), &shift);
        item->factor = true;
        item->a = exp(pm__median_interval(of_a, item->samples_a, &unused));
        item->b = exp(pm__median_interval(of_b, item->samples_b, &unused));
        item->change = exp(shift.shift);
        item->change_ci95 = (pm__interval){exp(shift.interval.low), exp(shift.interval.high)};
        item->p = shift.p;
    }
    free(of_a);
    free(of_b);
    return status;
}

/* A standard error from the interval of Student's t that was made of it. */
static double standard_error(pm__interval ci95, double dof)
{
    return (0.5 * ci95.high - 0.5 * ci95.low) / pm__student_quantile(0.975, dof);
}

/* Welch: dof by Satterthwaite. Fills in change, interval and p for a difference with these standard errors. */
static void welch(double difference, double se_a, double se_b, const estimate *a, const estimate *b, double level,
                  pm__comparison *item)
{
    const double se = hypot(se_a, se_b), se_all = hypot(se, rounding);
    const double share_a = se > 0.0 ? se_a / se : 1.0, share_b = se > 0.0 ? se_b / se : 0.0;
    const double dof = 1.0 / (pow(share_a, 4.0) / a->dof + pow(share_b, 4.0) / b->dof);
    const double half = pm__student_quantile(0.5 + 0.5 * level, isfinite(dof) ? dof : 1.0) * se_all;
    item->change = difference;
    item->change_ci95 = (pm__interval){difference - half, difference + half};
    item->p = isfinite(se_all) ? pm__student_p(difference / se_all, dof) : 1.0;
}

/* Errors of `storage` are roots of squares without bias, cut at 0, and their intervals are made on squares. Where the
 * low end was cut, the high one says how wide it is; it then counts from 0 on. */
static double half_of_square(const estimate *e)
{
    const double high = e->ci95.high * e->ci95.high;
    return e->ci95.low > 0.0 ? 0.5 * (high - e->ci95.low * e->ci95.low) : high - e->value * e->value;
}

/* The change of the root that a change of the square by `difference` makes of a. */
static double of_root(double a, double difference)
{
    return sqrt(fmax(0.0, a * a + difference)) - a;
}

static void test_squares(const estimate *a, const estimate *b, double level, pm__comparison *item)
{
    const double quantile_a = pm__student_quantile(0.975, a->dof), quantile_b = pm__student_quantile(0.975, b->dof);
    welch(b->value * b->value - a->value * a->value, half_of_square(a) / quantile_a, half_of_square(b) / quantile_b, a,
          b, level, item);
    item->change = b->value - a->value;
    item->change_ci95 = (pm__interval){of_root(a->value, item->change_ci95.low),
                                       of_root(a->value, item->change_ci95.high)};
}

/* Noise and root mean square errors have their intervals on a log scale, a bias on its own; of a bias the size counts.
 * |a| and |b| differ where b - a and b + a both are off 0, so the test of the nearer one, ||b| - |a||, is the test. */
static pm_status test_error(const pm__result_file *file_a, const pm__result_file *file_b, double level,
                            pm__comparison *item, pm_error *error)
{
    estimate a, b;
    pm_status status = read_estimate(file_a, item->row_a, item->quantity, &a, error);
    if (status == PM_OK)
        status = read_estimate(file_b, item->row_b, item->quantity, &b, error);
    if (status != PM_OK)
        return status;
    const bool bias = strcmp(item->quantity, "rel_bias") == 0;
    const bool squares = !bias && strcmp(file_a->command, "storage") == 0;
    item->factor = !bias && !squares && a.ci95.low > 0.0 && b.ci95.low > 0.0 && a.value > 0.0 && b.value > 0.0;
    item->a = a.value;
    item->b = b.value;
    item->samples_a = (size_t)a.trials;
    item->samples_b = (size_t)b.trials;
    if (squares) {
        test_squares(&a, &b, level, item);
    } else if (item->factor) {
        const pm__interval log_a = {log(a.ci95.low), log(a.ci95.high)}, log_b = {log(b.ci95.low), log(b.ci95.high)};
        welch(log(b.value) - log(a.value), standard_error(log_a, a.dof), standard_error(log_b, b.dof), &a, &b,
              level, item);
        item->change = exp(item->change);
        item->change_ci95 = (pm__interval){exp(item->change_ci95.low), exp(item->change_ci95.high)};
    } else {
        welch(fabs(b.value) - fabs(a.value), standard_error(a.ci95, a.dof), standard_error(b.ci95, b.dof), &a, &b,
              level, item);
    }
    return PM_OK;
}

/* A ratio is better when larger, an error when smaller. */
static void judge(const pm__comparisons *list, pm__comparison *item)
{
    const bool up = item->change > (item->factor ? 1.0 : 0.0), up_is_good = strcmp(item->quantity, "ratio") == 0;
    item->p_family = fmin(1.0, item->p * (double)list->tests);
    if (item->p_family < family_error)
        item->verdict = up == up_is_good ? PM__IMPROVED : PM__REGRESSED;
}

static pm_status test_all(const pm__result_file *a, const pm__result_file *b, pm__comparisons *list, pm_error *error)
{
    const double level = 1.0 - family_error / (double)(list->tests ? list->tests : 1);
    pm_status status = PM_OK;
    for (size_t i = 0; i < list->count && status == PM_OK; i++) {
        pm__comparison *const item = &list->items[i];
        if (item->tested) {
            status = strcmp(a->command, "search") == 0 ? test_ratio(a, b, level, item, error)
                                                       : test_error(a, b, level, item, error);
            judge(list, item);
        }
        list->verdicts[item->verdict]++;
    }
    return status;
}

pm_status pm__compare(const pm__result_file *a, const pm__result_file *b, pm__comparisons *list, pm_error *error)
{
    size_t *const match = pm__alloc(a->count, sizeof *match);
    bool *const taken = pm__alloc_zero(b->count, sizeof *taken);
    pm_status status = PM_ENOMEM;
    if (match && taken && match_rows(a, b, match, taken) == 0)
        status = list_rows(a, b, match, taken, list, error);
    else
        (void)pm__fail(error, status, "out of memory");
    free(match);
    free(taken);
    return status == PM_OK ? test_all(a, b, list, error) : status;
}
