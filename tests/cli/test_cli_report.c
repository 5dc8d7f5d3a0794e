/* report as a script sees it: the page holds what the files hold, whatever they hold, and is complete or absent. */
#include "../../src/image/image.h"
#include "../exr.h"
#include "../program.h"
#include "../rows.h"

#include <sys/stat.h>

enum { PAGE_SIZE = 1 << 24 };

#define HEAD "{\"schema\":\"photonbench/1\",\"command\":"
#define SCRIPT "<script type=\"application/json\" id=\"pm-report\">"

static pm__test_directory place;
static char page[PAGE_SIZE];

static void setup(void)
{
    place = pm__test_directory_create();
    ck_assert_int_eq(setenv("SOURCE_DATE_EPOCH", "1000000000", 1), 0);
}

static void teardown(void)
{
    char command[2 * PM__TEST_PATH];
    (void)snprintf(command, sizeof command, "rm -rf '%s'", place.path);
    ck_assert_int_eq(system(command), 0);
}

static const char *path_of(const char *name)
{
    static char path[PM__TEST_PATH];
    return pm__test_path(&place, name, path);
}

static void write_text(const char *name, const char *text)
{
    pm__test_write(path_of(name), text, strlen(text));
}

/* "report" with the words, @ standing for the folder. */
static const char *line_of(const char *words)
{
    static char line[4096];
    size_t used = (size_t)snprintf(line, sizeof line, "report ");
    for (; *words && used < sizeof line; words++)
        if (*words == '@')
            used += (size_t)snprintf(line + used, sizeof line - used, "%s/", place.path);
        else
            used += (size_t)snprintf(line + used, sizeof line - used, "%c", *words);
    ck_assert_uint_lt(used, sizeof line);
    return line;
}

/* The data of a page; the caller's. */
static json_t *read_page(const char *name)
{
    ck_assert_int_gt(pm__test_read(path_of(name), page, sizeof page), 0);
    char *const start = strstr(page, SCRIPT);
    ck_assert_ptr_nonnull(start);
    ck_assert_ptr_null(strstr(start + 1, SCRIPT));
    ck_assert_ptr_null(strstr(page, "<!--PM-DATA-->"));
    char *const end = strstr(start, "</script>");
    ck_assert_ptr_nonnull(end);
    *end = '\0';
    json_error_t error;
    json_t *const root = json_loads(start + sizeof SCRIPT - 1, JSON_REJECT_DUPLICATES, &error);
    ck_assert_msg(root != NULL, "line %d: %s", error.line, error.text);
    return root;
}

static bool exists(const char *name)
{
    return access(path_of(name), F_OK) == 0;
}

static void check_refused(const char *words, int status, const char *part)
{
    (void)pm__expect(line_of(words), status, part);
    ck_assert_msg(!exists("out/index.html"), "a page after: %s", words);
}

static void write_image(const char *name, int width, int height)
{
    write_sample(path_of(name), &(sample_exr){.channels = "BGR", .type = EXR_PIXEL_FLOAT,
                                              .compression = EXR_COMPRESSION_ZIP, .width = width, .height = height});
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

static size_t base64_bytes(const char *text, unsigned char *bytes)
{
    static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    size_t count = 0;
    unsigned bits = 0;
    int held = 0;
    for (; *text && *text != '='; text++) {
        ck_assert_ptr_nonnull(strchr(digits, *text));
        bits = bits << 6 | (unsigned)(strchr(digits, *text) - digits);
        held += 6;
        if (held >= 8) {
            held -= 8;
            bytes[count++] = (unsigned char)(bits >> held & 255);
        }
    }
    return count;
}

/* An image of the page, decoded into a file. */
static void unpack(const json_t *image, const char *name)
{
    static unsigned char bytes[1 << 20];
    const char *const text = pm__text_of(image, "exr");
    ck_assert_uint_gt(strlen(text), 100);
    ck_assert_uint_lt(strlen(text), sizeof bytes);
    ck_assert_uint_eq(strlen(text) % 4, 0);
    pm__test_write(path_of(name), bytes, base64_bytes(text, bytes));
}

/* The mean over a block of 3 x 3 of samples, the image's edge cutting it off. */
static double mean_of_samples(char channel, int column, int row, int width, int height)
{
    double sum = 0.0;
    int count = 0;
    for (int y = 3 * row; y < 3 * row + 3 && y < height; y++)
        for (int x = 3 * column; x < 3 * column + 3 && x < width; x++, count++)
            sum += sample_value(channel, x, y);
    return sum / count;
}

static void check_means(const char *name)
{
    static const int places[][2] = {{0, 0}, {171, 0}, {5, 99}, {171, 99}};
    pm__image image;
    ck_assert_int_eq(pm__exr_read(path_of(name), &image, NULL), PM_OK);
    for (size_t i = 0; i < 4; i++)
        for (int c = 0; c < 3; c++) {
            const double want = mean_of_samples("RGB"[c], places[i][0], places[i][1], 515, 300);
            PM_CHECK_NEAR((double)image.values[(places[i][1] * 172 + places[i][0]) * 3 + c], want, want / 2048.0);
        }
    pm__image_free(&image);
}

START_TEST(images_are_reduced_and_told)
{
    setup();
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    write_image("b.truth.exr", 515, 300); /* blocks of 3 x 3; the last columns are of 2 */
    write_image("big", 256, 257);
    write_image("c.exr", 7, 5);
    (void)pm__expect(line_of("@a.json @b.truth.exr @big @c.exr -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html");
    ck_assert_uint_eq(pm__items(root, "images"), 3);
    json_t *const first = pm__item(root, "images", 0), *const last = pm__item(root, "images", 2);
    pm__check_keys(first, "name file scene label kind width height channels href attributes exr");
    ck_assert_str_eq(pm__text_of(first, "kind"), "truth");
    ck_assert_str_eq(pm__text_of(first, "file"), "b.truth.exr");
    ck_assert_int_eq((int)pm__number_of(first, "width"), 172);
    ck_assert_int_eq((int)pm__number_of(first, "height"), 100);
    ck_assert_uint_eq(pm__items(first, "channels"), 3);
    ck_assert(pm__is_null(first, "href"));
    ck_assert_str_eq(pm__text_of(last, "kind"), "image");
    ck_assert_int_eq((int)pm__number_of(last, "width"), 7);
    unpack(first, "unpacked.exr");
    check_means("unpacked.exr");
    json_decref(root);
    /* What was packed is an image that this program reads, reduced to itself. */
    (void)pm__expect(line_of("@a.json @unpacked.exr -o @again"), 0, NULL);
    json_t *const again = read_page("again/index.html");
    ck_assert_int_eq((int)pm__number_of(pm__item(again, "images", 0), "width"), 172);
    json_decref(again);
    teardown();
}
END_TEST

/* What `render` writes says what it is; a truth that two estimators share is there once. */
START_TEST(renders_are_described)
{
    setup();
    char line[600];
    (void)snprintf(line, sizeof line,
                   "render water --estimator disc,hull:boundary=0 --size 8x8 --spp 1 --photons 2000 --k 10 --aov "
                   "--trials 2 --quiet -o %s/i.exr", place.path);
    (void)pm__expect(line, 0, NULL);
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    (void)pm__expect(line_of("@a.json @i.water.disc.exr @i.water.disc.truth.exr @i.water.hull-boundary=0.exr "
                             "@i.water.hull-boundary=0.truth.exr @i.water.disc.count.exr -o @out"), 0, NULL);
    json_t *const root = read_page("out/index.html");
    static const char *const want[][3] = {{"water.disc", "disc, k = 10", "image"},
                                          {"water.disc.truth", "truth (exact)", "truth"},
                                          {"water.hull:boundary=0", "hull:boundary=0, k = 10", "image"},
                                          {"water.disc.count", "disc, k = 10: count", "count"}};
    ck_assert_uint_eq(pm__items(root, "images"), 4);
    for (size_t i = 0; i < 4; i++) {
        json_t *const image = pm__item(root, "images", i), *const more = json_object_get(image, "attributes");
        ck_assert_str_eq(pm__text_of(image, "name"), want[i][0]);
        ck_assert_str_eq(pm__text_of(image, "label"), want[i][1]);
        ck_assert_str_eq(pm__text_of(image, "kind"), want[i][2]);
        ck_assert_str_eq(pm__text_of(image, "scene"), "scene:water");
        ck_assert_str_eq(pm__text_of(more, "seed"), "1");
        ck_assert_ptr_nonnull(strstr(pm__text_of(more, "command"), "photonbench render water"));
        ck_assert_uint_eq(pm__items(image, "channels"), i == 3 ? 1 : 3);
    }
    json_decref(root);
    teardown();
}
END_TEST

/* Pixels that do not compress. */
static void write_noise(const char *name, unsigned seed)
{
    pm__image image;
    ck_assert_int_eq(pm__image_create(256, 256, 3, &image, NULL), PM_OK);
    for (size_t i = 0; i < 3 * 256 * 256; i++) {
        seed = seed * 1664525u + 1013904223u;
        image.values[i] = (float)(seed >> 8) / 16777216.0F;
    }
    FILE *const file = fopen(path_of(name), "wb");
    ck_assert_ptr_nonnull(file);
    ck_assert_int_eq(pm__exr_write(file, &image, false, NULL, 0, NULL), PM_OK);
    ck_assert_int_eq(fclose(file), 0);
    pm__image_free(&image);
}

/* More than a page takes. */
START_TEST(further_images_stand_beside)
{
    setup();
    enum { IMAGES = 20 };
    char words[400] = "@a.json ", name[40];
    write_text("a.json", HEAD "\"x\",\"rows\":[]}");
    for (int i = 0; i < IMAGES; i++) {
        (void)snprintf(name, sizeof name, "i%d.exr", i);
        write_noise(name, (unsigned)i);
        (void)snprintf(words + strlen(words), sizeof words - strlen(words), "@i%d.exr ", i);
    }
    (void)strcat(words, "-o @out --quiet");
    (void)pm__expect(line_of(words), 0, NULL);
    json_t *const root = read_page("out/index.html");
    struct stat status;
    ck_assert_int_eq(stat(path_of("out/index.html"), &status), 0);
    size_t beside = 0;
    for (size_t i = 0; i < IMAGES; i++) {
        const json_t *const image = pm__item(root, "images", i);
        const char *const href = pm__text_of(image, "href");
        ck_assert(pm__is_null(image, "exr") != pm__is_null(image, "href"));
        if (!*href)
            continue;
        static char script[1 << 20];
        char path[100], start[80];
        beside++;
        (void)snprintf(path, sizeof path, "out/%.80s", href);
        ck_assert_int_gt(pm__test_read(path_of(path), script, sizeof script), 100);
        (void)snprintf(start, sizeof start, "window.pmImage(\"%s\", \"", pm__text_of(image, "file"));
        ck_assert_ptr_eq(strstr(script, start), script);
        ck_assert_str_eq(script + strlen(script) - 4, "\");\n");
        path[strlen(path) - 3] = '\0';
        ck_assert(exists(path));
    }
    ck_assert_msg(status.st_size < 8500000, "%ld bytes", (long)status.st_size);
    ck_assert_msg(beside > 0 && beside < IMAGES, "%zu beside, page of %ld bytes", beside, (long)status.st_size);
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
             long_stress_is_condensed, ways_out_are_options,
             images_are_reduced_and_told, renders_are_described, further_images_stand_beside, usage, hostile_files,
             complete_or_absent, same_page, figures_have_their_points)
