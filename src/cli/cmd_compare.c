/* compare: what became better or worse from one result file to another. */
#include "commands.h"
#include "compare.h"
#include "compare_images.h"
#include "progress.h"
#include "results.h"
#include "wrap.h"

#include "../base/clock.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { FULL_TABLE = 60 }; /* beyond, the screen shows only what differs */

typedef struct comparing {
    pm__result_file a, b;
    pm__comparisons list;
} comparing;

#define FIELDS(X)                                                          \
    X(row, pm__text_cell(c->label))                                        \
    X(quantity, pm__text_cell(c->quantity))                                \
    X(a, pm__number_cell(c->a))                                            \
    X(b, pm__number_cell(c->b))                                            \
    X(change, pm__number_cell(c->change))                                  \
    X(change_ci95, pm__interval_cell(c->change_ci95))                      \
    X(change_kind, pm__text_cell(!c->tested ? NULL : c->factor ? "factor" : "difference")) \
    X(samples_a, c->tested ? pm__count_cell(c->samples_a) : absent)        \
    X(samples_b, c->tested ? pm__count_cell(c->samples_b) : absent)        \
    X(p, pm__number_cell(c->p))                                            \
    X(p_family, pm__number_cell(c->p_family))                              \
    X(verdict, pm__text_cell(pm__verdict_text(c->verdict)))

static const char *const fields[] = {
#define X(name, value) #name,
    FIELDS(X)
#undef X
};

enum { FIELD_COUNT = sizeof fields / sizeof *fields };

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    const comparing *const all = context;
    const pm__comparison *const c = &all->list.items[index];
    const pm__cell absent = {.type = PM__ABSENT};
    const pm__cell filled[FIELD_COUNT] = {
#define X(name, value) value,
        FIELDS(X)
#undef X
    };
    memcpy(cells, filled, sizeof filled);
}

static void print_tested(FILE *file, const pm__comparison *c)
{
    char change[32], low[32], high[32];
    const char *const form = c->factor ? "%.4g" : "%+.3g";
    (void)snprintf(change, sizeof change, form, c->change);
    (void)snprintf(low, sizeof low, form, c->change_ci95.low);
    (void)snprintf(high, sizeof high, form, c->change_ci95.high);
    (void)fprintf(file, "  %-9s %10.4g -> %-10.4g %c %9s [%9s, %9s]  ", c->quantity, c->a, c->b, c->factor ? 'x' : ' ',
                  change, low, high);
}

static void print_comparison(FILE *file, const pm__comparison *c, bool colourful)
{
    const bool striking = c->verdict == PM__REGRESSED || c->verdict == PM__IMPROVED;
    const char *const colour = c->verdict == PM__REGRESSED ? "\033[1;31m" : "\033[1;32m";
    if (c->tested)
        print_tested(file, c);
    else
        (void)fprintf(file, "  %-69s", c->quantity ? c->quantity : "the row");
    (void)fprintf(file, "%s%s%s\n", colourful && striking ? colour : "", pm__verdict_text(c->verdict),
                  colourful && striking ? "\033[0m" : "");
}

static void print_counts(FILE *file, const comparing *all)
{
    const pm__comparisons *const list = &all->list;
    (void)fprintf(file, "%sA: %s\nB: %s\n", list->count ? "\n" : "", all->a.name, all->b.name);
    for (int v = 0; v < PM__VERDICT_COUNT; v++)
        (void)fprintf(file, "%s%zu %s", v ? ", " : "", list->verdicts[v], pm__verdict_text((pm__verdict)v));
    (void)fputc('\n', file);
}

static void print_legend(FILE *file, const comparing *all)
{
    char text[600];
    const bool search = strcmp(all->a.command, "search") == 0;
    (void)snprintf(
        text, sizeof text,
        "%s; x: B over A, else B less A%s. Intervals and verdicts are at 95 %% for all %zu comparisons together.",
        search ? "ratio: the baseline's time over the row's, of the same run, above 1 is faster; a change within "
                 "1 % counts as none"
               : "rel_*: relative to the mean of the truth or reference",
        search ? "" : " (of a bias: of its size)", all->list.tests);
    pm__wrap(file, text, 0, 0);
}

static const char *cpu_of(const pm__result_file *file)
{
    const char *const cpu = json_string_value(json_object_get(json_object_get(file->root, "machine"), "cpu"));
    return cpu ? cpu : "";
}

static void print_screen(FILE *file, const comparing *all)
{
    const pm__comparisons *const list = &all->list;
    const bool full = list->count <= FULL_TABLE;
    const char *shown = NULL;
    for (size_t i = 0; i < list->count; i++) {
        const pm__comparison *const c = &list->items[i];
        if (!full && c->verdict == PM__SAME)
            continue;
        if (c->label != shown)
            pm__wrap(file, c->label, 0, 4);
        shown = c->label;
        print_comparison(file, c, pm__colourful(file));
    }
    print_counts(file, all);
    if (!full && list->verdicts[PM__SAME])
        (void)fputs("(rows that are not distinguishable are not shown; --json, --csv and --markdown have them)\n",
                    file);
    if (strcmp(all->a.command, "search") == 0 && strcmp(cpu_of(&all->a), cpu_of(&all->b)) != 0)
        (void)fputs("The processors differ, and ratios may differ with them.\n", file);
    if (list->tests)
        print_legend(file, all);
}

static pm_status write_all(const pm__settings *s, comparing *all, double start, pm_error *error)
{
    pm__sinks sinks;
    pm_status status = pm__sinks_open(s, true, &sinks, error);
    if (status != PM_OK)
        return status;
    json_t *const options = json_pack("{s:s, s:s, s:s, s:I}", "a", all->a.name, "b", all->b.name, "command",
                                      all->a.command, "tests", (json_int_t)all->list.tests);
    const pm__results results = {.command = "compare",
                                 .options = options,
                                 .settings = s,
                                 .wall_s = pm__seconds() - start,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT,
                                 .row_count = all->list.count,
                                 .row = fill_row,
                                 .context = all};
    if (pm__sinks_screen(&sinks))
        print_screen(pm__sinks_screen(&sinks), all);
    status = pm__sinks_finish(&sinks, &results, error);
    json_decref(options);
    return status;
}

/* A file that is well formed but of the wrong kind is a mistake of usage, not of the file. */
static int exit_status_of_file(pm_status status)
{
    return status == PM_EINVAL ? PM__EXIT_USAGE : pm__exit_status_of_input(status);
}

static int load(const pm__settings *s, comparing *all, pm_error *error)
{
    if (s->operand_count != 2) {
        (void)pm__fail(error, PM_EINVAL, "two result files are needed, or two images: A.json B.json, A.exr B.exr");
        return PM__EXIT_USAGE;
    }
    if (s->metrics.count) {
        (void)pm__fail(error, PM_EINVAL, "--metric is for two images");
        return PM__EXIT_USAGE;
    }
    pm_status status = pm__result_file_load(s->operands[0], &all->a, error);
    if (status == PM_OK)
        status = pm__result_file_load(s->operands[1], &all->b, error);
    if (status == PM_OK && strcmp(all->a.command, all->b.command) != 0)
        status = pm__fail(error, PM_EINVAL, "different commands cannot be compared: %.120s is of %s, %.120s of %s",
                          all->a.name, all->a.command, all->b.name, all->b.command);
    if (status == PM_OK)
        status = pm__compare(&all->a, &all->b, &all->list, error);
    return exit_status_of_file(status);
}

static int compare_results(pm__settings *settings)
{
    pm_error error = {""};
    comparing all;
    const double start = pm__seconds();
    memset(&all, 0, sizeof all);
    int exit_status = load(settings, &all, &error);
    if (exit_status == PM__EXIT_DONE) {
        exit_status = pm__exit_status(write_all(settings, &all, start, &error));
        if (exit_status == PM__EXIT_DONE && all.list.verdicts[PM__REGRESSED])
            exit_status = PM__EXIT_CHECK_FAILED;
    }
    if (*error.text)
        pm__complain("compare", "%s", error.text);
    free(all.list.items);
    pm__result_file_free(&all.a);
    pm__result_file_free(&all.b);
    return exit_status;
}

/* One image, and something else. */
static int refuse_mixed(const char *image, const char *other)
{
    char names[2][PM__NAME_SIZE];
    pm__quote_path(image, names[0]);
    pm__quote_path(other, names[1]);
    if (access(other, R_OK) != 0) {
        pm__complain("compare", "%s: cannot be opened: %s", names[1], strerror(errno));
        return PM__EXIT_INPUT;
    }
    pm__complain("compare", "%s is an OpenEXR image, %s is none: two images can be compared, or two JSON results",
                 names[0], names[1]);
    return PM__EXIT_USAGE;
}

static int run(pm__settings *settings)
{
    const bool two = settings->operand_count == 2;
    const bool a = two && pm__is_image_file(settings->operands[0]), b = two && pm__is_image_file(settings->operands[1]);
    if (a && b)
        return pm__compare_images(settings);
    if (a || b)
        return refuse_mixed(settings->operands[!a], settings->operands[a]);
    return compare_results(settings);
}

static const pm__option *const options_taken[] = {&pm__compare_option_metric, &pm__option_json,
                                                  &pm__option_csv,            &pm__option_markdown,
                                                  &pm__compare_option_output, &pm__option_quiet};

const pm__command pm__command_compare = {
    .name = "compare",
    .operands = "A B",
    .max_operands = 2,
    .job = "two result files: improved, regressed or not distinguishable; two images: error metrics",
    .text = "Two JSON results of search, accuracy or storage: rows of A and B with the same case, search or\n"
            "estimator, k and so on are compared; what only one has is listed.\n"
            "search: the ratio to the baseline of the same run, never times, by all its samples (Mann-Whitney).\n"
            "accuracy: rel_bias (its size), rel_noise and rel_rmse, by their intervals over trials (Welch).\n"
            "storage: rel_bias (its size), rel_rmse and rel_added, likewise.\n"
            "A difference counts where chance would not show one as large in 95 % of such comparisons of whole\n"
            "files. Exit status 1: something regressed.\n\n"
            "Two OpenEXR images of one size: A is tested, B is the reference. Metrics are mse, relmse, mape,\n"
            "smape, ssim, flip and hdrflip ('photonbench list metrics'), a metric NAME[:key=value[,...]]. -o NAME\n"
            "writes NAME.METRIC.exr, what each pixel has, and NAME.METRIC.png, that in false colour.\n\n"
            "Examples:\n"
            "  photonbench compare before.json after.json\n"
            "  photonbench compare before.json after.json --markdown changes.md --json -\n"
            "  photonbench compare image.exr reference.exr\n"
            "  photonbench compare image.exr reference.exr --metric relmse,hdrflip:ppd=40 -o error\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
