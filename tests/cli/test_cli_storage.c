/* `photonbench storage` as a user runs it: tiny sizes; how far the numbers are right is for the tests of what lies
 * below. */
#include "../program.h"
#include "../rows.h"

#include <stdbool.h>
#include <time.h>

#define TINY "--spp 4 --photons 500,2000 --trials 3 --paths 2000 "

static const char row_keys[] =
    "scene policy map emitted stored importons trace_s total_s flux_stored flux_expected power_spread rel_bias "
    "rel_noise rel_rmse rel_rmse_ci95 rel_bias_ci95 rms_bias rel_added rel_added_ci95 photons wanted trials "
    "importance_s policy_s build_s cost_added flux_kept flux_ratio flux_ratio_ci95 flux_important_stored "
    "flux_important_expected flux_important_ratio flux_important_ratio_ci95 unmet spp truth_mean status detail";
static const char front_keys[] = "scene policy map measure rel_error stored_ratio stored_ratio_ci95 trace_ratio "
                                 "trace_ratio_ci95 time_ratio time_ratio_ci95 stored_front time_front status detail";

/* By map, policy, photons; each row as the contract has it. */
START_TEST(rows_have_the_contract)
{
    json_t *const root = pm__expect_json("storage torus " TINY "--policy all,percentage,probability --json -");
    pm__check_keys(root, "schema command version options seed machine wall_s rows fronts");
    ck_assert_uint_eq(pm__items(root, "rows"), 2 * 3 * 2);
    for (size_t i = 0; i < 12; i++) {
        static const char *const policies[] = {"all", "percentage:share=0.1", "probability:"};
        json_t *const row = pm__item(root, "rows", i);
        const bool needs = i / 2 % 3 == 2;
        pm__check_keys(row, row_keys);
        ck_assert_str_eq(pm__text_of(row, "scene"), "scene:torus:ior=1.5,sun=5");
        ck_assert_str_eq(pm__text_of(row, "map"), i < 6 ? "caustic" : "global");
        ck_assert_int_eq(strncmp(pm__text_of(row, "policy"), policies[i / 2 % 3], strlen(policies[i / 2 % 3])), 0);
        ck_assert_double_eq(pm__number_of(row, "photons"), i % 2 ? 2000.0 : 500.0);
        ck_assert_double_eq(pm__number_of(row, "emitted"), i % 2 ? 2000.0 : 500.0);
        ck_assert(pm__is_null(row, "wanted") && pm__is_null(row, "importons") == !needs);
        ck_assert_double_gt(pm__number_of(row, "stored"), 0.0);
        ck_assert_double_gt(pm__number_of(row, "flux_expected"), 0.0);
        ck_assert_double_gt(pm__number_of(row, "rel_rmse"), 0.0);
        ck_assert_double_ge(pm__number_of(row, "power_spread"), 1.0);
        ck_assert_double_ge(pm__number_of(row, "total_s"), pm__number_of(row, "trace_s"));
        ck_assert_double_eq(pm__number_of(row, "trials"), 3.0);
        ck_assert(isfinite(pm__number_of(row, "cost_added")));
        if (i / 2 % 3 == 0) /* `all` beside itself */
            ck_assert_double_eq(pm__number_of(row, "cost_added"), 0.0);
        else
            ck_assert_double_gt(pm__number_of(row, "cost_added"), -1.0);
        ck_assert_double_eq(pm__number_of(row, "spp"), 4.0);
        ck_assert_str_eq(pm__text_of(row, "status"), "ok");
    }
    json_decref(root);
}
END_TEST

/* Even sending keeps what comes, and that of the largest number is what is expected. */
START_TEST(all_keeps_everything)
{
    json_t *const root = pm__expect_json("storage torus " TINY "--policy all,percentage --json -");
    const json_t *const large = pm__item(root, "rows", 1);
    PM_CHECK_NEAR(pm__number_of(large, "flux_kept"), 1.0, 1e-6);
    PM_CHECK_NEAR(pm__number_of(large, "flux_ratio"), 1.0, 1e-6);
    PM_CHECK_NEAR(pm__number_of(large, "flux_important_ratio"), 1.0, 1e-6);
    /* `percentage` keeps every caustic photon: the same map. */
    PM_CHECK_NEAR(pm__number_of(pm__item(root, "rows", 3), "rel_rmse"), pm__number_of(large, "rel_rmse"), 0.0);
    ck_assert_uint_eq(pm__items(root, "fronts"), 4);
    for (size_t i = 0; i < 4; i++) {
        json_t *const front = pm__item(root, "fronts", i);
        const bool ok = strcmp(pm__text_of(front, "status"), "ok") == 0;
        pm__check_keys(front, front_keys);
        ck_assert(pm__is_null(front, "stored_ratio") == !ok && pm__is_null(front, "rel_error") == !ok);
        ck_assert(ok == !*pm__text_of(front, "detail"));
        ck_assert_uint_ge(json_array_size(json_object_get(front, "stored_front")), 1);
    }
    json_decref(root);
    /* Without `all` there is nothing to compare with; what is expected is there all the same. */
    json_t *const alone = pm__expect_json("storage torus " TINY "--policy percentage --map global --json -");
    ck_assert_uint_eq(pm__items(alone, "rows"), 2);
    ck_assert_double_gt(pm__number_of(pm__item(alone, "rows", 0), "flux_expected"), 0.0);
    ck_assert(pm__is_null(pm__item(alone, "rows", 0), "cost_added") &&
              pm__is_null(pm__item(alone, "rows", 1), "cost_added"));
    ck_assert_str_eq(pm__text_of(pm__item(alone, "fronts", 0), "status"), "incomparable");
    json_decref(alone);
}
END_TEST

START_TEST(so_many_are_stored)
{
    json_t *const root = pm__expect_json("storage torus --spp 4 --trials 2 --stored 300 --policy all --map global "
                                         "--json -");
    const json_t *const row = pm__item(root, "rows", 0);
    ck_assert_uint_eq(pm__items(root, "rows"), 1);
    ck_assert(pm__is_null(row, "photons"));
    ck_assert_double_eq(pm__number_of(row, "wanted"), 300.0);
    ck_assert_double_ge(pm__number_of(row, "stored"), 280.0); /* up to the path by which so many would be */
    ck_assert_double_le(pm__number_of(row, "stored"), 300.0);
    ck_assert(pm__is_null(row, "detail"));
    json_decref(root);
}
END_TEST

static char *comparable(json_t *root)
{
    static const char *const times[] = {"trace_s", "total_s", "importance_s", "policy_s", "build_s",
                                         "cost_added"};
    for (size_t i = 0; i < pm__items(root, "rows"); i++)
        for (size_t t = 0; t < sizeof times / sizeof *times; t++)
            (void)json_object_del(pm__item(root, "rows", i), times[t]);
    char *const text = json_dumps(json_object_get(root, "rows"), JSON_COMPACT | JSON_REAL_PRECISION(17));
    ck_assert_ptr_nonnull(text);
    json_decref(root);
    return text;
}

START_TEST(threads_make_no_difference)
{
    char *const one = comparable(pm__expect_json("storage torus " TINY "--threads 1 --seed 5 --json -"));
    char *const three = comparable(pm__expect_json("storage torus " TINY "--threads 3 --seed 5 --json -"));
    char *const other = comparable(pm__expect_json("storage torus " TINY "--threads 1 --seed 6 --json -"));
    ck_assert_str_eq(one, three);
    ck_assert_str_ne(one, other);
    free(one);
    free(three);
    free(other);
}
END_TEST

START_TEST(usage)
{
    (void)pm__expect("storage torus --policy densty", 2, "unknown policy 'densty'; did you mean 'density'?");
    (void)pm__expect("storage torsu", 2, "unknown scene 'torsu'; did you mean 'torus'?");
    (void)pm__expect("storage torus --map causal", 2, "--map: 'causal': expected caustic or global");
    (void)pm__expect("storage torus --spp 6", 2, "--spp: '6' is not a multiple of 4");
    (void)pm__expect("storage torus --trials 1", 2, "--trials: '1' is not an integer from 2");
    (void)pm__expect("storage torus --k 1", 2, "--k: '1' is not an integer from 2");
    (void)pm__expect("storage torus --share 0", 2, "--share: '0' is not a number above 0, at most 1");
    (void)pm__expect("storage torus --importance eyes", 2, "'eyes': expected screen, pixels or both");
    (void)pm__expect("storage torus --size 33x33", 2, "the reference has 32 x 32 pixels");
    (void)pm__expect("storage torus:ior=1.4", 2, "scene:torus:ior=1.4 has no stored reference: that of scene:torus is "
                                                 "of its defaults alone");
    (void)pm__expect("storage plate", 2, "scene:plate has no stored reference to compare its image with");
    (void)pm__expect("storage cornell-diffuse --map caustic --photons 100 --spp 4 --size 128x128", 2,
                     "cornell-diffuse has no light that a caustic map holds");
    (void)pm__expect("storage torus -o -", 2, "expected what the names of image files start with");
}
END_TEST

/* Beside one that can be measured, one that cannot is a row that says why. */
START_TEST(unsupported_is_a_row)
{
    json_t *const root = pm__expect_json("storage plate,torus " TINY "--policy all --map global --json -");
    const json_t *const row = pm__item(root, "rows", 0);
    ck_assert_uint_eq(pm__items(root, "rows"), 3);
    ck_assert_str_eq(pm__text_of(row, "status"), "unsupported");
    ck_assert_ptr_nonnull(strstr(pm__text_of(row, "detail"), "has no stored reference"));
    ck_assert(pm__is_null(row, "policy") && pm__is_null(row, "rel_rmse") && pm__is_null(row, "unmet"));
    json_decref(root);
}
END_TEST

START_TEST(complete_or_absent)
{
    (void)pm__expect("storage torus " TINY "--policy all --map global --json /dev/full", 4,
                     "/dev/full: cannot be written");
    (void)pm__expect("storage torus --trials 1000 --csv /nonexistent/a.csv", 4, "/nonexistent/a.csv: cannot be opened");
    (void)pm__expect("storage torus --trials 1000 -o /nonexistent/a", 4, "/nonexistent/a.torus.");
}
END_TEST

START_TEST(images)
{
    static const char *const files[] = {
        "d.torus.caustic.required.exr",   "d.torus.caustic.required.png",
        "d.torus.caustic.density.actual.exr", "d.torus.caustic.density.actual.png",
        "d.torus.caustic.density.convergence.exr", "d.torus.caustic.density.convergence.png",
        "d.torus.global.required.exr",    "d.torus.global.required.png",
        "d.torus.global.density.actual.exr", "d.torus.global.density.actual.png"};
    const pm__test_directory place = pm__test_directory_create();
    char arguments[PM__TEST_PATH + 200], path[PM__TEST_PATH], bytes[16];
    (void)snprintf(arguments, sizeof arguments, "storage torus " TINY "--policy density --trials 2 --quiet -o %s/d.exr",
                   place.path);
    (void)pm__expect(arguments, 0, NULL);
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        const bool png = strstr(files[i], ".png");
        ck_assert_int_ge(pm__test_read(pm__test_path(&place, files[i], path), bytes, sizeof bytes), 8);
        ck_assert_msg(memcmp(bytes, png ? "\x89PNG\r\n\x1a\n" : "\x76\x2f\x31\x01", png ? 8 : 4) == 0, "%s", files[i]);
    }
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), (int)(sizeof files / sizeof *files));
    pm__test_directory_remove(&place);
}
END_TEST

/* What was complete is written, and the status says so. */
/* To whom light is important, and how many importons carry an estimate of it: recorded, and other photons are kept. */
START_TEST(importance_and_share)
{
    static const char *const options[] = {"", "--importance screen", "--importance pixels", "--importance both",
                                          "--share 0.5"};
    double stored[5];
    for (size_t i = 0; i < 5; i++) {
        char line[300];
        (void)snprintf(line, sizeof line, "storage torus " TINY "--map caustic --policy probability %s --json -",
                       options[i]);
        json_t *const root = pm__expect_json(line), *const said = json_object_get(root, "options");
        stored[i] = pm__number_of(pm__item(root, "rows", 1), "stored");
        ck_assert_str_eq(pm__text_of(said, "importance"), i == 1 ? "screen" : i == 2 ? "pixels" : "both");
        ck_assert_double_eq(pm__number_of(said, "share"), i == 4 ? 0.5 : 0.25);
        json_decref(root);
    }
    ck_assert_double_eq(stored[0], stored[3]);
    for (size_t i = 0; i < 3; i++)
        for (size_t j = 0; j < i; j++)
            ck_assert_double_ne(stored[i], stored[j]);
    ck_assert_double_ne(stored[0], stored[4]);
}
END_TEST

START_TEST(interrupted)
{
    const pm__test_directory place = pm__test_directory_create();
    char arguments[PM__TEST_PATH + 200], json[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH];
    (void)snprintf(arguments, sizeof arguments,
                   "storage torus --spp 4 --photons 500 --trials 100000 --paths 2000 --policy all --map global --json "
                   "%s", pm__test_path(&place, "json", json));
    const pid_t child = pm__start(arguments, pm__test_path(&place, "out", out), pm__test_path(&place, "err", err));
    const time_t start = time(NULL);
    const struct timespec moment = {.tv_nsec = 200000000};
    /* The view is made before the first trial; how long it takes nobody knows. */
    for (int i = 0; i < 10 + 5 * (getenv("CK_TIMEOUT_MULTIPLIER") ? 20 : 2); i++)
        (void)nanosleep(&moment, NULL);
    ck_assert_int_eq(kill(child, SIGINT), 0);
    ck_assert_int_eq(pm__wait(child), 130);
    ck_assert_int_le(time(NULL) - start, 120);
    static char text[PM__OUTPUT_SIZE];
    ck_assert_int_gt(pm__test_read(json, text, sizeof text), 0);
    json_t *const root = json_loads(text, 0, NULL);
    ck_assert_ptr_nonnull(root);
    for (size_t i = 0; i < pm__items(root, "rows"); i++) { /* none where it came early */
        ck_assert_str_eq(pm__text_of(pm__item(root, "rows", i), "status"), "interrupted");
        ck_assert_double_ge(pm__number_of(pm__item(root, "rows", i), "trials"), 2.0);
    }
    json_decref(root);
    pm__test_directory_remove(&place);
}
END_TEST

/* A time that is over at once leaves two trials. */
START_TEST(seconds_end_it)
{
    json_t *const root = pm__expect_json("storage torus --spp 4 --photons 500 --paths 2000 --trials 100000 "
                                         "--policy all --map global --seconds 1e-7 --json -");
    ck_assert_double_eq(pm__number_of(pm__item(root, "rows", 0), "trials"), 2.0);
    json_decref(root);
}
END_TEST

START_TEST(table_fits)
{
    const char *line = pm__expect("storage torus " TINY, 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(line, "at equal error `all` needs so many times as much"));
    for (; *line; line += strcspn(line, "\n") + 1)
        ck_assert_msg(strcspn(line, "\n") <= 100, "%.*s", (int)strcspn(line, "\n"), line);
}
END_TEST

PM_TEST_MAIN("cli storage", rows_have_the_contract, all_keeps_everything, so_many_are_stored,
             threads_make_no_difference, usage, unsupported_is_a_row, complete_or_absent, images,
             importance_and_share, interrupted, seconds_end_it, table_fits)
