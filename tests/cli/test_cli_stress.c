/* `photonbench stress` as a user runs it. */
#include "../../src/stress/stress.h"
#include "../program.h"
#include "../rows.h"

#define SMALL "--test single,scaling --estimator disc,hull --search wide,grid "

/* Messages name widths that the processor lacks: --quiet, so that the run has none. */
START_TEST(test_fields_are_the_contract)
{
    json_t *const root = pm__expect_json("stress " SMALL "--quiet --json -");
    json_t *const options = json_object_get(root, "options");
    const size_t widths = json_array_size(json_object_get(options, "simd"));
    ck_assert_str_eq(pm__text_of(root, "command"), "stress");
    ck_assert_str_eq(pm__text_of(options, "profile"), "quick");
    ck_assert_uint_eq(widths + json_array_size(json_object_get(options, "simd_skipped")), 4);
    ck_assert_uint_eq(json_array_size(pm__rows_of(root)), 2 * 3 * 2 * widths);
    for (size_t i = 0; i < json_array_size(pm__rows_of(root)); i++) {
        json_t *const row = json_array_get(pm__rows_of(root), i);
        pm__check_keys(row, "test subject status measured bound unit detail");
        ck_assert_str_eq(pm__text_of(row, "status"), "pass");
        ck_assert_double_le(json_number_value(json_object_get(row, "measured")),
                            json_number_value(json_object_get(row, "bound")));
    }
    ck_assert_str_eq(pm__text_of(pm__item(root, "rows", 2 * widths), "subject"), "disc:last=full wide plain");
    json_decref(root);
}
END_TEST

/* The hook for this test: bounds times -1. */
START_TEST(test_a_row_that_fails_is_exit_status_1)
{
    (void)setenv("PHOTONBENCH_STRESS_BOUND", "-1", 1);
    const pm__run *const run = pm__expect("stress " SMALL "-o /dev/null --json -", 1, "not every row passes");
    json_error_t error;
    json_t *const root = json_loads(run->out, 0, &error);
    ck_assert_ptr_nonnull(root);
    size_t failed = 0;
    for (size_t i = 0; i < json_array_size(pm__rows_of(root)); i++)
        failed += strcmp(pm__text_of(json_array_get(pm__rows_of(root), i), "status"), "fail") == 0;
    ck_assert_uint_gt(failed, 4);
    json_decref(root);
    ck_assert_ptr_nonnull(strstr(pm__expect("stress " SMALL, 1, "not every")->out, " FAIL "));
    ck_assert_ptr_nonnull(strstr(pm__last_run.out, "disc:last=full grid"));
    for (const char *line = pm__last_run.out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_msg(strcspn(line, "\n") <= 100, "%.120s", line);
    (void)unsetenv("PHOTONBENCH_STRESS_BOUND");
}
END_TEST

START_TEST(test_screen_is_100_columns)
{
    const pm__run *const run = pm__expect("stress --test single,ties,updates --search wide --quiet", 0, NULL);
    static const char *const parts[] = {"single", "ties", "updates", " pass ", "0 failed; SIMD plain"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(run->out, parts[i]) != NULL, "no '%s' in %s", parts[i], run->out);
    for (const char *line = run->out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_msg(strcspn(line, "\n") <= 100, "%.120s", line);
}
END_TEST

/* But adapts and sums: a million updates, 1e8 terms. A subject of each of these is in tests/unit/test_stress.c. */
START_TEST(test_every_row_passes)
{
    char line[1000] = "stress --search wide,grid,stackfree --quiet --json - --test ";
    size_t asked = 0;
    for (size_t t = 0; t < pm__stress_test_count(); t++) {
        const char *const name = pm__stress_test_name(t);
        if (strcmp(name, "adapts") != 0 && strcmp(name, "sums") != 0)
            (void)strcat(strcat(line, asked++ ? "," : ""), name);
    }
    json_t *const root = pm__expect_json(line);
    size_t i, tests = 0;
    const char *before = "";
    json_t *row;
    json_array_foreach(pm__rows_of(root), i, row) {
        ck_assert_msg(strcmp(pm__text_of(row, "status"), "pass") == 0, "%s, %s: %s", pm__text_of(row, "test"),
                      pm__text_of(row, "subject"), pm__text_of(row, "detail"));
        tests += strcmp(before, pm__text_of(row, "test")) != 0;
        before = pm__text_of(row, "test");
    }
    ck_assert_uint_eq(tests, asked);
    ck_assert_uint_eq(asked + 2, pm__stress_test_count());
    json_decref(root);
}
END_TEST

START_TEST(test_same_rows_whatever_the_threads)
{
    json_t *const one = pm__expect_json("stress " SMALL "--quiet --threads 1 --json -");
    json_t *const two = pm__expect_json("stress " SMALL "--quiet --threads 2 --json -");
    ck_assert(json_equal(pm__rows_of(one), pm__rows_of(two)));
    json_decref(one);
    json_decref(two);
}
END_TEST

START_TEST(test_widths_that_are_not_run_are_said)
{
    (void)setenv("PHOTONBENCH_SIMD", "plain", 1);
    json_t *const root = pm__expect_json("stress " SMALL "--quiet --json -");
    ck_assert_uint_eq(json_array_size(json_object_get(json_object_get(root, "options"), "simd_skipped")), 3);
    ck_assert_uint_eq(json_array_size(pm__rows_of(root)), 2 * 3 * 2);
    json_decref(root);
    (void)pm__expect("stress " SMALL "-o /dev/null", 0, "SKIP: SIMD width avx512");
    (void)setenv("PHOTONBENCH_SIMD", "mmx", 1);
    (void)pm__expect("stress", 2, "PHOTONBENCH_SIMD is 'mmx'");
    (void)unsetenv("PHOTONBENCH_SIMD");
}
END_TEST

START_TEST(test_refusals)
{
    (void)pm__expect("stress --test tie", 2, "did you mean 'ties'");
    (void)pm__expect("stress --test heat", 2, "there are: duplicates, ties");
    (void)pm__expect("stress --test ties,", 2, "no test ''");
    (void)pm__expect("stress --search wode", 2, "did you mean 'wide'");
    (void)pm__expect("stress --search grid,flann", 2, "no search 'flann'; there are: wide");
    (void)pm__expect("stress --estimator dsic", 2, "did you mean 'disc'");
    (void)pm__expect("stress --profile slow", 2, "quick");
    (void)pm__expect("stress --seed -1", 2, "integer");
    (void)pm__expect("stress ties", 2, "unexpected argument");
    (void)pm__expect("stress " SMALL "--quiet --json /dev/full -o /dev/null", 4, "full");
}
END_TEST

PM_TEST_MAIN("cli stress", test_fields_are_the_contract, test_a_row_that_fails_is_exit_status_1,
             test_screen_is_100_columns, test_every_row_passes, test_same_rows_whatever_the_threads,
             test_widths_that_are_not_run_are_said, test_refusals)
