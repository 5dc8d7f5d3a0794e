/* Random specs and command lines: a status and a sentence, never a crash; what is taken reads back as itself.
 * Deterministic: the same strings at each run. */
#include "../../cases/case.h"
#include "../../estimators/estimator.h"
#include "../../src/base/sampler.h"
#include "../../src/cli/commands.h"

#include "dice.h"

#include <string.h>

enum { SPECS = 60000, LINES = 20000, LENGTH = 120, WORDS = 12, TEST = 8 }; /* TEST: of the dice */

static const char *const pieces[] = {
    "disc", "cone", "gaussian", "hull",  "combined", "differential", "all",    "square", "sinusoid", "point-light",
    "k",    "last", "half",     "maps",  "deal",     "random",       "cycles", "form",   "boundary", "stratified",
    ":",    "=",    ",",        ":",     "=",        ",",            "0",      "1",      "2.5",      "-1",
    "1e9",  "nan",  "inf",      "1e999", "0x10",     " ",            "\t",     "%s%n",   "\xff\xfe", "",
    "99999999999999999999999999999999999999999999999999999999999999999999999999999999"};

/* A few pieces in a row; sometimes a byte of it is changed. */
static void random_text(dice *d, char text[LENGTH])
{
    size_t used = 0;
    text[0] = '\0';
    for (size_t count = 1 + roll(d, 9); count > 0; count--) {
        const char *const piece = pieces[roll(d, sizeof pieces / sizeof *pieces)];
        if (used + strlen(piece) >= LENGTH)
            break;
        (void)strcpy(text + used, piece);
        used += strlen(piece);
    }
    if (used && roll(d, 4) == 0)
        text[roll(d, used)] = (char)(1 + roll(d, 255));
}

/* An entry with a parameter or two of its own; the values need not be allowed. */
static void random_spec(dice *d, const pm__catalogue *catalogue, char text[LENGTH])
{
    static const char *const values[] = {"0.5", "1", "2", "3", "7.25", "0.0001", "half", "none", "random", "zero"};
    const pm__entry *const entry = catalogue->entries[roll(d, catalogue->count)];
    size_t used = (size_t)snprintf(text, LENGTH, "%s", entry->name);
    for (size_t count = entry->param_count ? roll(d, 3) : 0, i = 0; i < count; i++)
        used += (size_t)snprintf(text + used, LENGTH - used, "%s%s=%s", i ? "," : ":",
                                 entry->params[roll(d, entry->param_count)].name,
                                 values[roll(d, sizeof values / sizeof *values)]);
}

static bool same(const pm__spec *a, const pm__spec *b)
{
    for (size_t i = 0; i < PM__MAX_PARAMS; i++)
        if (a->values[i] != b->values[i])
            return false;
    return a->entry == b->entry;
}

/* Both forms give the spec again. */
static void check_forms(const pm__catalogue *catalogue, const pm__spec *spec)
{
    char text[PM__MAX_SPEC];
    pm__spec again;
    pm_error error = {""};
    pm__spec_format(spec, text, sizeof text);
    PM_CHECK_OK(pm__spec_parse(catalogue, text, &again, &error), error);
    ck_assert_msg(same(spec, &again), "%s", text);
    pm__spec_format_short(spec, text, sizeof text);
    PM_CHECK_OK(pm__spec_parse(catalogue, text, &again, &error), error);
    ck_assert_msg(same(spec, &again), "%s", text);
}

START_TEST(specs)
{
    const pm__catalogue *const catalogues[] = {&pm__estimators, &pm__all_cases, &pm__samplers};
    size_t taken = 0;
    for (uint64_t i = 0; i < SPECS; i++) {
        dice d = {i, TEST, 0};
        char text[LENGTH];
        const pm__catalogue *const catalogue = catalogues[i % 3];
        if (i % 2)
            random_text(&d, text);
        else
            random_spec(&d, catalogue, text);
        pm__spec *list = NULL;
        size_t count = 0;
        pm_error error = {""};
        const pm_status status = pm__spec_parse_list(catalogue, text, &list, &count, &error);
        ck_assert(status == PM_OK || status == PM_EINVAL || status == PM_ENAME);
        ck_assert_msg((status == PM_OK) == !*error.text, "%s", error.text);
        ck_assert_uint_lt(strnlen(error.text, sizeof error.text), sizeof error.text);
        for (size_t j = 0; j < count; j++)
            check_forms(catalogue, &list[j]);
        taken += status == PM_OK;
        free(list);
    }
    ck_assert_uint_gt(taken, SPECS / 10); /* else nothing but refusals was tested */
}
END_TEST

/* An option of the command (sometimes cut short or damaged) or anything. */
static void random_word(dice *d, const pm__command *command, char text[LENGTH])
{
    char value[LENGTH];
    random_text(d, value);
    if (!command->option_count || roll(d, 3) == 0) {
        (void)strcpy(text, value);
        return;
    }
    const pm__option *const option = command->options[roll(d, command->option_count)];
    (void)snprintf(text, LENGTH, "--%s%s%.60s", option->name, roll(d, 2) ? "=" : "", roll(d, 2) ? value : "3");
    if (roll(d, 3) == 0)
        text[2 + roll(d, strlen(option->name))] = roll(d, 2) ? '\0' : 'x';
}

START_TEST(command_lines)
{
    const pm__command *const commands[] = {&pm__command_accuracy, &pm__command_estimate, &pm__command_list,
                                           &pm__command_help};
    size_t taken = 0;
    for (uint64_t i = 0; i < LINES; i++) {
        dice d = {i, TEST, 1000};
        const pm__command *const command = commands[i % 4];
        char words[WORDS][LENGTH], *argv[WORDS + 1];
        const size_t count = 1 + roll(&d, 4);
        for (size_t w = 0; w < count; w++) {
            random_word(&d, command, words[w]);
            argv[w] = words[w];
        }
        argv[count] = NULL;
        pm__settings settings;
        pm_error error = {""};
        pm__settings_init(&settings);
        const pm_status status = pm__options_parse(command, (int)count, argv, &settings, &error);
        ck_assert(status == PM_OK || status == PM_EINVAL || status == PM_ENAME);
        ck_assert_msg((status == PM_OK) == !*error.text, "%s", error.text);
        taken += status == PM_OK && count > 1;
        pm__settings_free(&settings);
    }
    ck_assert_uint_gt(taken, LINES / 100);
}
END_TEST

PM_TEST_MAIN("fuzz options", specs, command_lines)
