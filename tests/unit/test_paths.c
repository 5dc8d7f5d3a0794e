/* Light-path expressions, with the C library's regular expressions as the oracle. */
#include "../../src/transport/paths.h"
#include "../test.h"

#include <regex.h>
#include <stdio.h>
#include <string.h>

static const char *const expressions[] = {
    "LD", "LS+D", "L.*D", "L(S|D)*D", "L(S|D)+SD", "LSSD", "LS{2}D", "LS{1,3}D", "LS{0,2}D", "L[SD]{2,}D", "LD(SD)*",
    "L(SD?)+D", "LD?S*D", "L(D|SS)*D", "L(S(D|S)){2}D", "L.{3}D", "L[^D]*D", "LS*(D|DD|DSD)", "L((S+|D)D)*", ".+D",
    "L(D{2}|S{3,4})+D", "L.*S|LD", "L.*DS*D", "(L|LS)D", "L(S*)*D", "L(SD|S){0,3}D", "LS?S?S?D"};

enum { EXPRESSIONS = sizeof expressions / sizeof *expressions, LENGTH = 9 };

static pm__paths *create(const char *expression)
{
    pm_error error;
    pm__paths *paths;
    PM_CHECK_OK(pm__paths_create(expression, &paths, &error), error);
    return paths;
}

/* The path of `length` surfaces whose letters are the bits. */
static void spell(unsigned bits, int length, char path[LENGTH + 2])
{
    path[0] = 'L';
    for (int i = 0; i < length; i++)
        path[i + 1] = bits >> i & 1 ? 'D' : 'S';
    path[length + 1] = '\0';
}

START_TEST(test_match_as_posix)
{
    for (int e = 0; e < EXPRESSIONS; e++) {
        pm__paths *const paths = create(expressions[e]);
        char whole[200], path[LENGTH + 2];
        regex_t regex;
        snprintf(whole, sizeof whole, "^(%s)$", expressions[e]);
        ck_assert_int_eq(regcomp(&regex, whole, REG_EXTENDED | REG_NOSUB), 0);
        for (int length = 0; length <= LENGTH; length++)
            for (unsigned bits = 0; bits < 1U << length; bits++) {
                spell(bits, length, path);
                const bool want = !regexec(&regex, path, 0, NULL, 0);
                ck_assert_msg(pm__paths_match(paths, path) == want, "%s on %s: not %d", expressions[e], path, want);
            }
        regfree(&regex);
        pm__paths_destroy(paths);
    }
}
END_TEST

/* Can anything that goes on from here be stored? By trying all up to LENGTH: enough, since no expression here has more
 * than four letters in a row that must still come. */
static bool goes_on(const pm__paths *paths, unsigned bits, int length)
{
    char path[LENGTH + 2];
    for (int more = length + 1; more <= LENGTH; more++)
        for (unsigned tail = 0; tail < 1U << (more - length); tail++) {
            spell(bits | tail << length, more, path);
            if (path[more] == 'D' && pm__paths_match(paths, path))
                return true;
        }
    return false;
}

START_TEST(test_end_is_exact)
{
    for (int e = 0; e < EXPRESSIONS; e++) {
        pm__paths *const paths = create(expressions[e]);
        char path[LENGTH + 2];
        ck_assert(!pm__paths_end(paths, ""));
        for (int length = 0; length <= LENGTH - 5; length++)
            for (unsigned bits = 0; bits < 1U << length; bits++) {
                spell(bits, length, path);
                const bool want = !goes_on(paths, bits, length);
                ck_assert_msg(pm__paths_end(paths, path) == want, "%s on %s: not %d", expressions[e], path, want);
            }
        pm__paths_destroy(paths);
    }
}
END_TEST

/* Does anything before these surfaces, behind L, make a path? By trying all up to LENGTH, as above. */
static bool comes_from(const pm__paths *paths, unsigned bits, int length)
{
    char path[LENGTH + 2];
    for (int more = 1; more <= LENGTH - length; more++)
        for (unsigned head = 0; head < 1U << more; head++) {
            spell(head | bits << more, more + length, path);
            if (pm__paths_match(paths, path))
                return true;
        }
    return false;
}

START_TEST(test_backwards_as_forwards)
{
    for (int e = 0; e < EXPRESSIONS; e++) {
        pm__paths *const paths = create(expressions[e]);
        char path[LENGTH + 2];
        for (int length = 1; length <= LENGTH; length++)
            for (unsigned bits = 1U << (length - 1); bits < 1U << length; bits++) { /* a D at the end */
                pm__places places = pm__paths_from_end(paths);
                spell(bits, length, path);
                for (int i = length - 1; i > 0; i--)
                    places = pm__paths_step_back(paths, places, path[i]);
                const bool whole = pm__paths_match(paths, path);
                ck_assert_msg(pm__paths_whole(paths, places) == whole, "%s on %s: not %d", expressions[e], path, whole);
                const bool grow = length <= LENGTH - 5 && comes_from(paths, bits, length);
                ck_assert_msg(length > LENGTH - 5 || pm__paths_grow(paths, places) == grow,
                              "%s: before %s: not %d", expressions[e], path, grow);
            }
        ck_assert_uint_eq(pm__paths_step_back(paths, pm__paths_from_end(paths), 'X'), 0);
        pm__paths_destroy(paths);
    }
}
END_TEST

START_TEST(test_foreign_letters_match_nothing)
{
    pm__paths *const paths = create("L.*D");
    ck_assert(!pm__paths_match(paths, "LXD"));
    ck_assert(pm__paths_end(paths, "LX"));
    ck_assert(!pm__paths_match(paths, ""));
    pm__paths_destroy(paths);
    pm__paths_destroy(NULL);
}
END_TEST

START_TEST(test_refusals)
{
    static const char *const bad[][2] = {
        {"", "character 1 "}, {"LSE", "character 3 "}, {"L(SD", "character 2 "}, {"LS)D", "character 3 "},
        {"L()D", "character 3 "}, {"L|", "character 3 "}, {"*D", "character 1 "}, {"LS**D", "character 4 "},
        {"LS{2D", "character 3 "}, {"LS{0}D", "character 3 "}, {"LS{3,2}D", "character 3 "}, {"LS{", "character 3 "},
        {"L[SD", "character 2 "}, {"L[]D", "character 2 "}, {"L[^LSD]D", "character 2 "}, {"L[S-D]D", "character 4 "},
        {"^LD$", "character 1 "}, {"LS{64}D", "63 letters"}, {"((L.{9}){9}){9}D", "63 letters"}, {"SD", "no photon"},
        {"LS", "no photon"}, {"L.*S", "no photon"}, {"LLD", "no photon"}, {"l.*d", "character 1 "}};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        pm_error error;
        pm__paths *paths;
        ck_assert_msg(pm__paths_create(bad[i][0], &paths, &error) == PM_EINVAL, "'%s' is taken", bad[i][0]);
        ck_assert_ptr_null(paths);
        ck_assert_msg(strstr(error.text, bad[i][1]) != NULL, "'%s': %s", bad[i][0], error.text);
    }
    char deep[200];
    memset(deep, '(', sizeof deep - 1);
    deep[sizeof deep - 1] = '\0';
    pm__paths *paths;
    ck_assert_int_eq(pm__paths_create(deep, &paths, NULL), PM_EINVAL);
    ck_assert_int_eq(pm__paths_create(NULL, &paths, NULL), PM_EINVAL);
}
END_TEST

PM_TEST_MAIN("paths", test_match_as_posix, test_end_is_exact, test_backwards_as_forwards,
             test_foreign_letters_match_nothing, test_refusals)
