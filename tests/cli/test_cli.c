/* The program as a whole: commands, help, lists, usage errors, standard output that fails. */
#include "../../estimators/estimator.h"
#include "../program.h"

#include <sys/stat.h>

START_TEST(version)
{
    ck_assert_str_eq(pm__expect("--version", 0, NULL)->out, "photonbench 0.1.0\n");
}
END_TEST

START_TEST(overview)
{
    const char *const out = pm__expect("help", 0, NULL)->out;
    const char *const names[] = {"accuracy", "search",  "speed", "render", "converge", "advise",
                                 "estimate", "compare", "report", "list",  "help"};
    char line[64];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)snprintf(line, sizeof line, "\n  %s ", names[i]);
        ck_assert_msg(strstr(out, line) != NULL, "no %s in: %s", names[i], out);
    }
    char *const copy = strdup(out);
    ck_assert_str_eq(pm__expect("--help", 0, NULL)->out, copy);
    free(copy);
    ck_assert_str_eq(pm__expect("", 2, "Usage: photonbench")->out, "");
}
END_TEST

/* Lines fit the screen. */
static void check_width(const char *text)
{
    for (const char *line = text; *line;) {
        const size_t length = strcspn(line, "\n");
        ck_assert_msg(length <= 100, "%zu columns: %.*s", length, (int)length, line);
        line += length + (line[length] == '\n');
    }
}

START_TEST(help_of_commands)
{
    const char *const names[] = {"accuracy", "search",  "speed", "render", "converge", "advise",
                                 "estimate", "compare", "report", "list",  "help"};
    char arguments[64];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        (void)snprintf(arguments, sizeof arguments, "help %s", names[i]);
        char *const text = strdup(pm__expect(arguments, 0, NULL)->out);
        ck_assert_ptr_nonnull(strstr(text, "Usage: photonbench "));
        ck_assert_ptr_nonnull(strstr(text, "Example"));
        check_width(text);
        (void)snprintf(arguments, sizeof arguments, "%s --help", names[i]);
        ck_assert_str_eq(pm__expect(arguments, 0, NULL)->out, text);
        free(text);
    }
}
END_TEST

START_TEST(list_of_everything)
{
    const char *const out = pm__expect("list", 0, NULL)->out;
    const char *const parts[] = {"Estimators", "Searches",         "Cases",           "Samplers",
                                 "\n  disc ",  "\n  point-light ", "\n  brute ",      "\n  sobol ",
                                 "k=1.1 (",    "full|half|none",   "region interior:", "Methods",
                                 "\n  visualize ", "Methods of render   render --method ",
                                 "Methods of converge   converge --method ", "\n  ppm "};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(out, parts[i]) != NULL, "no '%s' in: %.2000s", parts[i], out);
    check_width(out);
}
END_TEST

/* Which scenes have an exact answer, and of what light. */
START_TEST(list_of_scenes)
{
    const char *const out = pm__expect("list scenes", 0, NULL)->out;
    const char *const parts[] = {"Scenes   --case scene:NAME", "\n  scene:furnace ",
                                 "exact answer: of light paths LSSD: for accuracy, converge and advise\n",
                                 "its defaults have a stored\n",
                                 "   reference of 128x128: for converge and advise too\n"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(out, parts[i]) != NULL, "no '%s' in: %.2000s", parts[i], out);
    check_width(out);
}
END_TEST

/* By what methods can be judged there: an exact answer, or else a reference. */
START_TEST(list_of_scenes_as_json)
{
    json_t *const root = pm__expect_json("list scenes --json -"), *row;
    size_t i, references = 0;
    json_array_foreach(json_object_get(root, "rows"), i, row) {
        const char *const name = json_string_value(json_object_get(row, "name"));
        const json_t *const reference = json_object_get(row, "reference");
        pm__check_keys(row, "kind name summary citation parameters paths regions reference");
        if (json_is_string(json_object_get(row, "paths")))
            ck_assert(json_is_null(reference));
        if (strcmp(name, "scene:cornell") == 0)
            ck_assert_str_eq(json_string_value(reference), "128x128");
        if (strcmp(name, "scene:torus") == 0)
            ck_assert_str_eq(json_string_value(reference), "32x32");
        references += json_is_string(reference);
    }
    ck_assert_uint_ge(references, 2);
    json_decref(root);
}
END_TEST

START_TEST(list_as_json)
{
    json_t *const root = pm__expect_json("list estimators --json -");
    pm__check_keys(root, "schema command version options seed machine wall_s rows");
    ck_assert_str_eq(json_string_value(json_object_get(root, "schema")), "photonbench/1");
    json_t *const rows = json_object_get(root, "rows");
    ck_assert_uint_eq(json_array_size(rows), pm__estimators.count);
    json_t *const cone = json_array_get(rows, 1);
    ck_assert_str_eq(json_string_value(json_object_get(cone, "kind")), "estimator");
    ck_assert_str_eq(json_string_value(json_object_get(cone, "name")), "cone");
    json_t *const k = json_array_get(json_object_get(cone, "parameters"), 0);
    pm__check_keys(k, "name type default unit min max choices help");
    ck_assert(json_real_value(json_object_get(k, "default")) == 1.1);
    json_decref(root);
}
END_TEST

START_TEST(list_as_tables)
{
    ck_assert_ptr_nonnull(strstr(pm__expect("list searches --csv -", 0, NULL)->out,
                                 "kind,name,summary,citation,parameters\nsearch,wide,"));
    ck_assert_ptr_nonnull(strstr(pm__expect("list searches --markdown -", 0, NULL)->out,
                                 "| kind | name | summary | citation | parameters |\n|---|---|---|---|---|\n"));
}
END_TEST

static const struct {
    const char *arguments, *message;
} usage_errors[] = {
    {"acuracy", "unknown command 'acuracy'; did you mean 'accuracy'?"},
    {"rendre", "unknown command 'rendre'; did you mean 'render'?"},
    {"--verison", "did you mean '--version'?"},
    {"help acuracy", "did you mean 'accuracy'?"},
    {"list estimator", "did you mean 'estimators'?"},
    {"list method", "did you mean 'methods'?"},
    {"list estimators cases", "unexpected argument 'cases'"},
    {"accuracy --estimater disc", "unknown option '--estimater'; did you mean '--estimator'?"},
    {"accuracy --seconds 5", "unknown option '--seconds'"},
    {"accuracy --pro quick", "option '--pro' is ambiguous: it could be --probes, --profile"},
    {"accuracy --quiet=3", "option '--quiet' takes no value"},
    {"accuracy --json", "option '--json' needs a value"},
    {"accuracy -x", "unknown option '-x'"},
    {"accuracy square", "unexpected argument 'square'"},
    {"accuracy --estimator dsic", "--estimator: unknown estimator 'dsic'; did you mean 'disc'?"},
    {"accuracy --case sqare", "--case: unknown case 'sqare'; did you mean 'square'?"},
    {"accuracy --case sinusoid:cycels=3", "did you mean 'cycles'?"},
    {"accuracy --sampler poison", "did you mean 'poisson'?"},
    {"accuracy --search bruce", "did you mean 'brute'?"},
    {"accuracy --estimator cone:k=-1", "cone: k=-1: expected a number from"},
    {"accuracy --estimator disc:last=most", "expected one of full|half|none"},
    {"accuracy --estimator last=full,disc", "'last=full' follows no estimator"},
    {"accuracy --k 0", "--k: '0' is not an integer from 1 to 1073741823"},
    {"accuracy --k 15,,50", "--k: '' is not an integer"},
    {"accuracy --k 1.5", "--k: '1.5' is not an integer"},
    {"accuracy --k 15x", "--k: '15x' is not an integer"},
    {"accuracy --k -3", "--k: '-3' is not an integer"},
    {"accuracy --trials 1", "--trials: '1' is not an integer from 2"},
    {"accuracy --seed 18446744073709551616", "--seed: '18446744073709551616' is not an integer"},
    {"accuracy --seed -1", "--seed: '-1' is not an integer"},
    {"accuracy --threads 0", "--threads: '0' is not an integer from 1"},
    {"accuracy --photons 0", "--photons: '0' is not an integer from 1"},
    {"accuracy --radius 0", "--radius: '0' is neither"},
    {"accuracy --radius automatic", "--radius: 'automatic' is neither"},
    {"accuracy --radius auto:nan", "--radius: 'nan' is not a number above 0"},
    {"accuracy --lookup cube", "--lookup: 'cube': expected sphere"},
    {"accuracy --lookup ellipsoid:0.5", "S from 1"},
    {"accuracy --lookup disc:0", "H above 0"},
    {"accuracy --front maybe", "--front: 'maybe': expected on or off"},
    {"accuracy --profile slow", "--profile: 'slow': expected full or quick"},
    {"accuracy --k 101 --photons 100", "--k 101 is more than --photons 100"},
    {"accuracy --photons 100", "--k 200 (the default) is more than --photons 100"},
    {"accuracy --case square --estimator hull --k 2 --photons 100 --trials 2 --probes 1",
     "--k 2 is too few for --estimator hull"},
    /* Samplers that round: told before the cases that would do are measured. */
    {"accuracy --case wall,square --sampler poisson,stratified --photons 50 --k 50 --trials 1000000 --estimator disc",
     "--k 50 is more than the 49 photons that --sampler stratified draws for --photons 50 in case"},
    {"accuracy --case square --sampler stratified --photons 88 --k 88 --trials 1000000 --estimator "
     "combined:deal=separate",
     "--k 88 asks each map of --estimator combined:deal=separate for 22 photons; it has the 20 that"},
    {"accuracy --case square --search grid", "--search grid finds all within a fixed radius"},
    {"accuracy --case square --search grid --radius 0.1 --k 5", "--search grid finds all within a fixed radius"},
    {"accuracy --json - --csv -", "--json and --csv both write to '-'"},
    {"estimate --queries q.ply", "--photons FILE is needed"},
    {"estimate --photons p.ply", "--queries FILE is needed"},
    {"estimate --photons p.ply --queries q.ply --estimator disc,cone", "one estimator at a time"},
    {"estimate --photons p.ply --queries q.ply --estimator oracle", "needs the truth"},
    {"estimate --photons p.ply --queries q.ply --estimator combined:deal=separate", "deal=separate wants"},
    {"estimate --photons p.ply --queries q.ply --estimator hull --k 2", "--k 2 is too few"},
    {"estimate --photons p.ply --queries q.ply --search grid", "--search grid finds all within a fixed radius"},
    {"estimate --photons p.ply --queries q.ply --trials 5", "unknown option '--trials'"},
};

START_TEST(every_usage_error)
{
    for (size_t i = 0; i < sizeof usage_errors / sizeof *usage_errors; i++)
        ck_assert_str_eq(pm__expect(usage_errors[i].arguments, 2, usage_errors[i].message)->out, "");
}
END_TEST

/* Standard output on a full disk, or closed. */
START_TEST(standard_output_fails)
{
    const char *const commands[] = {"list", "list --json -", "--version", "help", "help list"};
    const pm__test_directory place = pm__test_directory_create();
    char err[PM__TEST_PATH], text[1000];
    (void)pm__test_path(&place, "err", err);
    for (size_t i = 0; i < sizeof commands / sizeof *commands; i++) {
        ck_assert_int_eq(pm__wait(pm__start(commands[i], "/dev/full", err)), 4);
        ck_assert_int_gt(pm__test_read(err, text, sizeof text), 0);
        ck_assert_msg(strstr(text, "standard output: No space left on device") != NULL, "%s: %s", commands[i], text);
    }
    /* Closed: the file must not take its place. */
    char json[PM__TEST_PATH], arguments[PM__TEST_PATH + 40];
    (void)snprintf(arguments, sizeof arguments, "list --json %s", pm__test_path(&place, "a.json", json));
    const pid_t child = fork();
    if (child == 0) {
        pm__redirect(STDERR_FILENO, err);
        (void)close(STDOUT_FILENO);
        pm__exec(arguments);
    }
    ck_assert_int_eq(pm__wait(child), 4);
    json_t *const root = json_load_file(json, 0, NULL);
    ck_assert_ptr_nonnull(root);
    json_decref(root);
    pm__test_directory_remove(&place);
}
END_TEST

/* One file by two paths, whether it is there or not; two files of one name are two. */
START_TEST(one_file_by_two_paths)
{
    static const char *const names[][2] = {{"a", "./a"}, {"sub/a", "sub/../sub/a"}, {"a", "sub/../a"}, {"link", "a"}};
    const pm__test_directory place = pm__test_directory_create();
    char path[PM__TEST_PATH], target[PM__TEST_PATH], line[3 * PM__TEST_PATH];
    ck_assert_int_eq(mkdir(pm__test_path(&place, "sub", path), 0700), 0);
    for (int there = 0; there < 2; there++) {
        for (size_t i = 0; i < 3 + (size_t)there; i++) {
            (void)snprintf(line, sizeof line, "list --json %s/%s -o %s/%s", place.path, names[i][0], place.path,
                           names[i][1]);
            (void)pm__expect(line, 2, "--json and -o both write to");
        }
        (void)snprintf(line, sizeof line, "list --json %s/a -o %s/sub/a", place.path, place.path);
        (void)pm__expect(line, 0, NULL);
        if (!there)
            ck_assert_int_eq(symlink(pm__test_path(&place, "a", target), pm__test_path(&place, "link", path)), 0);
    }
    (void)pm__expect("list --json /dev/null -o /dev/null", 0, NULL);
    (void)pm__expect("list --json /nonexistent/a -o /nonexistent/./a", 4, "/nonexistent/");
    (void)unlink(path);
    (void)unlink(target);
    (void)unlink(pm__test_path(&place, "sub/a", path));
    ck_assert_int_eq(rmdir(pm__test_path(&place, "sub", path)), 0);
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(output_file)
{
    const pm__test_directory place = pm__test_directory_create();
    char path[PM__TEST_PATH], arguments[PM__TEST_PATH + 40];
    static char text[1 << 16];
    (void)pm__test_path(&place, "list.txt", path);
    (void)snprintf(arguments, sizeof arguments, "list searches -o %s", path);
    ck_assert_str_eq(pm__expect(arguments, 0, NULL)->out, "");
    ck_assert_int_gt(pm__test_read(path, text, sizeof text), 0);
    ck_assert_str_eq(pm__expect("list searches", 0, NULL)->out, text);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    (void)pm__expect("list --json /dev/full", 4, "/dev/full: cannot be written: No space left on device");
    (void)pm__expect("list --json /nonexistent/list.json", 4, "/nonexistent/list.json: cannot be opened");
    pm__test_directory_remove(&place);
}
END_TEST

PM_TEST_MAIN("cli", version, overview, help_of_commands, list_of_everything, list_of_scenes, list_of_scenes_as_json,
             list_as_json, list_as_tables, every_usage_error, standard_output_fails, one_file_by_two_paths,
             output_file)
