/* `photonbench search` as a user runs it: small sets, few samples; times are not looked at. */
#include "../../bench/peer.h"
#include "../program.h"
#include "../rows.h"

#include <math.h>

START_TEST(test_fields_are_the_contract)
{
    json_t *const root = pm__expect_json("search --photons 500 --search recursive,brute --samples 3 --json -");
    ck_assert_str_eq(pm__text_of(root, "command"), "search");
    ck_assert_uint_eq(json_array_size(pm__rows_of(root)), 2);
    pm__check_keys(json_array_get(pm__rows_of(root), 0),
                   "search case photons kind k radius batch order threads build_ms build_ms_ci95 ns_per_query "
                   "ns_per_query_ci95 ns_per_query_min samples baseline ratio ratio_ci95 bytes_per_photon exact status "
                   "detail lookup front count outliers cycles instructions aa_ratio aa_ratio_ci95 aa_false_alarm_rate "
                   "noise warning ratio_samples");
    const json_t *const brute = json_array_get(pm__rows_of(root), 1);
    ck_assert_uint_eq(json_array_size(json_object_get(brute, "ratio_samples")), 3);
    ck_assert_str_eq(pm__text_of(brute, "baseline"), "recursive");
    ck_assert_double_gt(json_number_value(json_object_get(brute, "ratio")), 0.0);
    json_decref(root);
}
END_TEST

START_TEST(test_all_are_exact_on_every_set)
{
    json_t *const root = pm__expect_json("search --case all --photons 700 --k 1,8,50 --radius auto:20 --search all "
                                         "--order random,coherent --front on,off --samples 2 --json -");
    size_t index, own = 0, peers = 0;
    json_t *row;
    json_array_foreach(pm__rows_of(root), index, row) {
        ck_assert_msg(json_is_true(json_object_get(row, "exact")), "%s on %s, %s: %s", pm__text_of(row, "search"),
                      pm__text_of(row, "case"), pm__text_of(row, "kind"), pm__text_of(row, "detail"));
        ck_assert_str_eq(pm__text_of(row, "status"), "ok");
        if (pm__peer_find(pm__text_of(row, "search"))) {
            ck_assert_str_eq(pm__text_of(row, "front"), "off");
            peers++;
        } else {
            own++;
        }
    }
    ck_assert_uint_ge(own, 5 * 2 * 4 * 2 * 3); /* sets, orders, kinds, filters; three searches at least */
    ck_assert_uint_eq(peers > 0, pm__peers[0] != NULL);
    json_decref(root);
}
END_TEST

START_TEST(test_k_above_the_photons_finds_them_all)
{
    json_t *const root = pm__expect_json("search --photons 7 --k 50 --search all --samples 1 --json -");
    size_t index;
    json_t *row;
    json_array_foreach(pm__rows_of(root), index, row) {
        PM_CHECK_NEAR(json_number_value(json_object_get(row, "count")), 7.0, 1e-12);
        ck_assert(json_is_true(json_object_get(row, "exact")));
    }
    json_decref(root);
}
END_TEST

/* Said twice is once: so many rows for each search, each with its own shape and side. */
START_TEST(test_shapes_and_sides)
{
    json_t *const root = pm__expect_json("search --case square --photons 3000 --samples 1 --search recursive --k 8 "
                                         "--lookup sphere,disc:0.01,disc:0.01,ellipsoid:2 --front on,off,on "
                                         "--order random,coherent,random --seconds 20 --json -");
    static const char *const lookups[] = {"sphere", "disc:0.01", "ellipsoid:2"};
    size_t seen[3][2][2] = {{{0}}}, i;
    json_t *row;
    json_array_foreach(pm__rows_of(root), i, row) {
        size_t shape = 0;
        while (shape < 3 && strcmp(lookups[shape], pm__text_of(row, "lookup")) != 0)
            shape++;
        ck_assert_uint_lt(shape, 3);
        ck_assert(json_is_true(json_object_get(row, "exact")));
        seen[shape][(strcmp(pm__text_of(row, "front"), "on") == 0)][*pm__text_of(row, "order") == 'r']++;
    }
    for (size_t cell = 0; cell < 12; cell++)
        ck_assert_uint_eq(seen[cell / 4][cell / 2 % 2][cell % 2], 1);
    json_decref(root);
    const char *const text = pm__expect("search --case square --photons 500 --samples 1 --search brute,recursive --k 8 "
                                        "--lookup disc:0.01 --front on --quiet", 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(text, "brute front disc:0.01"));
    (void)pm__expect("search --seconds 0", 2, "--seconds");
}
END_TEST

START_TEST(test_screen_ends_with_a_verdict)
{
    const pm__run *const run =
        pm__expect("search --photons 3000 --k 20 --search wide,brute --samples 30 --quiet", 0, NULL);
    ck_assert_msg(strstr(run->out, "times faster than brute") != NULL, "%s", run->out);
    size_t column = 0;
    for (const char *c = run->out; *c; c++) {
        column = *c == '\n' ? 0 : column + (((unsigned char)*c & 0xc0) != 0x80);
        ck_assert_uint_le(column, 100);
    }
}
END_TEST

START_TEST(test_same_rows_but_for_times)
{
    static const char *const fields[] = {"search", "case", "k", "batch", "order", "count", "exact", "bytes_per_photon"};
    json_t *const one =
        pm__expect_json("search --photons 900 --k 9 --search wide,recursive --samples 1 --threads 1 --json -");
    json_t *const two =
        pm__expect_json("search --photons 900 --k 9 --search wide,recursive --samples 1 --threads 2 --json -");
    ck_assert_uint_eq(json_array_size(pm__rows_of(one)), json_array_size(pm__rows_of(two)));
    for (size_t i = 0; i < json_array_size(pm__rows_of(one)); i++)
        for (size_t f = 0; f < sizeof fields / sizeof *fields; f++)
            ck_assert_msg(json_equal(json_object_get(json_array_get(pm__rows_of(one), i), fields[f]),
                                     json_object_get(json_array_get(pm__rows_of(two), i), fields[f])),
                          "row %zu: %s", i, fields[f]);
    json_decref(one);
    json_decref(two);
}
END_TEST

START_TEST(test_a_file_of_photons)
{
    static const char header[] = "ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                                 "property float z\nproperty float dx\nproperty float dy\nproperty float dz\n"
                                 "property float r\nproperty float g\nproperty float b\nend_header\n%s";
    const pm__test_directory place = pm__test_directory_create();
    char path[PM__TEST_PATH], command[PM__TEST_PATH + 100];
    for (int count = 0; count <= 2; count += 2) {
        FILE *const file = fopen(pm__test_path(&place, "photons.ply", path), "w");
        ck_assert(file != NULL);
        (void)fprintf(file, header, count, count ? "0 0 0 0 0 -1 1 1 1\n1 0 0 0 0 -1 1 1 1\n" : "");
        ck_assert_int_eq(fclose(file), 0);
        (void)snprintf(command, sizeof command, "search --input %s --k 3 --search all --samples 1 --json -", path);
        json_t *const root = pm__expect_json(command);
        size_t index;
        json_t *row;
        ck_assert_uint_gt(json_array_size(pm__rows_of(root)), 0);
        json_array_foreach(pm__rows_of(root), index, row)
            PM_CHECK_NEAR(json_number_value(json_object_get(row, "count")), (double)count, 0.0);
        json_decref(root);
    }
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(test_refusals)
{
    (void)pm__expect("search --search wyde", 2, "did you mean 'wide'");
    (void)pm__expect("search --case cube", 2, "cube");
    (void)pm__expect("search --order sideways", 2, "random or coherent");
    (void)pm__expect("search --radius 0", 2, "radius");
    (void)pm__expect("search --radius auto:0", 2, "integer");
    (void)pm__expect("search --k 0", 2, "integer");
    (void)pm__expect("search --front maybe", 2, "on or off");
    (void)pm__expect("search --lookup cone", 2, "sphere");
    (void)pm__expect("search --input a.ply --case box", 2, "exclude");
    (void)pm__expect("search --input a.ply --photons 5", 2, "--photons");
    (void)pm__expect("search --input /nonexistent.ply", 3, "/nonexistent.ply");
    (void)pm__expect("search --photons 10,1000000000 --samples 1", 4, "GB are free");
    (void)pm__expect("search --photons 50 --samples 1 --search grid", 0, "no rows: none of the searches asked for");
    (void)pm__expect("search --photons 50 --search brute --samples 1 --quiet --json /dev/full -o /dev/null", 4, "full");
}
END_TEST

/* One round has no interval; names are whole. */
START_TEST(test_screen_of_one_round)
{
    const pm__run *const run = pm__expect("search --case square --photons 500 --samples 1 --k 5 --quiet --front on "
                                          "--search recursive,unbalanced --lookup ellipsoid:2.125", 0, NULL);
    ck_assert_msg(strstr(run->out, "±") == NULL, "%s", run->out);
    ck_assert_msg(strstr(run->out, "\n  recursive front ellipsoid:2.125 ") != NULL, "%s", run->out);
    ck_assert_msg(strstr(run->out, "\n  unbalanced front ellipsoid:2.125\n") != NULL, "%s", run->out);
    for (const char *line = run->out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_msg(strcspn(line, "\n") <= 100, "%.120s", line);
}
END_TEST

PM_TEST_MAIN("cli search", test_fields_are_the_contract, test_all_are_exact_on_every_set,
             test_k_above_the_photons_finds_them_all, test_shapes_and_sides, test_screen_ends_with_a_verdict,
             test_same_rows_but_for_times, test_a_file_of_photons, test_refusals,
             test_screen_of_one_round)
