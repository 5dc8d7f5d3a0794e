/* compare of results of storage, made by hand. */
#include "../compare.h"

/* Rows of storage have their intervals on squares, by groups of eye paths too: a variance of the square of half^2 /
 * t(3)^2 each, t(3) = 3.182446, that of rel_added by the 7 of 8 trials, t(7) = 2.364624. */
static void add_storage(char *rows, const char *policy, double rmse, double half, double added)
{
    const size_t used = strlen(rows);
    const double low = fmax(0.0, rmse * rmse - half), low_added = fmax(0.0, added * added - half);
    (void)snprintf(rows + used, TEXT - used,
                   "%s{\"scene\":\"scene:egg\",\"policy\":\"%s\",\"map\":\"caustic\",\"photons\":5000,\"wanted\":null,"
                   "\"spp\":64,\"trials\":8,\"trace_s\":1.5,\"total_s\":2.5,\"rel_bias\":0.01,"
                   "\"rel_bias_ci95\":[0,0.02],"
                   "\"rel_noise\":0.1,\"rel_rmse\":%.17g,\"rel_rmse_ci95\":[%.17g,%.17g],\"rel_added\":%.17g,"
                   "\"rel_added_ci95\":[%.17g,%.17g]}",
                   used ? "," : "", policy, rmse, sqrt(low), sqrt(rmse * rmse + half), added, sqrt(low_added),
                   sqrt(added * added + half));
}

/* By hand for the first pair: squares 0.01 and 0.04, standard errors 0.001 / 3.182446 each, so t = 0.03 / (0.001
 * sqrt(2) / 3.182446) = 67.51 at 6 degrees of freedom. */
START_TEST(planted_storage_changes)
{
    setup();
    const struct {
        double rmse_a, rmse_b, added_a, added_b, half;
        const char *rmse, *added;
    } pairs[] = {
        {0.1, 0.2, 0.05, 0.05, 0.001, "regressed", "not distinguishable"},
        {0.2, 0.1, 0.15, 0.05, 0.001, "improved", "improved"},
        {0.1, 0.101, 0.0, 0.0, 0.001, "not distinguishable", "not distinguishable"}, /* squares below 0 */
        {0.1, 0.1, 0.0, 0.2, 0.001, "not distinguishable", "regressed"},
        {0.1, 0.13, 0.1, 0.13, 0.02, "not distinguishable", "not distinguishable"},
    };
    clear();
    for (size_t i = 0; i < 5; i++) {
        char name[8];
        (void)snprintf(name, sizeof name, "p%zu", i);
        add_storage(rows_a, name, pairs[i].rmse_a, pairs[i].half, pairs[i].added_a);
        add_storage(rows_b, name, pairs[i].rmse_b, pairs[i].half, pairs[i].added_b);
    }
    write_file("a.json", "storage", rows_a);
    write_file("b.json", "storage", rows_b);
    json_t *const root = compare_json("a.json", "b.json", 1);
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 15);
    for (size_t i = 0; i < 5; i++) {
        ck_assert_str_eq(text_of(root, 3 * i, "quantity"), "rel_bias");
        ck_assert_str_eq(text_of(root, 3 * i, "verdict"), "not distinguishable");
        ck_assert_str_eq(text_of(root, 3 * i + 1, "quantity"), "rel_rmse");
        ck_assert_msg(strcmp(text_of(root, 3 * i + 1, "verdict"), pairs[i].rmse) == 0, "rmse of pair %zu: %s", i,
                      text_of(root, 3 * i + 1, "verdict"));
        ck_assert_str_eq(text_of(root, 3 * i + 2, "quantity"), "rel_added");
        ck_assert_msg(strcmp(text_of(root, 3 * i + 2, "verdict"), pairs[i].added) == 0, "added of pair %zu: %s", i,
                      text_of(root, 3 * i + 2, "verdict"));
    }
    ck_assert_str_eq(text_of(root, 1, "row"), "scene:egg p0 caustic photons=5000 spp=64");
    ck_assert_str_eq(text_of(root, 1, "change_kind"), "difference");
    PM_CHECK_NEAR(number_of(root, 1, "change"), 0.1, 1e-12);
    /* P(|T| >= 67.51) at 6 degrees of freedom: 7.1e-10. */
    PM_CHECK_NEAR(number_of(root, 1, "p"), 7.1e-10, 2e-11);
    json_decref(root);
    teardown();
}
END_TEST

START_TEST(hostile_storage_rows)
{
    setup();
    static const char *const values[][2] = {
        {"\"policy\":7", "rows[0].policy: expected text, not a number"},
        {"\"photons\":\"many\"", "rows[0].photons: expected a number, not text"},
        {"\"trials\":8,\"rel_rmse\":0.1,\"rel_rmse_ci95\":[0.2,0.1]", "but low is above high"},
        {"\"trials\":8,\"rel_rmse\":1e308,\"rel_rmse_ci95\":[0,1e308]", NULL},
        {"\"trials\":8,\"rel_rmse\":0.5,\"rel_rmse_ci95\":[0,0.1]", NULL},
        {"\"trials\":2,\"rel_added\":-1,\"rel_added_ci95\":[-3,0]", NULL},
        {"\"status\":\"unsupported\",\"rel_rmse\":null,\"rel_rmse_ci95\":null", NULL},
    };
    char row[300];
    for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
        (void)snprintf(row, sizeof row, "{\"scene\":\"scene:egg\",%s}", values[i][0]);
        write_file("a.json", "storage", row);
        (void)pm__expect(command("a.json", "a.json", "--json -"), values[i][1] ? 3 : 0, values[i][1]);
    }
    teardown();
}
END_TEST

PM_TEST_MAIN("cli compare of storage", planted_storage_changes, hostile_storage_rows)
