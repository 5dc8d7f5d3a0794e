/* report as a script sees it: the page holds what the files hold, whatever they hold, and is complete or absent. */
#include "../report.h"

#include <sys/stat.h>

static void check_refused(const char *words, int status, const char *part)
{
    (void)pm__expect(line_of(words), status, part);
    ck_assert_msg(!exists("out/index.html"), "a page after: %s", words);
}

START_TEST(page_holds_the_files)
{
    setup();
    static const char text[] = HEAD "\"accuracy\",\"version\":\"0\",\n \"commit\":\"abc123\",\"rows\":[{\"case\":"
                                    "\"square\",\"k\":5,\"rel_bias\":0.1000000000000000055511151231257827}]}\n";
    write_text("a.json", text);
    const pm__run *const run = pm__expect(line_of("@a.json -o @out"), 0, NULL);
    ck_assert_ptr_nonnull(strstr(run->out, "/out/index.html: 1 result file, 0 images\n"));
    ck_assert_ptr_nonnull(strstr(run->out, "missing: no result file of `search` was given; photonbench search"));
    json_t *const root = read_page("out/index.html");
    pm__check_keys(root, "schema version commit date files images errata missing");
    ck_assert_str_eq(pm__text_of(root, "schema"), "photonbench-report/1");
    ck_assert_str_eq(pm__text_of(root, "commit"), "abc123");
    ck_assert_str_eq(pm__text_of(root, "date"), "2001-09-09T01:46:40Z");
    json_t *const given = json_loads(text, 0, NULL), *const file = pm__item(root, "files", 0);
    ck_assert_str_eq(pm__text_of(file, "name"), "a.json");
    ck_assert(json_equal(given, json_object_get(file, "result")));
    json_decref(given);
    json_decref(root);
    ck_assert_ptr_nonnull(strstr(page, "0.1000000000000000055511151231257827")); /* not one digit less */
    ck_assert_str_eq(pm__expect(line_of("@a.json -o @out --quiet"), 0, NULL)->out, "");
    teardown();
}
END_TEST

/* Text of a file, be it what ends a script, comments or quotes, is text in the page. */
START_TEST(hostile_texts_are_texts)
{
    setup();
    static const char hostile[] = "</script><!--PM-DATA-->\\n<!--PM-DATA-->\\n<script>\\\"'&amp;\\u003c\xc3\xa9";
    char text[1000];
    (void)snprintf(text, sizeof text, HEAD "\"%s\",\"%s\":1,\"rows\":[{\"case\":\"%s\"}]}", hostile, hostile, hostile);
    write_text("a.json", text);
    write_text("b<b>.json", text);
    (void)pm__expect(line_of("@a.json @b<b>.json -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html"), *const given = json_loads(text, 0, NULL);
    ck_assert_uint_eq(pm__items(root, "files"), 2);
    ck_assert(json_equal(given, json_object_get(pm__item(root, "files", 0), "result")));
    ck_assert_str_eq(pm__text_of(pm__item(root, "files", 1), "name"), "b<b>.json");
    json_decref(given);
    json_decref(root);
    const char *const start = strstr(page, SCRIPT) + sizeof SCRIPT - 1;
    ck_assert_ptr_null(strchr(start, '<')); /* read_page cut the page at the script's end */
    teardown();
}
END_TEST

START_TEST(missing_parts_are_named)
{
    setup();
    static const char *const parts[] = {"accuracy", "search", "storage", "converge", "stress"};
    char text[200], words[400] = "";
    for (size_t i = 0; i < 5; i++) {
        (void)snprintf(text, sizeof text, HEAD "\"%s\",\"rows\":[%s]}", parts[i], i == 4 ? "" : "{}");
        (void)snprintf(words + strlen(words), sizeof words - strlen(words), "@%s.json ", parts[i]);
        char name[40];
        (void)snprintf(name, sizeof name, "%s.json", parts[i]);
        write_text(name, text);
    }
    write_image("x.exr", 4, 4);
    (void)snprintf(words + strlen(words), sizeof words - strlen(words), "@x.exr -o @out");
    (void)pm__expect(line_of(words), 0, NULL);
    json_t *root = read_page("out/index.html");
    ck_assert_uint_eq(pm__items(root, "missing"), 1);
    ck_assert_str_eq(pm__text_of(pm__item(root, "missing", 0), "part"), "stress");
    ck_assert_str_eq(pm__text_of(pm__item(root, "missing", 0), "what"), "the result file of `stress` has no rows");
    json_decref(root);
    (void)pm__expect(line_of("@stress.json -o @out"), 0, NULL);
    root = read_page("out/index.html");
    ck_assert_uint_eq(pm__items(root, "missing"), 6);
    for (size_t i = 0; i < 6; i++) {
        const json_t *const part = pm__item(root, "missing", i);
        ck_assert_ptr_eq(strstr(pm__text_of(part, "how"), "photonbench "), pm__text_of(part, "how"));
    }
    ck_assert_str_eq(pm__text_of(pm__item(root, "missing", 5), "what"), "no image was given");
    json_decref(root);
    teardown();
}
END_TEST

/* Of thousands of rows that pass the worst of each test and estimator stays, and all that fail. */
START_TEST(long_stress_is_condensed)
{
    setup();
    static char text[1 << 20];
    size_t used = (size_t)snprintf(text, sizeof text, HEAD "\"stress\",\"rows\":[");
    for (int i = 0; i < 4000; i++)
        used += (size_t)snprintf(text + used, sizeof text - used,
                                 "%s{\"test\":\"ties\",\"subject\":\"%s wide\",\"status\":\"%s\",\"measured\":%d.1,"
                                 "\"bound\":5000,\"unit\":\"ulp\"}", i ? "," : "", i % 2 ? "disc" : "hull",
                                 i == 17 ? "fail" : "pass", (i * 7) % 4000);
    (void)snprintf(text + used, sizeof text - used, "]}");
    write_text("a.json", text);
    (void)pm__expect(line_of("@a.json -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html"), *const file = pm__item(root, "files", 0);
    json_t *const result = json_object_get(file, "result");
    ck_assert_int_eq((int)pm__number_of(file, "left_out"), 3997);
    ck_assert_uint_eq(pm__items(result, "rows"), 3);
    ck_assert_str_eq(pm__text_of(pm__item(result, "rows", 0), "status"), "fail");
    ck_assert_double_eq(pm__number_of(pm__item(result, "rows", 1), "measured"), 3998.1);
    ck_assert_double_eq(pm__number_of(pm__item(result, "rows", 2), "measured"), 3999.1);
    json_decref(root);
    teardown();
}
END_TEST

/* The commands that `missing` names are commands: each option is one that help shows. */
START_TEST(ways_out_are_options)
{
    setup();
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    (void)pm__expect(line_of("@a.json -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html");
    for (size_t i = 0; i < 6; i++) {
        char how[300], help[40];
        (void)snprintf(how, sizeof how, "%s", pm__text_of(pm__item(root, "missing", i), "how"));
        (void)snprintf(help, sizeof help, "help %.20s", strtok(how, " ") ? strtok(NULL, " ") : "");
        const char *const shown = pm__expect(help, 0, NULL)->out;
        for (const char *word; (word = strtok(NULL, " ")) != NULL;)
            ck_assert_msg(word[0] != '-' || word[1] != '-' || strstr(shown, word), "%s: no %s", help, word);
    }
    json_decref(root);
    teardown();
}
END_TEST

START_TEST(usage)
{
    setup();
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    write_image("i.exr", 4, 4);
    ck_assert_int_eq(mkdir(path_of("sub"), 0700), 0);
    write_image("sub/i.exr", 4, 4);
    check_refused("-o @out", 2, "result files are needed");
    check_refused("@a.json", 2, "-o DIR is needed");
    check_refused("@a.json -o -", 2, "not standard output");
    check_refused("@i.exr -o @out", 2, "a result file is needed besides images");
    check_refused("@a.json @i.exr @sub/i.exr -o @out", 2, "two images are called i.exr");
    check_refused("@a.json -o @out --json x", 2, "unknown option '--json'");
    ck_assert_int_eq(setenv("SOURCE_DATE_EPOCH", "soon", 1), 0);
    check_refused("@a.json -o @out", 2, "SOURCE_DATE_EPOCH: 'soon' is not a number of seconds");
    teardown();
}
END_TEST

START_TEST(hostile_files)
{
    setup();
    static const struct {
        const char *text, *part;
    } files[] = {{"", "bad.json: expected a result file (JSON) or an OpenEXR image, found nothing"},
                 {" \n[]", "bad.json: byte 2: expected {"},
                 {"{\n\"schema\": }", "bad.json: line 2, byte 13: expected JSON"},
                 {"{}", "bad.json: schema: expected \"photonbench/1\", not nothing"},
                 {"{\"schema\":\"photonbench/2\"}", "schema: expected \"photonbench/1\", not \"photonbench/2\""},
                 {"{\"schema\":\"photonbench/1\"}", "bad.json: command: expected text, not nothing"},
                 {HEAD "\"x\"}", "bad.json: rows: expected an array, not nothing"},
                 {HEAD "\"x\",\"rows\":[{},7]}", "bad.json: rows[1]: expected an object, not a number"},
                 {HEAD "\"x\",\"rows\":[],\"fits\":[[]]}", "bad.json: fits[0]: expected an object, not an array"},
                 {HEAD "\"x\",\"rows\":[],\"rows\":[]}", "expected JSON: duplicate"},
                 {HEAD "\"x\",\"rows\":[1e999]}", "expected JSON"},
                 {HEAD "\"x\xff\",\"rows\":[]}", "expected JSON"},
                 {HEAD "\"x\",\"rows\":[]} {}", "expected JSON"},
                 {"v/1\001", "bad.json: expected"}};
    write_text("good.json", HEAD "\"x\",\"rows\":[]}");
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        write_text("bad.json", files[i].text);
        check_refused("@good.json @bad.json -o @out", 3, files[i].part);
    }
    check_refused("@good.json @none.json -o @out", 3, "none.json: cannot be read: No such file");
    check_refused("/dev/zero -o @out", 3, "/dev/zero: byte 0: expected {");
    check_refused("/ -o @out", 3, "/: cannot be read: Is a directory");
    ck_assert(!exists("out"));
    teardown();
}
END_TEST

/* The page that was there stays where a new one cannot be made. */
START_TEST(complete_or_absent)
{
    setup();
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    write_text("file", "");
    check_refused("@a.json -o @file", 4, "file: the folder cannot be made: Not a directory");
    check_refused("@a.json -o @file/out", 4, "cannot be made: Not a directory");
    check_refused("@a.json -o /proc/none", 4, "/proc/none: the folder cannot be made");
    (void)pm__expect(line_of("@a.json -o @deep/in/there/"), 0, NULL);
    ck_assert(exists("deep/in/there/index.html"));
    ck_assert_int_eq(mkdir(path_of("full"), 0700), 0);
    ck_assert_int_eq(symlink("/dev/full", path_of("full/index.html")), 0);
    (void)pm__expect(line_of("@a.json -o @full"), 4, "No space left on device");
    write_text("bad.json", "{");
    (void)pm__expect(line_of("@a.json @bad.json -o @deep/in/there"), 3, "expected JSON");
    json_decref(read_page("deep/in/there/index.html"));
    teardown();
}
END_TEST

/* The same files give the same page. */
START_TEST(same_page)
{
    setup();
    static char first[PAGE_SIZE];
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    write_image("i.exr", 20, 20);
    (void)pm__expect(line_of("@a.json @i.exr -o @out"), 0, NULL);
    const long count = pm__test_read(path_of("out/index.html"), first, sizeof first);
    (void)pm__expect(line_of("@a.json @i.exr -o @out"), 0, NULL);
    ck_assert_int_eq(pm__test_read(path_of("out/index.html"), page, sizeof page), count);
    ck_assert_int_eq(memcmp(first, page, (size_t)count), 0);
    teardown();
}
END_TEST

/* Tables of points: a block a series, what cannot be on a logarithmic axis left out, no text that gnuplot would run. */
START_TEST(figures_have_their_points)
{
    setup();
    static char text[1 << 16];
    write_text("a.json", HEAD "\"accuracy\",\"rows\":["
               "{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"disc:last=full\",\"k\":50,\"rel_rmse\":0.2,"
               "\"rel_rmse_ci95\":[0.1,0.3],\"cost_s\":0.5},"
               "{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"disc:last=full\",\"k\":5,\"rel_rmse\":0.4,"
               "\"rel_rmse_ci95\":null,\"cost_s\":0.25},"
               "{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"o'; system 'x\",\"k\":5,"
               "\"rel_rmse\":1,\"cost_s\":1},"
               "{\"case\":\"square\",\"region\":\"edge\",\"estimator\":\"hull\",\"k\":5,\"rel_rmse\":1,\"cost_s\":1},"
               "{\"case\":\"square\",\"region\":\"all\",\"estimator\":\"zero\",\"k\":5,\"rel_rmse\":0,\"cost_s\":1}]}");
    pm__run_program(line_of("@a.json -o @out --figures @fig"));
    ck_assert_int_eq(pm__last_run.status, 0);
    ck_assert_int_gt(pm__test_read(path_of("fig/front.csv"), text, sizeof text), 0);
    ck_assert_str_eq(text, "\"disc\",y,low,high,\"square\"\n0.25,0.4,0.4,0.4\n0.5,0.2,0.1,0.3\n\n\n"
                           "\"o-; system -x\",y,low,high,\"square\"\n1,1,1,1\n");
    ck_assert_int_gt(pm__test_read(path_of("fig/front.gp"), text, sizeof text), 0);
    ck_assert_ptr_eq(strstr(text, "data = 'front.csv'\npanels = 1\narray titles[1]\narray last[1]\narray style[2]\n"
                                  "style[1] = 1\nstyle[2] = 2\ntitles[1] = 'square'\nlast[1] = 1\n"), text);
    ck_assert(exists("fig/rmse.csv") && !exists("fig/search.csv") && !exists("fig/converge.gp"));
    if (system("command -v gnuplot >/dev/null") == 0) {
        ck_assert_int_gt(pm__test_read(path_of("fig/front.svg"), text, sizeof text), 1000);
        ck_assert_ptr_nonnull(strstr(text, "<svg"));
        ck_assert_int_gt(pm__test_read(path_of("fig/rmse.pdf"), text, sizeof text), 1000);
        ck_assert_ptr_eq(strstr(text, "%PDF"), text);
        ck_assert_str_eq(pm__last_run.err, "");
    } else {
        ck_assert_ptr_nonnull(strstr(pm__last_run.err, "gnuplot is not installed (Debian: gnuplot-nox)"));
        (void)puts("SKIP: no gnuplot");
    }
    char *const before = strdup(getenv("PATH"));
    ck_assert_int_eq(setenv("PATH", "/nowhere", 1), 0);
    (void)pm__expect(line_of("@a.json -o @out --figures @other"), 0, "gnuplot is not installed");
    ck_assert_int_eq(setenv("PATH", before, 1), 0);
    free(before);
    ck_assert(exists("other/front.gp") && !exists("other/front.svg"));
    teardown();
}
END_TEST

PM_TEST_MAIN("cli report", page_holds_the_files, hostile_texts_are_texts, missing_parts_are_named,
             long_stress_is_condensed, ways_out_are_options, usage, hostile_files, complete_or_absent, same_page,
             figures_have_their_points)
