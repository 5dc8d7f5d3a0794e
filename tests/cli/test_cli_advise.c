/* `photonbench advise` as a user runs it. Which row is cheapest depends on the clock; what a row says does not where
 * there is one estimator and no bias: the smallest map is the cheapest then. */
#include "../program.h"
#include "../rows.h"

#include <stdbool.h>
#include <unistd.h>

#define TINY "--estimator disc:last=none --method map --probes 200 --photons 8000 --seconds 1 "

START_TEST(fields_are_the_contract)
{
    json_t *const root = pm__expect_json("advise gradient --error 10% " TINY "--json -");
    json_t *const row = pm__item(root, "rows", 0);
    ck_assert_str_eq(pm__text_of(root, "command"), "advise");
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 1);
    pm__check_keys(row, "case error method estimator k radius photons passes trials predicted_rel_bias "
                        "predicted_rel_noise predicted_rel_rmse predicted_seconds advised command reached_rel_rmse "
                        "reached_rel_rmse_ci95 reached_seconds ratio status detail");
    ck_assert_str_eq(pm__text_of(row, "method"), "map");
    ck_assert_str_eq(pm__text_of(row, "estimator"), "disc:last=none");
    ck_assert_str_eq(pm__text_of(row, "status"), "ok");
    ck_assert(json_is_true(json_object_get(row, "advised")));
    ck_assert(json_is_null(json_object_get(row, "passes")));
    ck_assert(json_is_null(json_object_get(row, "reached_rel_rmse")));
    PM_CHECK_NEAR(pm__number_of(row, "error"), 0.1, 1e-15);
    PM_CHECK_NEAR(pm__number_of(row, "predicted_rel_rmse"), 0.1, 1e-3);
    /* noise 1 / (k - 2), share 1 / 16, and a mean square of the light on the slope of 1 + 1 / 12 at most */
    ck_assert_double_ge(pm__number_of(row, "k"), 95.0);
    ck_assert_double_le(pm__number_of(row, "k"), 115.0);
    PM_CHECK_NEAR(pm__number_of(row, "photons"), 16.0 * pm__number_of(row, "k"), 1.0);
    json_decref(root);
}
END_TEST

/* 12 % and 0.12 are the same; a scene is one with or without its prefix. How large a run is advised depends on times,
 * and with it how many show its error. */
START_TEST(ways_to_say_the_same)
{
    static const char *const ways[] = {"advise furnace --error 12% " TINY "--json - --threads 1",
                                       "advise scene:furnace --error 0.12 " TINY "--json - --threads 2"};
    json_t *const first = pm__expect_json(ways[0]), *const second = pm__expect_json(ways[1]);
    static const char *const fields[] = {"case", "error", "estimator", "method"};
    for (size_t f = 0; f < 4; f++)
        ck_assert_msg(json_equal(json_object_get(pm__item(first, "rows", 0), fields[f]),
                                 json_object_get(pm__item(second, "rows", 0), fields[f])),
                      "%s", fields[f]);
    ck_assert_str_eq(pm__text_of(pm__item(first, "rows", 0), "case"), "scene:furnace:albedo=0.5");
    json_decref(first);
    json_decref(second);
}
END_TEST

/* What --verify reached is what the printed command measures, to the last bit. */
START_TEST(the_command_does_what_verify_did)
{
    char command[1200];
    json_t *const root = pm__expect_json("advise gradient --error 10% --verify --seed 7 " TINY "--json -");
    json_t *const row = pm__item(root, "rows", 0);
    ck_assert_str_eq(pm__text_of(row, "status"), "ok");
    PM_CHECK_NEAR(pm__number_of(row, "ratio"), pm__number_of(row, "reached_rel_rmse") / 0.1, 1e-12);
    ck_assert_int_eq(strncmp(pm__text_of(row, "command"), "photonbench accuracy ", 21), 0);
    (void)snprintf(command, sizeof command, "%s --json -", pm__text_of(row, "command") + strlen("photonbench "));
    json_t *const again = pm__expect_json(command);
    json_t *const measured = pm__item(again, "rows", 0);
    ck_assert_str_eq(pm__text_of(measured, "region"), "all");
    ck_assert_double_eq(pm__number_of(measured, "rel_rmse"), pm__number_of(row, "reached_rel_rmse"));
    ck_assert(json_equal(json_object_get(measured, "rel_rmse_ci95"), json_object_get(row, "reached_rel_rmse_ci95")));
    json_decref(again);
    json_decref(root);
}
END_TEST

START_TEST(the_command_of_passes_does_so_too)
{
    char command[1200];
    json_t *const root = pm__expect_json(
        "advise furnace --error 30% --verify --method ppm --photons 60000 --seconds 1 --json -");
    json_t *const row = pm__item(root, "rows", 0);
    ck_assert(json_is_integer(json_object_get(row, "passes")));
    ck_assert_int_eq(strncmp(pm__text_of(row, "command"), "photonbench converge ", 21), 0);
    (void)snprintf(command, sizeof command, "%s --json -", pm__text_of(row, "command") + strlen("photonbench "));
    json_t *const again = pm__expect_json(command);
    json_t *const rows = json_object_get(again, "rows"), *const last = json_array_get(rows, json_array_size(rows) - 1);
    ck_assert_double_eq(pm__number_of(last, "rel_rmse"), pm__number_of(row, "reached_rel_rmse"));
    json_decref(again);
    json_decref(root);
}
END_TEST

/* What a method has not is not told, and not asked for by the command, which does the same all the same. */
START_TEST(methods_have_what_they_have)
{
    char command[1200];
    json_t *const root = pm__expect_json("advise furnace --error 20% --verify --method path,light "
                                         "--estimator disc,cone --photons 2000000 --seconds 1 --json -");
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 2);
    for (size_t i = 0; i < 2; i++) {
        json_t *const row = pm__item(root, "rows", i);
        const bool path = strcmp(pm__text_of(row, "method"), "path") == 0;
        ck_assert_str_eq(pm__text_of(row, "status"), "ok");
        ck_assert(pm__is_null(row, "estimator") && pm__is_null(row, "k") && pm__is_null(row, "photons") == path);
        ck_assert(strstr(pm__text_of(row, "command"), "--estimator") == NULL);
        ck_assert(strstr(pm__text_of(row, "command"), "--k") == NULL);
        ck_assert(strstr(pm__text_of(row, "command"), "--alpha") == NULL);
        ck_assert((strstr(pm__text_of(row, "command"), "--photons-per-pass") == NULL) == path);
    }
    json_t *const row = pm__item(root, "rows", 0);
    (void)snprintf(command, sizeof command, "%s --json -", pm__text_of(row, "command") + strlen("photonbench "));
    json_t *const again = pm__expect_json(command);
    json_t *const rows = json_object_get(again, "rows"), *const last = json_array_get(rows, json_array_size(rows) - 1);
    ck_assert_double_eq(pm__number_of(last, "rel_rmse"), pm__number_of(row, "reached_rel_rmse"));
    json_decref(again);
    json_decref(root);
}
END_TEST

/* A point light through glass is found by neither: no number of passes helps, and one shows it. */
START_TEST(what_passes_cannot_mend)
{
    const pm__run *const run = pm__expect("advise plate --error 5% --method path,light --seconds 1 --json -", 1,
                                          "out of reach");
    json_error_t error;
    json_t *const root = json_loads(run->out, 0, &error);
    ck_assert_ptr_nonnull(root);
    for (size_t i = 0; i < 2; i++) {
        json_t *const row = pm__item(root, "rows", i);
        ck_assert_str_eq(pm__text_of(row, "status"), "unreachable");
        ck_assert_double_eq(pm__number_of(row, "passes"), 1.0);
        ck_assert_ptr_nonnull(strstr(pm__text_of(row, "detail"), "every pass gives the same answer: "));
    }
    json_decref(root);
    const char *out = pm__expect("advise furnace --error 0.0001% --method pppm --seconds 0.5", 1, "out of reach")->out;
    ck_assert_ptr_nonnull(strstr(out, "after 1000000 passes, the most that are considered, "));
    out = pm__expect("advise furnace --error 1% --method pppm --seconds 0.5 --photons 20000", 1, "out of reach")->out;
    ck_assert_ptr_nonnull(strstr(out, "after 1 pass, the most that so few photons allow, "));
}
END_TEST

/* Maps are judged by an exact answer: without one they are not among the defaults. */
START_TEST(a_reference_alone)
{
    json_t *const root = pm__expect_json("advise lamp --error 60% --seconds 1 --json -");
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 1);
    ck_assert_str_eq(pm__text_of(pm__item(root, "rows", 0), "method"), "pppm");
    json_decref(root);
    (void)pm__expect("advise lamp:albedo=0.5 --error 20%", 2,
                     "advise: scene:lamp:albedo=0.5 has no exact answer, and the stored reference of scene:lamp is of "
                     "its defaults alone");
}
END_TEST

/* Nothing is smaller than one pass: better is well then. */
START_TEST(better_is_well_where_nothing_is_smaller)
{
    json_t *const root = pm__expect_json("advise furnace --error 50% --method pppm --verify --seconds 0.5 --json -");
    json_t *const row = pm__item(root, "rows", 0);
    ck_assert_double_lt(pm__number_of(row, "ratio"), 0.75);
    ck_assert_str_eq(pm__text_of(row, "status"), "ok");
    ck_assert_ptr_nonnull(strstr(pm__text_of(row, "detail"), "the least there is"));
    json_decref(root);
}
END_TEST

/* The check of so small an error takes minutes; what was known before is shown all the same. How long the pilots take
 * depends on the machine. */
START_TEST(interrupted_while_it_verifies)
{
    const pm__test_directory place = pm__test_directory_create();
    char json[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH], said[1000] = "", arguments[2 * PM__TEST_PATH];
    (void)snprintf(arguments, sizeof arguments, "advise furnace --error 0.2%% --method ppm --seconds 0.5 --verify "
                   "--json %s", pm__test_path(&place, "a.json", json));
    for (unsigned seconds = 2; seconds < 100 && !strstr(said, "the advice is not verified"); seconds *= 2) {
        const pid_t child = pm__start(arguments, pm__test_path(&place, "out", out), pm__test_path(&place, "err", err));
        (void)sleep(seconds);
        ck_assert_int_eq(kill(child, SIGINT), 0);
        ck_assert_int_eq(pm__wait(child), 130);
        ck_assert_int_gt(pm__test_read(err, said, sizeof said), 0);
        ck_assert_ptr_nonnull(strstr(said, "advise: interrupted: "));
    }
    json_t *const root = json_load_file(json, 0, NULL);
    ck_assert_ptr_nonnull(root);
    json_t *const row = pm__item(root, "rows", 0);
    ck_assert(json_is_true(json_object_get(root, "interrupted")));
    ck_assert_str_eq(pm__text_of(row, "status"), "interrupted");
    ck_assert_str_eq(pm__text_of(row, "detail"), "its verification was interrupted");
    ck_assert(json_is_true(json_object_get(row, "advised")));
    ck_assert(pm__is_null(row, "ratio") && pm__is_null(row, "reached_rel_rmse"));
    ck_assert_double_gt(pm__number_of(row, "passes"), 1000.0);
    ck_assert_int_gt(pm__test_read(out, said, sizeof said), 0);
    ck_assert_ptr_nonnull(strstr(said, "\n* ppm "));
    json_decref(root);
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(out_of_reach_says_what_is_not)
{
    const pm__run *const run =
        pm__expect("advise square --error 1% " TINY "--photons 2000 --json - --threads 2", 1, "out of reach");
    json_error_t error;
    json_t *const root = json_loads(run->out, 0, &error);
    ck_assert_ptr_nonnull(root);
    ck_assert_str_eq(pm__text_of(pm__item(root, "rows", 0), "status"), "unreachable");
    ck_assert(json_is_false(json_object_get(pm__item(root, "rows", 0), "advised")));
    ck_assert_double_gt(pm__number_of(pm__item(root, "rows", 0), "predicted_rel_rmse"), 0.01);
    ck_assert_uint_eq((size_t)pm__number_of(pm__item(root, "rows", 0), "photons"), 2000);
    json_decref(root);
}
END_TEST

START_TEST(screen_is_100_columns)
{
    const pm__run *const run = pm__expect("advise gradient --error 10% --verify " TINY "--quiet", 0, NULL);
    static const char *const parts[] = {"error 10 %", "\n* map ", "photonbench accuracy --case gradient",
                                        "within 25 %"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(run->out, parts[i]) != NULL, "no '%s' in %s", parts[i], run->out);
    for (const char *line = run->out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_msg(strcspn(line, "\n") <= 100, "%s", run->out);
}
END_TEST

START_TEST(refusals)
{
    (void)pm__expect("advise", 2, "--error is needed");
    (void)pm__expect("advise square", 2, "--error is needed");
    (void)pm__expect("advise --error 2%", 2, "a case or a scene is needed");
    (void)pm__expect("advise square --error 0", 2, "no error above 0");
    (void)pm__expect("advise square --error -2%", 2, "no error above 0");
    (void)pm__expect("advise square --error 100%", 2, "below 1");
    (void)pm__expect("advise square --error 2", 2, "such as 2% or 0.02");
    (void)pm__expect("advise square --error nan", 2, "no error above 0");
    (void)pm__expect("advise square --error %", 2, "no error above 0");
    (void)pm__expect("advise squar --error 2%", 2, "did you mean 'square'");
    (void)pm__expect("advise glas-sphere --error 2%", 2, "did you mean 'glass-sphere'");
    (void)pm__expect("advise scene:glas-sphere --error 2%", 2, "did you mean 'scene:glass-sphere'");
    (void)pm__expect("advise qqqqqqqq --error 2%", 2, "'photonbench list scenes' show them");
    (void)pm__expect("advise all --error 2%", 2, "one case or scene at a time");
    (void)pm__expect("advise square,edge --error 2%", 2, "one case or scene at a time");
    (void)pm__expect("advise square --error 2% --method mapp", 2, "did you mean 'map'");
    (void)pm__expect("advise square --error 2% --method pppm", 2, "takes a scene");
    (void)pm__expect("advise square --error 2% --estimator disk", 2, "did you mean 'disc'");
    (void)pm__expect("advise square --error 2% --photons 50", 2, "too few to learn from");
    (void)pm__expect("advise cornell --error 2% --method map", 2, "no exact answer, which maps are judged by");
    (void)pm__expect("advise gradient --error 20% " TINY "--quiet --json /dev/full -o /dev/null", 4, "full");
}
END_TEST

PM_TEST_MAIN("cli advise", fields_are_the_contract, ways_to_say_the_same, the_command_does_what_verify_did,
             the_command_of_passes_does_so_too, methods_have_what_they_have, what_passes_cannot_mend,
             a_reference_alone, better_is_well_where_nothing_is_smaller, interrupted_while_it_verifies,
             out_of_reach_says_what_is_not, screen_is_100_columns, refusals)
