/* report: result files and images as one page. */
#include "commands.h"
#include "option_values.h"
#include "refused.h"
#include "report_files.h"
#include "version.h"

#include <stdlib.h>
#include <string.h>

static pm_status set_folder(pm__settings *settings, const char *text, pm_error *error)
{
    if (strcmp(text, "-") == 0)
        return pm__fail(error, PM_EINVAL, "a folder is needed, not standard output");
    return pm__parse_path(text, &settings->output, error);
}

static pm_status set_figures(pm__settings *settings, const char *text, pm_error *error)
{
    return pm__parse_path(text, &settings->figures, error);
}

static pm_status check(const pm__settings *settings, pm__report *report, pm_error *error)
{
    if (settings->operand_count == 0)
        return pm__fail(error, PM_EINVAL, "result files are needed: FILE.json...");
    if (!settings->output)
        return pm__fail(error, PM_EINVAL, "-o DIR is needed: the folder of the page");
    report->version = PM_VERSION;
    return pm__report_set_date(report, getenv("SOURCE_DATE_EPOCH"), error);
}

/* Two images of one name are a mistake of usage, not of a file. */
static int load(const pm__settings *settings, pm__report *report, pm_error *error)
{
    for (size_t i = 0; i < settings->operand_count; i++) {
        const pm_status status = pm__report_add(report, settings->operands[i], error);
        /* Memory refused to Jansson looks like a file that is malformed. */
        if (status != PM_OK && pm__refused_status(NULL) != PM_OK)
            return pm__exit_status(pm__refused_status(error));
        if (status != PM_OK)
            return status == PM_EINVAL ? PM__EXIT_USAGE : pm__exit_status_of_input(status);
    }
    if (report->result_count > 0)
        return PM__EXIT_DONE;
    (void)pm__fail(error, PM_EINVAL, "a result file is needed besides images: FILE.json");
    return PM__EXIT_USAGE;
}

static void say(const pm__settings *settings, const pm__report *report)
{
    size_t beside = 0, i;
    json_t *const missing = pm__report_missing(report), *part;
    for (i = 0; i < report->image_count; i++)
        beside += report->images[i].beside;
    (void)printf("%s/index.html: %zu result file%s, %zu image%s", settings->output, report->result_count,
                 report->result_count == 1 ? "" : "s", report->image_count, report->image_count == 1 ? "" : "s");
    if (beside)
        (void)printf(", %zu of them in %s/images", beside, settings->output);
    (void)putchar('\n');
    json_array_foreach(missing, i, part)
        (void)printf("missing: %s; %s\n", json_string_value(json_object_get(part, "what")),
                     json_string_value(json_object_get(part, "how")));
    json_decref(missing);
}

static int run(pm__settings *settings)
{
    pm_error error = {""};
    pm__report report = {.version = NULL};
    int exit_status = pm__exit_status(check(settings, &report, &error));
    if (exit_status == PM__EXIT_DONE)
        exit_status = load(settings, &report, &error);
    if (exit_status == PM__EXIT_DONE) {
        pm__report_place(&report);
        pm_status status = pm__report_files_write(&report, settings->output, &error);
        if (status == PM_OK && settings->figures)
            status = pm__report_figures_write(&report, settings->figures, settings->quiet, &error);
        /* Nothing here is what was asked for in the wrong way. */
        exit_status = status == PM_OK ? PM__EXIT_DONE : PM__EXIT_OTHER;
    }
    if (exit_status != PM__EXIT_DONE)
        pm__complain("report", "%s", *error.text ? error.text : "out of memory");
    else if (!settings->quiet)
        say(settings, &report);
    pm__report_free(&report);
    return exit_status;
}

static const pm__option option_output = {"output", 'o', "DIR", "the folder of the page, made where there is none",
                                         set_folder};
static const pm__option option_figures = {"figures", 0, "DIR",
                                          "draw figures for papers there: SVG and PDF, with gnuplot (none)",
                                          set_figures};
static const pm__option *const options_taken[] = {&option_output, &option_figures, &pm__option_quiet};

const pm__command pm__command_report = {
    .name = "report",
    .operands = "FILE.json... [IMAGE.exr...]",
    .max_operands = PM__MAX_OPERANDS,
    .job = "result files and images as one page that works from a double click, without a network",
    .text = "FILE.json: what any command wrote with --json. IMAGE.exr: what `render` wrote, or others; of more\n"
            "than 256x256 pixels they are reduced. DIR/index.html is the page; images of further scenes, beyond\n"
            "8 MB, come beside it into DIR/images. What a whole report would have besides is said, in the page\n"
            "too. The page's date is now, or SOURCE_DATE_EPOCH. `make report` makes all of it.\n\n"
            "Examples:\n"
            "  photonbench report accuracy.json -o report\n"
            "  photonbench report *.json images.*.exr -o build/report\n"
            "  photonbench report accuracy.json search.json -o report --figures report/figures\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
