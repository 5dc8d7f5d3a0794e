/* The pages keep up with the code: what they name exists, and what exists they name. Reads files relative to the
 * repository's root, where tests run. */
#include "../program.h"

#include "../../cases/case.h"
#include "../../estimators/estimator.h"
#include "../../src/base/sampler.h"
#include "../../src/methods/render.h"
#include "../../src/metrics/metrics.h"
#include "../../src/search/search.h"
#include "../../src/transport/storing.h"

extern const pm__catalogue pm__progressives; /* its header has another pm__run than program.h */

enum { PAGE_SIZE = 1 << 18, LONGEST_LINE = 110 };

static const char *const page_paths[] = {"README.md",        "docs/accuracy.md", "docs/search.md",  "docs/compare.md",
                                         "docs/estimate.md", "docs/list.md",     "docs/library.md", "docs/errata.md",
                                         "docs/scenes.md",   "docs/render.md",   "docs/speed.md",
                                         "docs/converge.md", "docs/advise.md",   "docs/storage.md",
                                         "docs/stress.md",   "docs/promises.md", "docs/robust.md",  "docs/report.md"};
enum { PAGES = sizeof page_paths / sizeof *page_paths };

static char pages[PAGES][PAGE_SIZE];

static const char *page(const char *path)
{
    for (int i = 0; i < PAGES; i++)
        if (strcmp(path, page_paths[i]) == 0) {
            if (!*pages[i])
                (void)pm__test_read(path, pages[i], PAGE_SIZE);
            ck_assert_msg(*pages[i] != '\0', "%s cannot be read", path);
            return pages[i];
        }
    ck_abort_msg("no page %s", path);
}

/* Output of a shell command, which must succeed. */
static const char *output_of(const char *command)
{
    static char text[PAGE_SIZE];
    FILE *const pipe = popen(command, "r");
    ck_assert_ptr_nonnull(pipe);
    text[fread(text, 1, sizeof text - 1, pipe)] = '\0';
    ck_assert_msg(pclose(pipe) == 0, "%s failed", command);
    return text;
}

/* Whether some page has `name` in code: after a backtick or as a word of an example. */
static bool is_mentioned(const char *name)
{
    char code[80];
    (void)snprintf(code, sizeof code, "`%s", name);
    const size_t length = strlen(code);
    for (int i = 0; i < PAGES; i++)
        for (const char *at = strstr(page(page_paths[i]), code); at; at = strstr(at + 1, code))
            if (at[length] == '`' || at[length] == ':' || at[length] == ' ')
                return true;
    return false;
}

START_TEST(everything_listed_is_mentioned)
{
    const pm__catalogue *const all[] = {&pm__estimators, &pm__all_cases, &pm__searches, &pm__samplers,
                                        &pm__methods,    &pm__progressives, &pm__policies, &pm__metrics};
    for (int c = 0; c < 8; c++)
        for (size_t i = 0; i < all[c]->count; i++)
            ck_assert_msg(is_mentioned(all[c]->entries[i]->name), "no page mentions the %s %s", all[c]->kind,
                          all[c]->entries[i]->name);
}
END_TEST

/* Each option that help shows has its row in the command's page. */
START_TEST(options_are_documented)
{
    static const char *const commands[] = {"accuracy", "search",   "speed", "render",
                                           "converge", "advise", "compare", "estimate", "list", "storage",
                                           "stress",   "report"};
    for (size_t c = 0; c < sizeof commands / sizeof *commands; c++) {
        char arguments[40], path[40], option[40], wanted[48];
        (void)snprintf(arguments, sizeof arguments, "help %s", commands[c]);
        (void)snprintf(path, sizeof path, "docs/%s.md", commands[c]);
        int options = 0;
        for (const char *at = pm__expect(arguments, 0, NULL)->out; (at = strstr(at, "\n  ")) != NULL; at += 3) {
            const char *const dashes = at[3] == '-' && at[4] != '-' ? at + 7 : at + 3; /* -o, --output */
            if (sscanf(dashes, "--%30[a-z]", option) != 1)
                continue;
            options++;
            (void)snprintf(wanted, sizeof wanted, "`--%s", option);
            ck_assert_msg(strstr(page(path), wanted) != NULL, "%s lacks --%s", path, option);
        }
        ck_assert_int_ge(options, strcmp(commands[c], "report") == 0 ? 4 : 6);
    }
}
END_TEST

/* Each field of the lists of rows, in backticks. */
static void check_fields(const char *arguments, const char *path)
{
    static const char *const lists[] = {"rows", "fits", "points", "fronts"};
    json_t *const root = pm__expect_json(arguments), *value;
    const char *key;
    char wanted[60];
    for (int i = 0; i < 4; i++)
        json_object_foreach(json_array_get(json_object_get(root, lists[i]), 0), key, value) {
            (void)snprintf(wanted, sizeof wanted, "`%s`", key);
            ck_assert_msg(strstr(page(path), wanted) != NULL, "%s lacks the field %s", path, key);
        }
    json_decref(root);
}

START_TEST(fields_are_documented)
{
    check_fields("accuracy --case square --estimator disc --k 5 --photons 100 --trials 2 --probes 4 --json -",
                 "docs/accuracy.md");
    check_fields("compare cases/scenes/references/egg.exr cases/scenes/references/egg.exr --metric mse --json -",
                 "docs/compare.md");
    check_fields("search --search recursive --photons 100 --k 5 --samples 2 --json -", "docs/search.md");
    check_fields("speed water --quantity trace --photons 200 --k 10 --seconds 0.01 --json -", "docs/speed.md");
    check_fields("render water --size 4x4 --spp 1 --photons 1000 --k 10 --quiet --json - -o /dev/null",
                 "docs/render.md");
    check_fields("render water --plan --json -", "docs/render.md");
    check_fields("converge water --size 4x4 --trials 2 --passes 2 --photons-per-pass 200 --k 5 --at 1,1 --json -",
                 "docs/converge.md");
    check_fields("advise gradient --error 20% --estimator disc:last=none --probes 20 --json -", "docs/advise.md");
    check_fields("storage torus --spp 4 --photons 500 --trials 2 --paths 1000 --policy all --json -",
                 "docs/storage.md");
    check_fields("stress --test single --estimator disc --quiet --json -", "docs/stress.md");
    check_fields("list cases --json -", "docs/list.md");
}
END_TEST

/* Next `word` in backticks from `at` on and before `end`; where to go on, or NULL. */
static const char *next_code(const char *at, const char *end, char word[100])
{
    const char *const open = strchr(at, '`');
    if (!open || open >= end)
        return NULL;
    const size_t length = strcspn(open + 1, "`");
    ck_assert_uint_lt(length, 100);
    memcpy(word, open + 1, length);
    word[length] = '\0';
    return open + length + 2;
}

/* "Proof: `tests/x.c`: `one`, `two`; `tests/y.c`: `three`." names tests that are there. Returns how many. */
static int check_proof(const char *proof)
{
    static char source[PAGE_SIZE];
    char word[100], wanted[130];
    const char *const blank = strstr(proof, "\n\n"), *const end = blank ? blank : proof + strlen(proof);
    int count = 0;
    *source = '\0';
    while ((proof = next_code(proof, end, word)) != NULL) {
        if (strncmp(word, "tests/", 6) == 0) {
            (void)pm__test_read(word, source, sizeof source);
            ck_assert_msg(*source != '\0', "docs/errata.md: %s is not there", word);
            continue;
        }
        (void)snprintf(wanted, sizeof wanted, "START_TEST(%s)", word);
        ck_assert_msg(strstr(source, wanted) != NULL, "docs/errata.md names a test %s that is not there", word);
        count++;
    }
    return count;
}

/* Every section but the first, which explains, and the one that holds the theorems ends in a proof. */
START_TEST(errata_have_their_tests)
{
    int sections = 0;
    for (const char *at = strstr(page("docs/errata.md"), "\n## "); at; at = strstr(at + 1, "\n## ")) {
        const char *const next = strstr(at + 1, "\n## "), *const proof = strstr(at, "\nProof: ");
        ck_assert_msg(proof && (!next || proof < next), "docs/errata.md: no proof under%.40s", at + 3);
        for (const char *p = proof; p && (!next || p < next); p = strstr(p + 1, "\nProof: "))
            ck_assert_int_gt(check_proof(p), 0);
        sections++;
    }
    ck_assert_int_ge(sections, 25);
}
END_TEST

/* The words after `name`, a line that begins so, with a blank between any two, up to the next such line. */
static void read_entry(const char *section, const char *end, const char *name, char *words, size_t size)
{
    static const char *const names[] = {"\nPlace: ", "\nPrinted: ", "\nRight: ", "\nSize: ", "\nProof: "};
    const char *at = strstr(section, name), *stop = end;
    size_t used = 0;
    *words = '\0';
    if (!at || at >= end)
        return;
    at += strlen(name);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        const char *const next = strstr(at, names[i]);
        stop = next && next < stop ? next : stop;
    }
    for (; at < stop && used + 1 < size; at++)
        if (*at != '\n')
            words[used++] = *at;
        else if (at + 1 < stop && at[1] != '\n')
            words[used++] = ' ';
    words[used] = '\0';
}

/* "" where it is no text. */
static const char *text_of(const json_t *row, const char *field)
{
    const char *const text = json_string_value(json_object_get(row, field));
    return text ? text : "";
}

/* A row of the report's list says what the page says: all of it, and of the size a part. */
static void check_row(const json_t *row, const char *section, const char *end)
{
    static const char *const fields[][2] = {
        {"source", "\nPlace: "}, {"printed", "\nPrinted: "}, {"right", "\nRight: "}, {"measured", "\nSize: "}};
    char words[2000], title[100];
    for (size_t i = 0; i < 4; i++) {
        read_entry(section, end, fields[i][1], words, sizeof words);
        ck_assert_str_eq(text_of(row, fields[i][0]), words);
    }
    ck_assert_msg(*text_of(row, "size") && strstr(words, text_of(row, "size")), "%s: no '%s'", words,
                  text_of(row, "size"));
    read_entry(section, end, "\nProof: ", words, sizeof words);
    ck_assert_msg(*text_of(row, "test") && strstr(words, text_of(row, "test")), "%s: no '%s'", words,
                  text_of(row, "test"));
    (void)snprintf(title, sizeof title, ". %s\n", text_of(row, "title"));
    ck_assert_msg(strstr(section, title) && strstr(section, title) < strstr(section, "\nPlace: "), "no '%s'", title);
}

/* reports/errata.json has a row for each numbered section, in order, but for misprints that change nothing. */
START_TEST(list_of_errata_agrees)
{
    json_t *const list = json_load_file("reports/errata.json", JSON_REJECT_DUPLICATES, NULL);
    size_t index = 0;
    for (const char *at = strstr(page("docs/errata.md"), "\n## "); at; at = strstr(at + 1, "\n## ")) {
        const char *const next = strstr(at + 1, "\n## "), *const end = next ? next : at + strlen(at);
        char size[2000];
        read_entry(at, end, "\nSize: ", size, sizeof size);
        if (!*size || strncmp(size, "none", 4) == 0)
            continue;
        const json_t *const row = json_array_get(list, index++);
        ck_assert_int_eq((int)json_integer_value(json_object_get(row, "number")), (int)strtol(at + 4, NULL, 10));
        check_row(row, at, end);
    }
    ck_assert_uint_eq(json_array_size(list), index);
    ck_assert_uint_ge(index, 40);
    json_decref(list);
}
END_TEST

/* "errata 14" in a comment leads somewhere. */
START_TEST(cited_errata_are_there)
{
    const char *at = output_of("grep -rhoE 'errat(a|um) [0-9]+((, | to | and )[0-9]+)*' src estimators cases tests");
    int count = 0;
    while (*(at += strcspn(at, "0123456789"))) {
        char heading[40];
        (void)snprintf(heading, sizeof heading, "\n## %d. ", (int)strtol(at, NULL, 10));
        ck_assert_msg(strstr(page("docs/errata.md"), heading) != NULL, "docs/errata.md lacks errata %.3s", at);
        at += strspn(at, "0123456789");
        count++;
    }
    ck_assert_int_ge(count, 20);
}
END_TEST

/* The C examples of a page compile without a warning. */
static int compile_examples(const char *path, const char *flags)
{
    char command[300];
    const char *const compiler = getenv("CC");
    int count = 0;
    (void)snprintf(command, sizeof command,
                   "c='%s'; command -v $c >/dev/null || c=clang; $c -std=c11 -D_GNU_SOURCE -Wall -Wextra -Wpedantic "
                   "-Wno-unknown-pragmas -Werror -fsyntax-only %s -x c -",
                   compiler && *compiler ? compiler : "cc", flags);
    for (const char *at = strstr(page(path), "```c\n"); at; at = strstr(at, "```c\n")) {
        const char *const code = at + 5, *const end = strstr(code, "\n```");
        ck_assert_ptr_nonnull(end);
        FILE *const pipe = popen(command, "w");
        ck_assert_ptr_nonnull(pipe);
        (void)fwrite(code, 1, (size_t)(end - code) + 1, pipe);
        ck_assert_msg(pclose(pipe) == 0, "%s: an example does not compile", path);
        at = end;
        count++;
    }
    return count;
}

START_TEST(examples_compile)
{
    ck_assert_int_eq(compile_examples("README.md", "-I estimators"), 1);
    ck_assert_int_eq(compile_examples("docs/library.md", "-I src"), 2);
}
END_TEST

/* Links to files of the repository lead somewhere; lines are of a readable length. */
START_TEST(links_and_lines)
{
    for (int i = 0; i < PAGES; i++) {
        for (const char *at = page(page_paths[i]); (at = strstr(at, "](")) != NULL; at += 2) {
            char target[200], path[240];
            (void)snprintf(target, sizeof target, "%.*s", (int)strcspn(at + 2, ")#"), at + 2);
            (void)snprintf(path, sizeof path, "%s%s", i ? "docs/" : "", target);
            ck_assert_msg(!*target || access(path, R_OK) == 0, "%s: no %s", page_paths[i], path);
        }
        for (const char *line = page(page_paths[i]); *line; line += strcspn(line, "\n") + 1)
            ck_assert_msg(strcspn(line, "\n") <= LONGEST_LINE, "%s: %.60s...", page_paths[i], line);
    }
}
END_TEST

PM_TEST_MAIN("docs", everything_listed_is_mentioned, options_are_documented, fields_are_documented,
             errata_have_their_tests, list_of_errata_agrees, cited_errata_are_there, examples_compile, links_and_lines)
