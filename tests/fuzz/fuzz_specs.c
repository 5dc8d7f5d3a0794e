/* Any bytes as the words of a command line, and as a list of estimators: a status and a sentence; what is taken reads
 * back as itself. */
#include "../../estimators/estimator.h"
#include "../../src/cli/commands.h"
#include "fuzz.h"

enum { TEXT = 400, WORDS = 12 };

static void read_list(const char *text)
{
    pm__spec *specs = NULL, again;
    size_t count = 0;
    pm_error error = {""};
    const pm_status status = pm__spec_parse_list(&pm__estimators, text, &specs, &count, &error);
    FUZZ_CHECK(status == PM_OK || *error.text, "no sentence");
    for (size_t i = 0; i < count; i++) {
        char canonical[PM__MAX_SPEC];
        pm__spec_format(&specs[i], canonical, sizeof canonical);
        FUZZ_CHECK(pm__spec_parse(&pm__estimators, canonical, &again, &error) == PM_OK, canonical);
        FUZZ_CHECK(again.entry == specs[i].entry && memcmp(again.values, specs[i].values, sizeof again.values) == 0,
                   canonical);
    }
    free(specs);
}

/* The first byte chooses the command; words are parted by newlines. */
static void read_line(uint8_t choice, char *text)
{
    static const char *const names[] = {"accuracy", "search", "render", "converge", "stress", "estimate", "list"};
    const char *nearest;
    const pm__command *const command = pm__command_find(names[choice % 7], &nearest);
    char *words[WORDS + 2] = {NULL};
    int count = 0;
    pm__settings settings;
    pm_error error = {""};
    words[count++] = (char *)(uintptr_t)names[choice % 7];
    for (char *word = strtok(text, "\n"); word && count <= WORDS; word = strtok(NULL, "\n"))
        words[count++] = word;
    pm__settings_init(&settings);
    const pm_status status = pm__options_parse(command, count, words, &settings, &error);
    FUZZ_CHECK(status == PM_OK || *error.text, "no sentence");
    pm__settings_free(&settings);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[TEXT + 1];
    if (!size)
        return 0;
    const size_t length = size - 1 < TEXT ? size - 1 : TEXT;
    memcpy(text, data + 1, length);
    text[length] = '\0';
    read_list(text);
    read_line(data[0], text);
    return 0;
}
