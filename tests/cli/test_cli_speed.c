/* `photonbench speed` as a user runs it: tiny sizes; times are not looked at. */
#include "../program.h"
#include "../rows.h"

#define TINY "--photons 300 --k 8 --size 8x8 --seconds 0.01 "

START_TEST(test_fields_are_the_contract)
{
    json_t *const root = pm__expect_json("speed cornell " TINY "--threads 2 --json -");
    static const char *const quantities[] = {"trace", "trace-threads", "visualize", "skip",
                                             "skip",  "pass",          "pass-threads", "pass-rays"};
    static const char *const methods[] = {"", "", "visualize", "visualize", "full", "ppm", "ppm", "ppm"};
    static const double promises[] = {0.6, 1.8, 2.0 / 3.0, 0.0, 0.0, 1.0 / 1.3, 1.8, 1.0}; /* 0: none */
    ck_assert_str_eq(pm__text_of(root, "command"), "speed");
    ck_assert_uint_eq(json_array_size(pm__rows_of(root)), 8);
    for (size_t i = 0; i < 8; i++) {
        json_t *const row = json_array_get(pm__rows_of(root), i);
        pm__check_keys(row, "scene quantity method photons threads seconds baseline baseline_seconds ratio ratio_ci95 "
                            "promise samples status detail agree aa_ratio aa_ratio_ci95 warning");
        ck_assert_str_eq(pm__text_of(row, "quantity"), quantities[i]);
        ck_assert_str_eq(pm__text_of(row, "scene"), "scene:cornell:albedo=0.75,ior=1.5,moved=0");
        ck_assert_double_gt(json_number_value(json_object_get(row, "ratio")), 0.0);
        if (promises[i] > 0.0)
            PM_CHECK_NEAR(json_number_value(json_object_get(row, "promise")), promises[i], 1e-12);
        json_t *const agree = json_object_get(row, "agree");
        ck_assert(promises[i] > 0.0 ? json_is_null(agree) : json_is_true(agree));
        ck_assert_str_eq(pm__text_of(row, "method"), methods[i]);
    }
    json_decref(root);
}
END_TEST

START_TEST(test_scenes_and_quantities_are_chosen)
{
    json_t *root = pm__expect_json("speed corner furnace " TINY "--quantity skip --json -");
    ck_assert_uint_eq(json_array_size(pm__rows_of(root)), 4);
    json_decref(root);
    root = pm__expect_json("speed " TINY "--quantity trace,visualize --json -");
    ck_assert_uint_eq(json_array_size(pm__rows_of(root)), 5); /* four scenes and one */
    json_decref(root);
}
END_TEST

/* But for times: rows, images that agree, and the p-value in detail. */
START_TEST(test_same_rows_whatever_the_threads)
{
    static const char *const fields[] = {"scene", "quantity", "method", "photons", "baseline", "promise", "detail",
                                         "agree"};
    json_t *const one = pm__expect_json("speed corner " TINY "--quantity skip --threads 1 --json -");
    json_t *const two = pm__expect_json("speed corner " TINY "--quantity skip --threads 2 --json -");
    for (size_t i = 0; i < 2; i++)
        for (size_t f = 0; f < sizeof fields / sizeof *fields; f++)
            ck_assert_msg(json_equal(json_object_get(json_array_get(pm__rows_of(one), i), fields[f]),
                                     json_object_get(json_array_get(pm__rows_of(two), i), fields[f])),
                          "row %zu: %s", i, fields[f]);
    json_decref(one);
    json_decref(two);
}
END_TEST

START_TEST(test_screen_is_100_columns)
{
    const pm__run *const run = pm__expect("speed corner " TINY "--threads 2 --quiet", 0, NULL);
    static const char *const parts[] = {"trace:", "trace-threads:", "visualize:", "skip:", "rays a photon", "p = ",
                                        "pass:", "pass-threads:", "pass-rays:", "times its parts", "rays traced"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(run->out, parts[i]) != NULL, "no '%s' in %.3000s", parts[i], run->out);
    size_t column = 0;
    for (const char *c = run->out; *c; c++) {
        column = *c == '\n' ? 0 : column + (((unsigned char)*c & 0xc0) != 0x80);
        ck_assert_msg(column <= 100, "%.120s", c - 100);
    }
}
END_TEST

START_TEST(test_refusals)
{
    (void)pm__expect("speed --quantity skipp", 2, "did you mean 'skip'");
    (void)pm__expect("speed --quantity heat", 2, "there are: trace, trace-threads");
    (void)pm__expect("speed --quantity trace,", 2, "no quantity ''");
    (void)pm__expect("speed cornelll", 2, "did you mean 'cornell'");
    (void)pm__expect("speed --size 8", 2, "WIDTHxHEIGHT");
    (void)pm__expect("speed --k 0", 2, "integer");
    (void)pm__expect("speed --photons 50 --k 100", 2, "--k 100 is more than --photons 50");
    (void)pm__expect("speed --seconds 0", 2, "seconds");
    (void)pm__expect("speed cornell --quantity trace-threads --threads 1", 0,
                     "no rows: trace-threads and pass-threads need");
    (void)pm__expect("speed cornell " TINY "--quantity trace --quiet --json /dev/full -o /dev/null", 4, "full");
}
END_TEST

PM_TEST_MAIN("cli speed", test_fields_are_the_contract, test_scenes_and_quantities_are_chosen,
             test_same_rows_whatever_the_threads, test_screen_is_100_columns, test_refusals)
