/* list: what there is, from the catalogues. */
#include "../../cases/scenes/list.h"
#include "../../estimators/estimator.h"
#include "../converge/converge.h"
#include "../methods/render.h"
#include "../metrics/metrics.h"
#include "../search/search.h"
#include "../transport/storing.h"
#include "commands.h"
#include "progress.h"
#include "results.h"
#include "wrap.h"

#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>

enum { NAME_COLUMN = 2, TEXT_COLUMN = 17, KIND_COUNT = 9, TEXT_SIZE = 4096, SIZE = 48 };

typedef struct kind {
    const char *name; /* the operand */
    const char *title;
    const char *option; /* that takes them */
    const pm__catalogue *catalogue;
} kind;

static const kind kinds[KIND_COUNT] = {
    {"estimators", "Estimators", "--estimator NAME[:key=value[,key=value...]]", &pm__estimators},
    {"searches", "Searches", "--search NAME", &pm__searches},
    {"cases", "Cases", "--case NAME[:key=value[,key=value...]]", &pm__cases},
    {"scenes", "Scenes", "--case scene:NAME[:key=value[,key=value...]]", &pm__scene_cases},
    {"samplers", "Samplers", "--sampler NAME[:key=value[,key=value...]]", &pm__samplers},
    {"methods", "Methods of render", "render --method NAME[:key=value[,key=value...]]", &pm__methods},
    {"methods", "Methods of converge", "converge --method NAME[:key=value[,key=value...]]", &pm__progressives},
    {"policies", "Policies", "storage --policy NAME[:key=value[,key=value...]]", &pm__policies},
    {"metrics", "Metrics of images", "compare --metric NAME[:key=value[,key=value...]]", &pm__metrics},
};

/* An entry and which kind it is of. */
typedef struct thing {
    const kind *kind;
    const pm__entry *entry;
} thing;

typedef struct listing {
    thing *items;
    size_t count;
    char text[TEXT_SIZE], size[SIZE]; /* of the row in hand */
} listing;

static const pm__case *case_of(const thing *item)
{
    const bool is_case = item->kind->catalogue == &pm__cases || item->kind->catalogue == &pm__scene_cases;
    return is_case ? (const pm__case *)(const void *)item->entry : NULL;
}

/* "k=1.1" or "last=full", the default as a user writes it. */
static void format_default(const pm__entry *entry, size_t i, char *text, size_t size)
{
    const pm__param *const param = &entry->params[i];
    pm__spec spec;
    char number[32];
    pm__spec_default(entry, &spec);
    if (param->type == PM__CHOICE) {
        const char *choice = param->choices;
        for (int skip = (int)spec.values[i]; skip > 0 && strchr(choice, '|'); skip--)
            choice = strchr(choice, '|') + 1;
        (void)snprintf(text, size, "%.*s", (int)strcspn(choice, "|"), choice);
        return;
    }
    pm__format_double(spec.values[i], number);
    (void)snprintf(text, size, "%s", number);
}

/* "1 to 100" or "full|half|none". */
static void format_range(const pm__param *param, char *text, size_t size)
{
    char low[32], high[32];
    pm__format_double(param->min, low);
    pm__format_double(param->max, high);
    if (param->type == PM__CHOICE)
        (void)snprintf(text, size, "%s", param->choices);
    else
        (void)snprintf(text, size, "%s%s to %s", param->type == PM__INTEGER ? "whole, " : "", low, high);
}

static void format_param(const pm__entry *entry, size_t i, char *text, size_t size)
{
    const pm__param *const param = &entry->params[i];
    char value[64], range[200];
    format_default(entry, i, value, sizeof value);
    format_range(param, range, sizeof range);
    (void)snprintf(text, size, "%s=%s%s%s (%s): %s", param->name, value, *param->unit ? " " : "", param->unit, range,
                   param->help);
}

/* "128x128": is there a stored reference of the scene, by which methods are judged? */
static bool has_reference(const pm__entry *scene, char size[SIZE])
{
    pm__spec spec;
    size_t width, height;
    pm__spec_default(scene, &spec);
    if (!pm__converge_reference_size(&spec, &width, &height))
        return false;
    (void)snprintf(size, SIZE, "%zux%zu", width, height);
    return true;
}

/* Of a scene: is there an exact answer, and of which light? */
static void print_answer(FILE *file, const pm__case *scene)
{
    char text[200], size[SIZE];
    if (scene->truth)
        (void)snprintf(text, sizeof text, "exact answer: of light paths %s: for accuracy, converge and advise",
                       scene->paths);
    else if (has_reference(&scene->entry, size))
        (void)snprintf(text, sizeof text, "no exact answer: for render, not for accuracy; its defaults have a stored "
                       "reference of %s: for converge and advise too", size);
    else
        (void)snprintf(text, sizeof text, "no exact answer, no reference: for render, not for accuracy, converge, "
                       "advise");
    (void)fprintf(file, "%*s", TEXT_COLUMN + 2, "");
    pm__wrap(file, text, TEXT_COLUMN + 2, TEXT_COLUMN + 6);
}

static void print_item(FILE *file, const thing *item)
{
    char text[600];
    const pm__case *const subject = case_of(item);
    (void)fprintf(file, "%*s%-*s", NAME_COLUMN, "", TEXT_COLUMN - NAME_COLUMN - 1, item->entry->name);
    (void)fputc(' ', file);
    const int column = (int)strlen(item->entry->name) + NAME_COLUMN + 1;
    (void)snprintf(text, sizeof text, "%s [%s]", item->entry->summary, item->entry->citation);
    pm__wrap(file, *item->entry->citation ? text : item->entry->summary, column > TEXT_COLUMN ? column : TEXT_COLUMN,
             TEXT_COLUMN);
    for (size_t i = 0; i < item->entry->param_count; i++) {
        format_param(item->entry, i, text, sizeof text);
        (void)fprintf(file, "%*s", TEXT_COLUMN + 2, "");
        pm__wrap(file, text, TEXT_COLUMN + 2, TEXT_COLUMN + 6);
    }
    if (item->kind->catalogue == &pm__scene_cases)
        print_answer(file, subject);
    for (size_t i = 0; subject && i < subject->region_count; i++) {
        (void)snprintf(text, sizeof text, "region %s: %s", subject->regions[i].name, subject->regions[i].summary);
        (void)fprintf(file, "%*s", TEXT_COLUMN + 2, "");
        pm__wrap(file, text, TEXT_COLUMN + 2, TEXT_COLUMN + 6);
    }
}

static void print_listing(FILE *file, const listing *list)
{
    for (size_t i = 0; i < list->count; i++) {
        const kind *const k = list->items[i].kind;
        if (!i || list->items[i - 1].kind != k)
            (void)fprintf(file, "%s%s   %s\n", i ? "\n" : "", k->title, k->option);
        print_item(file, &list->items[i]);
    }
}

static json_t *choices_of(const pm__param *param)
{
    if (param->type != PM__CHOICE)
        return json_null();
    json_t *const choices = json_array();
    for (const char *p = param->choices;; p++) {
        const size_t length = strcspn(p, "|");
        (void)json_array_append_new(choices, json_stringn(p, length));
        p += length;
        if (!*p)
            return choices;
    }
}

static json_t *param_tree(const pm__entry *entry, size_t i)
{
    static const char *const types[] = {"real", "integer", "choice"};
    const pm__param *const param = &entry->params[i];
    const bool choice = param->type == PM__CHOICE;
    char value[64];
    json_t *const tree = json_object();
    pm__spec spec;
    pm__spec_default(entry, &spec);
    format_default(entry, i, value, sizeof value);
    (void)json_object_set_new(tree, "name", json_string(param->name));
    (void)json_object_set_new(tree, "type", json_string(types[param->type]));
    (void)json_object_set_new(tree, "default", choice ? json_string(value) : json_real(spec.values[i]));
    (void)json_object_set_new(tree, "unit", json_string(param->unit));
    (void)json_object_set_new(tree, "min", choice ? json_null() : json_real(param->min));
    (void)json_object_set_new(tree, "max", choice ? json_null() : json_real(param->max));
    (void)json_object_set_new(tree, "choices", choices_of(param));
    (void)json_object_set_new(tree, "help", json_string(param->help));
    return tree;
}

static json_t *region_trees(const pm__case *subject)
{
    json_t *const trees = json_array();
    for (size_t i = 0; i < subject->region_count; i++)
        (void)json_array_append_new(trees, json_pack("{s:s, s:s}", "name", subject->regions[i].name, "summary",
                                                     subject->regions[i].summary));
    return trees;
}

static const char *const fields[] = {"kind", "name", "summary", "citation", "parameters", "paths", "regions",
                                     "reference"};
enum { FIELD_COUNT = 8, PLAIN_COUNT = 5 };

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    listing *const list = context;
    const thing *const item = &list->items[index];
    const pm__case *const subject = case_of(item);
    json_t *const params = json_array();
    pm__spec spec;
    for (size_t i = 0; i < item->entry->param_count; i++)
        (void)json_array_append_new(params, param_tree(item->entry, i));
    pm__spec_default(item->entry, &spec);
    pm__spec_format(&spec, list->text, sizeof list->text);
    const char *const values = list->text + strlen(item->entry->name);
    cells[0] = pm__text_cell(item->kind->catalogue->kind);
    cells[1] = pm__text_cell(item->entry->name);
    cells[2] = pm__text_cell(item->entry->summary);
    cells[3] = pm__text_cell(item->entry->citation);
    cells[4] = (pm__cell){.type = PM__TREE, .tree = params, .text = *values ? values + 1 : ""};
    if (subject && subject->truth) {
        cells[5] = pm__text_cell(subject->paths);
        cells[6] = (pm__cell){.type = PM__TREE, .tree = region_trees(subject)};
    }
    if (item->kind->catalogue == &pm__scene_cases && has_reference(item->entry, list->size))
        cells[7] = pm__text_cell(list->size);
}

/* All entries of the kinds that `only` names (NULL: of all); -1 if out of memory. */
static int gather(listing *list, const char *only)
{
    size_t total = 0;
    for (size_t i = 0; i < KIND_COUNT; i++)
        total += kinds[i].catalogue->count;
    list->items = calloc(total, sizeof *list->items);
    for (size_t i = 0; list->items && i < KIND_COUNT; i++)
        for (size_t j = 0; (!only || strcmp(only, kinds[i].name) == 0) && j < kinds[i].catalogue->count; j++)
            list->items[list->count++] = (thing){&kinds[i], kinds[i].catalogue->entries[j]};
    return list->items ? 0 : -1;
}

static int refuse(const char *name)
{
    const char *names[KIND_COUNT];
    for (size_t i = 0; i < KIND_COUNT; i++)
        names[i] = kinds[i].name;
    const char *const nearest = pm__nearest_name(name, names, KIND_COUNT);
    if (nearest)
        pm__complain("list", "no list '%.80s'; did you mean '%s'?", name, nearest);
    else
        pm__complain("list", "no list '%.80s'; there are: estimators, searches, cases, scenes, samplers, methods, "
                             "policies, metrics",
                     name);
    return PM__EXIT_USAGE;
}

static int write_listing(const pm__settings *settings, listing *list, const char *only)
{
    pm_error error = {""};
    pm__sinks sinks;
    const double start = pm__seconds();
    pm_status status = pm__sinks_open(settings, true, &sinks, &error);
    if (status == PM_OK) {
        json_t *const options = json_pack("{s:s?}", "what", only);
        const pm__results results = {
            .command = "list", .options = options, .settings = settings, .wall_s = pm__seconds() - start,
            .fields = fields, .field_count = FIELD_COUNT, .plain_count = PLAIN_COUNT,
            .row_count = list->count, .row = fill_row, .context = list};
        if (pm__sinks_screen(&sinks))
            print_listing(pm__sinks_screen(&sinks), list);
        status = pm__sinks_finish(&sinks, &results, &error);
        json_decref(options);
    }
    if (status != PM_OK)
        pm__complain("list", "%s", error.text);
    return pm__exit_status(status);
}

static int run(pm__settings *settings)
{
    const char *only = NULL;
    listing list = {.count = 0};
    for (size_t i = 0; i < KIND_COUNT && settings->operand_count; i++)
        if (strcmp(settings->operands[0], kinds[i].name) == 0)
            only = kinds[i].name;
    if (settings->operand_count && !only)
        return refuse(settings->operands[0]);
    if (gather(&list, only)) {
        pm__complain("list", "out of memory");
        return PM__EXIT_OTHER;
    }
    const int status = write_listing(settings, &list, only);
    free(list.items);
    return status;
}

static const pm__option *const options_taken[] = {&pm__option_json, &pm__option_csv, &pm__option_markdown,
                                                  &pm__option_output, &pm__option_quiet};

const pm__command pm__command_list = {
    .name = "list",
    .operands = "[KIND]",
    .max_operands = 1,
    .job = "what there is, with parameters, their defaults and ranges, and where it comes from",
    .text = "A KIND is estimators, searches, cases, scenes, samplers, methods, policies or metrics; without one,\n"
            "all are shown.\n\n"
            "Examples:\n"
            "  photonbench list\n"
            "  photonbench list estimators\n"
            "  photonbench list cases --json -\n",
    .options = options_taken,
    .option_count = sizeof options_taken / sizeof *options_taken,
    .run = run,
};
