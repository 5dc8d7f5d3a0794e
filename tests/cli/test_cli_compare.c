/* compare as a script sees it, on small files made by hand. */
#include "../compare.h"

enum { SAMPLES = 40 };

static double spread = 0.02; /* of the samples, relative */

/* Samples of ratio `ratio` from a fixed sequence. */
static void add_search(char *rows, const char *search, int k, double ratio, unsigned seed, const char *exact)
{
    size_t used = strlen(rows);
    used +=
        (size_t)snprintf(rows + used, TEXT - used,
                         "%s{\"search\":\"%s\",\"case\":\"box\",\"photons\":1000,\"kind\":\"knn\",\"k\":%d,\"radius\":"
                         "null,\"batch\":1,\"order\":\"coherent\",\"threads\":1,\"ns_per_query\":%d,\"baseline\":"
                         "\"cgal\",\"ratio\":%.17g,\"exact\":%s,\"status\":\"ok\",\"ratio_samples\":",
                         used ? "," : "", search, k, 100 + (int)seed, ratio, exact);
    for (int i = 0; i < SAMPLES; i++) {
        seed = seed * 1664525u + 1013904223u;
        const double noise = spread * ((double)(seed >> 8) / 8388608.0 - 1.0);
        used += (size_t)snprintf(rows + used, TEXT - used, "%s%.17g", i ? "," : "[", ratio * (1.0 + noise));
    }
    (void)snprintf(rows + used, TEXT - used, "]}");
}

static void add_accuracy(char *rows, const char *estimator, double bias, double noise)
{
    const size_t used = strlen(rows);
    const double t = 2.0395134, se = 0.01 / t; /* the quantile for 29 degrees of freedom: half widths of 0.01 */
    (void)snprintf(
        rows + used, TEXT - used,
        "%s{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"%s\",\"kind\":\"knn\",\"k\":50,\"photons\":1000,"
        "\"trials\":30,\"rel_bias\":%.17g,\"rel_bias_ci95\":[%.17g,%.17g],\"rel_noise\":%.17g,\"rel_noise_ci95\":["
        "%.17g,%.17g],\"rel_rmse\":null,\"rel_rmse_ci95\":null}",
        used ? "," : "", estimator, bias, bias - t * se, bias + t * se, noise, noise / 1.02, noise * 1.02);
}

START_TEST(identical_files_do_not_differ)
{
    setup();
    clear();
    add_search(rows_a, "wide", 50, 12.9, 1, "true");
    add_search(rows_a, "cgal", 50, 1.0, 2, "true");
    write_file("a.json", "search", rows_a);
    const char *const out = pm__expect(command("a.json", "a.json", ""), 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, "wide box photons=1000 knn k=50 batch=1 coherent threads=1 over cgal"));
    ck_assert_ptr_nonnull(strstr(out, "0 improved, 0 regressed, 1 not distinguishable, 0 only in A, 0 only in B"));
    *rows_a = '\0';
    add_accuracy(rows_a, "disc", 0.1, 0.3);
    write_file("a.json", "accuracy", rows_a);
    ck_assert_ptr_nonnull(strstr(pm__expect(command("a.json", "a.json", ""), 0, NULL)->out, "2 not distinguishable"));
    write_file("a.json", "accuracy", "");
    ck_assert_ptr_nonnull(strstr(pm__expect(command("a.json", "a.json", ""), 0, NULL)->out, "0 regressed"));
    teardown();
}
END_TEST

/* 4 % slower, 4 % faster, the same law with other noise, within the tolerance; absolute times play no part. */
START_TEST(planted_search_changes)
{
    setup();
    clear();
    const double ratios[] = {12.9, 3.0, 7.0, 5.0}, factors[] = {0.96, 1.04, 1.0, 0.995};
    const char *const names[] = {"wide", "grid", "brute", "recursive"};
    const char *const verdicts[] = {"regressed", "improved", "not distinguishable", "not distinguishable"};
    for (unsigned i = 0; i < 4; i++) {
        add_search(rows_a, names[i], 50, ratios[i], 10 + i, "true");
        add_search(rows_b, names[3 - i], 50, ratios[3 - i] * factors[3 - i], 900 + i, "true"); /* in another order */
    }
    write_file("a.json", "search", rows_a);
    write_file("b.json", "search", rows_b);
    json_t *const root = compare_json("a.json", "b.json", 1);
    pm__check_keys(root, "schema command version options seed machine wall_s rows");
    pm__check_keys(json_array_get(json_object_get(root, "rows"), 0),
                   "row quantity a b change change_ci95 change_kind samples_a samples_b p p_family verdict");
    for (size_t i = 0; i < 4; i++) {
        json_t *const ci95 = json_object_get(json_array_get(json_object_get(root, "rows"), i), "change_ci95");
        ck_assert_str_eq(text_of(root, i, "verdict"), verdicts[i]);
        ck_assert_ptr_nonnull(strstr(text_of(root, i, "row"), names[i]));
        PM_CHECK_NEAR(number_of(root, i, "change"), factors[i], 0.015);
        ck_assert(json_number_value(json_array_get(ci95, 0)) < factors[i]);
        ck_assert(json_number_value(json_array_get(ci95, 1)) > factors[i]);
        PM_CHECK_NEAR(number_of(root, i, "p_family"), fmin(1.0, 4.0 * number_of(root, i, "p")), 1e-15);
        ck_assert(number_of(root, i, "samples_a") == SAMPLES);
    }
    json_decref(root);
    const char *const out = pm__expect(command("a.json", "b.json", ""), 1, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, "1 improved, 1 regressed, 2 not distinguishable"));
    for (const char *line = out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_uint_le(strcspn(line, "\n"), 100);
    ck_assert_ptr_nonnull(strstr(pm__expect(command("b.json", "a.json", "--csv -"), 1, NULL)->out, ",improved\n"));
    teardown();
}
END_TEST

/* However certain, 0.7 % is where the system put the memory; 1.3 % is more. */
START_TEST(small_changes_are_tolerated)
{
    setup();
    clear();
    spread = 0.001;
    add_search(rows_a, "wide", 50, 12.9, 1, "true");
    add_search(rows_b, "wide", 50, 12.9 * 0.993, 2, "true");
    write_file("a.json", "search", rows_a);
    write_file("b.json", "search", rows_b);
    ck_assert_ptr_nonnull(strstr(pm__expect(command("a.json", "b.json", ""), 0, NULL)->out, "1 not distinguishable"));
    *rows_b = '\0';
    add_search(rows_b, "wide", 50, 12.9 * 0.987, 2, "true");
    write_file("b.json", "search", rows_b);
    ck_assert_ptr_nonnull(strstr(pm__expect(command("a.json", "b.json", ""), 1, NULL)->out, "1 regressed"));
    teardown();
}
END_TEST

START_TEST(rows_in_one_file_only)
{
    setup();
    clear();
    add_search(rows_a, "wide", 50, 12.9, 1, "true");
    add_search(rows_a, "wide", 8, 4.0, 2, "true");
    add_search(rows_b, "wide", 500, 40.0, 3, "true");
    add_search(rows_b, "wide", 50, 12.9, 4, "true");
    write_file("a.json", "search", rows_a);
    write_file("b.json", "search", rows_b);
    json_t *const root = compare_json("a.json", "b.json", 0);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 3);
    ck_assert_str_eq(text_of(root, 0, "verdict"), "not distinguishable");
    ck_assert_str_eq(text_of(root, 1, "verdict"), "only in A");
    ck_assert_ptr_nonnull(strstr(text_of(root, 1, "row"), "k=8"));
    ck_assert_str_eq(text_of(root, 2, "verdict"), "only in B");
    ck_assert_ptr_nonnull(strstr(text_of(root, 2, "row"), "k=500"));
    json_decref(root);
    teardown();
}
END_TEST

/* A mean over other probes is another quantity. */
START_TEST(other_probes_are_other_rows)
{
#define PROBED "{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"disc\",\"photons\":9,\"probes\":"
    setup();
    write_file("a.json", "accuracy", PROBED "2048}");
    write_file("b.json", "accuracy", PROBED "512}");
    json_t *const root = compare_json("a.json", "b.json", 0);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 2);
    ck_assert_str_eq(text_of(root, 0, "verdict"), "only in A");
    ck_assert_ptr_nonnull(strstr(text_of(root, 0, "row"), "probes=2048"));
    ck_assert_str_eq(text_of(root, 1, "verdict"), "only in B");
    json_decref(root);
    teardown();
}
END_TEST

/* A baseline's batches have a ratio of their own and are compared; its own row is 1 by definition and is not. */
START_TEST(batches_of_the_baseline_are_compared)
{
#define OF_CGAL(batch, median, samples) "{\"search\":\"cgal\",\"case\":\"box\",\"photons\":9,\"batch\":" #batch \
    ",\"baseline\":\"cgal\",\"ratio\":" #median ",\"ratio_samples\":" samples "}"
    setup();
    write_file("a.json", "search", OF_CGAL(1, 1, "[1,1,1]") "," OF_CGAL(16, 1.1, "[1.2,1,1.1]"));
    json_t *const root = compare_json("a.json", "a.json", 0);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 1);
    ck_assert_ptr_nonnull(strstr(text_of(root, 0, "row"), "batch=16"));
    json_decref(root);
    teardown();
}
END_TEST

START_TEST(losing_exactness_is_a_regression)
{
    setup();
    clear();
    add_search(rows_a, "wide", 50, 12.9, 1, "true");
    add_search(rows_b, "wide", 50, 12.9, 1, "false");
    write_file("a.json", "search", rows_a);
    write_file("b.json", "search", rows_b);
    json_t *root = compare_json("a.json", "b.json", 1);
    ck_assert_str_eq(text_of(root, 0, "quantity"), "exact");
    ck_assert_str_eq(text_of(root, 0, "verdict"), "regressed");
    json_decref(root);
    root = compare_json("b.json", "a.json", 0);
    ck_assert_str_eq(text_of(root, 0, "verdict"), "improved");
    json_decref(root);
    teardown();
}
END_TEST

/* Half widths of 0.01 at 29 degrees of freedom: a difference d has standard error 0.01 sqrt(2) / 2.045 = 0.00691, and
 * with a family of 10 a p of 0.005: 2.93 errors at 58 degrees, 0.0203. */
START_TEST(planted_accuracy_changes)
{
    setup();
    const struct {
        double bias_a, bias_b, noise_a, noise_b;
        const char *bias, *noise;
    } pairs[] = {
        {0.10, 0.125, 0.3, 0.3, "regressed", "not distinguishable"},
        {0.10, 0.115, 0.3, 0.25, "not distinguishable", "improved"},
        {-0.10, -0.07, 0.3, 0.33, "improved", "regressed"},
        {-0.10, 0.10, 0.3, 0.31, "not distinguishable", "not distinguishable"}, /* the size of the bias counts */
        {0.002, -0.1, 0.3, 0.29, "regressed", "not distinguishable"},
    };
    clear();
    for (size_t i = 0; i < 5; i++) {
        char name[8];
        (void)snprintf(name, sizeof name, "e%zu", i);
        add_accuracy(rows_a, name, pairs[i].bias_a, pairs[i].noise_a);
        add_accuracy(rows_b, name, pairs[i].bias_b, pairs[i].noise_b);
    }
    write_file("a.json", "accuracy", rows_a);
    write_file("b.json", "accuracy", rows_b);
    json_t *const root = compare_json("a.json", "b.json", 1);
    for (size_t i = 0; i < 5; i++) {
        ck_assert_str_eq(text_of(root, 2 * i, "quantity"), "rel_bias");
        ck_assert_msg(strcmp(text_of(root, 2 * i, "verdict"), pairs[i].bias) == 0, "bias of pair %zu: %s", i,
                      text_of(root, 2 * i, "verdict"));
        ck_assert_msg(strcmp(text_of(root, 2 * i + 1, "verdict"), pairs[i].noise) == 0, "noise of pair %zu: %s", i,
                      text_of(root, 2 * i + 1, "verdict"));
    }
    /* By hand: t = 0.025 / (sqrt(2) 0.01 / 2.0452296); P(|T58| > 3.6154) = 0.00063. */
    PM_CHECK_NEAR(number_of(root, 0, "change"), 0.025, 1e-12);
    PM_CHECK_NEAR(number_of(root, 0, "p"), 0.00063, 0.00001);
    PM_CHECK_NEAR(number_of(root, 1, "change"), 1.0, 1e-12);
    json_decref(root);
    teardown();
}
END_TEST

static const char good_row[] =
    "{\"search\":\"wide\",\"case\":\"box\",\"photons\":9,\"ratio\":2,\"ratio_samples\":[2,2.1]}";

static const struct {
    const char *text; /* NULL: no such file */
    int status;
    const char *message;
} hostile[] = {
    {NULL, 3, "b.json: cannot be opened: No such file"},
    {"", 3, "b.json: line 1, byte 0: expected JSON"},
    {"{\"schema\":\"photonbench/1\",\"comm", 3, "b.json: line 1, byte 31: expected JSON"},
    {"[1,2]", 3, "expected an object with schema photonbench/1, not an array"},
    {"{}", 3, "schema: expected \"photonbench/1\", not nothing"},
    {"{\"schema\":5}", 3, "schema: expected \"photonbench/1\", not a number"},
    {"{\"schema\":\"photonbench/2\"}", 3, "schema: expected \"photonbench/1\", not \"photonbench/2\""},
    {"{\"schema\":\"\\u001b[31m\"}", 3, "not \"?[31m\""},
    {"{\"schema\":\"photonbench/1\"}", 3, "command: expected text, not nothing"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"search\"}", 3, "rows: expected an array, not nothing"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"search\",\"rows\":{}}", 3, "rows: expected an array, not an object"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"search\",\"rows\":[7]}", 3,
     "rows[0]: expected an object, not a number"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"search\",\"rows\":[{}]}", 3,
     "rows[0].search: expected text, not nothing"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"search\",\"command\":\"search\"}", 3,
     "expected JSON: duplicate object key"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"list\",\"rows\":[]}", 2, "results of 'list' cannot be compared"},
    {"{\"schema\":\"photonbench/1\",\"command\":\"accuracy\",\"rows\":[]}", 2, "different commands cannot be compared"},
    {"\x76\x2f\x31\x01\x02", 2, "b.json is an OpenEXR image"},
    {"vast", 3, "expected JSON"},
};

START_TEST(hostile_files)
{
    setup();
    char path[PM__TEST_PATH];
    write_file("a.json", "search", good_row);
    for (size_t i = 0; i < sizeof hostile / sizeof *hostile; i++) {
        (void)remove(pm__test_path(&place, "b.json", path));
        if (hostile[i].text)
            write_text("b.json", hostile[i].text);
        ck_assert_str_eq(pm__expect(command("a.json", "b.json", ""), hostile[i].status, hostile[i].message)->out, "");
        if (hostile[i].status == 3)
            (void)pm__expect(command("b.json", "a.json", ""), 3, hostile[i].message);
    }
    (void)pm__expect(command("a.json", ".", ""), 3, "cannot be read: Is a directory");
    teardown();
}
END_TEST

static const struct {
    const char *change; /* of the good row: what stands in place of ratio and its samples */
    const char *message;
} bad_rows[] = {
    {"\"ratio\":\"2\",\"ratio_samples\":[2]", "rows[0].ratio: expected a number or null, not text"},
    {"\"ratio\":2", "rows[0].ratio_samples: expected an array of numbers"},
    {"\"ratio\":2,\"ratio_samples\":\"2\"", "rows[0].ratio_samples: expected an array of numbers"},
    {"\"ratio\":2,\"ratio_samples\":[2,0]", "rows[0].ratio_samples[1]: expected a number above 0"},
    {"\"ratio\":2,\"ratio_samples\":[-1]", "rows[0].ratio_samples[0]: expected a number above 0"},
    {"\"ratio\":2,\"ratio_samples\":[[2]]", "rows[0].ratio_samples[0]: expected a number above 0, not an array"},
    {"\"ratio\":2,\"ratio_samples\":[2,NaN]", "expected JSON: invalid token near 'NaN'"},
    {"\"ratio\":2,\"ratio_samples\":[2,1e999]", "expected JSON: real number overflow"},
    {"\"ratio\":2,\"ratio_samples\":[99999999999999999999]", "expected JSON: too big integer"},
};

START_TEST(hostile_rows)
{
    setup();
    char row[400];
    write_file("a.json", "search", good_row);
    for (size_t i = 0; i < sizeof bad_rows / sizeof *bad_rows; i++) {
        (void)snprintf(row, sizeof row, "{\"search\":\"wide\",\"case\":\"box\",\"photons\":9,%s}", bad_rows[i].change);
        write_file("b.json", "search", row);
        (void)pm__expect(command("a.json", "b.json", ""), 3, bad_rows[i].message);
    }
    /* Values at the ends of the range give an answer; nulls and empty arrays are values that do not exist. */
    write_file("b.json", "search",
               "{\"search\":\"wide\",\"case\":\"box\",\"photons\":9,\"ratio\":1e308,\"ratio_samples\":[1e308,1e-308]}");
    (void)pm__expect(command("a.json", "b.json", "--json -"), 0, NULL);
    write_file("b.json", "search",
               "{\"search\":\"wide\",\"case\":\"box\",\"photons\":9,\"ratio\":null,\"ratio_samples\":null}");
    json_t *const root = compare_json("a.json", "b.json", 0);
    ck_assert_str_eq(text_of(root, 0, "verdict"), "only in A");
    ck_assert_str_eq(text_of(root, 0, "quantity"), "ratio");
    json_decref(root);
    teardown();
}
END_TEST

START_TEST(hostile_accuracy_rows)
{
    setup();
    static const char *const values[][2] = {
        {"\"trials\":30,\"rel_bias\":[],\"rel_bias_ci95\":[0,1]",
         "rows[0].rel_bias: expected a number or null, not an array"},
        {"\"trials\":30,\"rel_bias\":0,\"rel_bias_ci95\":[0]", "rows[0].rel_bias_ci95: expected [low, high] or null"},
        {"\"trials\":30,\"rel_bias\":0,\"rel_bias_ci95\":[1,0]", "but low is above high"},
        {"\"trials\":1,\"rel_bias\":0,\"rel_bias_ci95\":[0,1]", "rows[0].trials: expected a number, at least 2"},
        {"\"rel_bias\":0,\"rel_bias_ci95\":[0,1]", "rows[0].trials: expected a number, at least 2"},
        {"\"trials\":1e300,\"rel_bias\":1e308,\"rel_bias_ci95\":[-1e308,1e308]", NULL},
        {"\"trials\":2,\"rel_noise\":0,\"rel_noise_ci95\":[0,0]", NULL},
        {"\"trials\":2,\"rel_rmse\":-1,\"rel_rmse_ci95\":[-2,-1e-300]", NULL},
    };
    char row[500];
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        (void)snprintf(row, sizeof row,
                       "{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"disc\",\"photons\":9,%s}",
                       values[i][0]);
        write_file("a.json", "accuracy", row);
        (void)pm__expect(command("a.json", "a.json", ""), values[i][1] ? 3 : 0, values[i][1]);
    }
    teardown();
}
END_TEST

/* Text from a file reaches the terminal as printable characters only. */
START_TEST(foreign_text_is_made_printable)
{
    setup();
    write_file("a.json", "search", "{\"search\":\"\\u001b[2J\\u00e9\",\"case\":\"b\\nx\",\"photons\":9}");
    write_file("b.json", "search", "");
    const char *const out = pm__expect(command("a.json", "b.json", ""), 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, "?[2J?? b?x photons=9"));
    ck_assert_ptr_null(strchr(out, '\033'));
    teardown();
}
END_TEST

START_TEST(usage_and_help)
{
    (void)pm__expect("compare", 2, "two result files are needed");
    (void)pm__expect("compare a.json", 2, "two result files are needed");
    (void)pm__expect("compare a b c", 2, "unexpected argument 'c'");
    (void)pm__expect("compare a b --seed 2", 2, "unknown option '--seed'");
    setup();
    write_file("a.json", "search", good_row);
    (void)pm__expect(command("a.json", "a.json", "--metric mse"), 2, "--metric is for two images");
    teardown();
    const char *const out = pm__expect("help compare", 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, "Usage: photonbench compare [options] A B"));
    ck_assert_ptr_nonnull(strstr(out, "Exit status 1: something regressed"));
    for (const char *line = out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_uint_le(strcspn(line, "\n"), 100);
}
END_TEST

PM_TEST_MAIN("cli compare", identical_files_do_not_differ, planted_search_changes, small_changes_are_tolerated,
             rows_in_one_file_only, other_probes_are_other_rows, batches_of_the_baseline_are_compared,
             losing_exactness_is_a_regression, planted_accuracy_changes, hostile_files, hostile_rows,
             hostile_accuracy_rows, foreign_text_is_made_printable, usage_and_help)
