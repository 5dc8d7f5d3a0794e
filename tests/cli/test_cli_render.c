/* render as a user sees it: files, names, headers, plans, rows, threads, interruption. */
#include "../../src/image/image.h"
#include "../program.h"

#include <stdbool.h>
#include <sys/stat.h>
#include <time.h>

#define SMALL " --size 24x20 --spp 2 --photons 2000 --k 20 --quiet "

static const char row_keys[] =
    "scene method estimator k radius photons emitted stored width height spp trials truth rel_error_mean "
    "rel_error_rms trace_s build_s image_s total_s file status detail";
static const char *const aov_suffixes[] = {".truth", ".error", ".bias", ".noise", ".radius", ".count"};
enum { AOVS = sizeof aov_suffixes / sizeof *aov_suffixes };

/* Runs `format` with the path of `name` in `place` for its %s. */
static const pm__run *run_at(const pm__test_directory *place, const char *name, const char *format, int status,
                             const char *part)
{
    char path[PM__TEST_PATH], arguments[2 * PM__TEST_PATH];
    (void)snprintf(arguments, sizeof arguments, format, pm__test_path(place, name, path));
    return pm__expect(arguments, status, part);
}

static bool is_there(const pm__test_directory *place, const char *name)
{
    char path[PM__TEST_PATH];
    return access(pm__test_path(place, name, path), F_OK) == 0;
}

/* The image of a file, which must be a sound one of finite values; the caller's. */
static pm__image image_at(const pm__test_directory *place, const char *name)
{
    char path[PM__TEST_PATH];
    pm_error error = {""};
    pm__image image;
    PM_CHECK_OK(pm__exr_read(pm__test_path(place, name, path), &image, &error), error);
    for (size_t i = 0; i < image.width * image.height * (size_t)image.channels; i++)
        ck_assert_msg(isfinite((double)image.values[i]), "%s: value %zu is %g", name, i, (double)image.values[i]);
    return image;
}

static bool same_images(const pm__image *a, const pm__image *b)
{
    return a->width == b->width && a->height == b->height && a->channels == b->channels &&
           memcmp(a->values, b->values, a->width * a->height * (size_t)a->channels * sizeof *a->values) == 0;
}

/* Are two files the same image? */
static bool same_files(const pm__test_directory *place, const char *one, const char *other)
{
    pm__image a = image_at(place, one), b = image_at(place, other);
    const bool same = same_images(&a, &b);
    pm__image_free(&a);
    pm__image_free(&b);
    return same;
}

/* Headers are not compressed: what they say stands in the file. */
static bool header_says(const pm__test_directory *place, const char *name, const char *text)
{
    static char bytes[1 << 20];
    char path[PM__TEST_PATH];
    const long size = pm__test_read(pm__test_path(place, name, path), bytes, sizeof bytes);
    return size > 0 && memmem(bytes, (size_t)size, text, strlen(text)) != NULL;
}

static const struct {
    const char *arguments, *message;
} usage_errors[] = {
    {"render", "a scene is needed"},
    {"render plat", "unknown scene 'plat'; did you mean 'plate'?"},
    {"render scene:plat", "unknown scene 'plat'; did you mean 'plate'?"},
    {"render water plat", "unknown scene 'plat'"},
    {"render square", "unknown scene 'square'; 'photonbench list scenes' shows them"},
    {"render plate,,water", "an empty name among the scenes"},
    {"render plate:iro=1.5", "did you mean 'ior'?"},
    {"render plate:ior=0", "ior=0: expected a number from"},
    {"render plate:thickness=1,water,ior=x", "ior=x"},
    {"render water --method visualise", "--method: unknown method 'visualise'; did you mean 'visualize'?"},
    {"render water --estimator dsic", "--estimator: unknown estimator 'dsic'; did you mean 'disc'?"},
    {"render water --k 0", "--k: '0' is not an integer from 1"},
    {"render water --k 5,10", "--k: '5,10' is not an integer"},
    {"render water --photons 1e12", "--photons: '1e12' is not an integer"},
    {"render water --radius -1", "--radius: '-1' is not a number above 0"},
    {"render water --radius auto", "--radius: 'auto' is not a number above 0"},
    {"render water --size 0x10", "--size: '0x10': expected WIDTHxHEIGHT, each from 1 to 16384 pixels"},
    {"render water --size 16385x1", "--size: '16385x1': expected"},
    {"render water --size 10", "--size: '10': expected"},
    {"render water --size 10x10x10", "--size: '10x10x10': expected"},
    {"render water --size -4x4", "--size: '-4x4': expected"},
    {"render water --spp 0", "--spp: '0' is not an integer from 1"},
    {"render water --seconds -1", "--seconds: '-1' is not a number above 0"},
    {"render water --seconds nan", "--seconds: 'nan' is not a number above 0"},
    {"render water --trials 0", "--trials: '0' is not an integer from 1"},
    {"render water --sampler poisson,sobol", "one sampler at a time"},
    {"render water --eye 1,2", "--eye: '1,2': expected three numbers X,Y,Z"},
    {"render water --eye 1,2,3,4", "--eye: '1,2,3,4': expected three numbers"},
    {"render water --look 1,2,x", "--look: '1,2,x': expected three numbers"},
    {"render water --up ,,", "--up: ',,': expected three numbers"},
    {"render water --angle 180", "--angle: '180' is not a number of degrees above 0 and below 180"},
    {"render water --eye 1,1,1 --look 1,1,1 --plan", "--eye, --look, --up, --angle: the camera looks at the point"},
    {"render water --eye 0,0,5 --look 0,0,0 --up 0,0,1 --plan", "up is along its view"},
    {"render water --seed x", "--seed: 'x' is not an integer"},
    {"render water --threads 0", "--threads: '0' is not an integer"},
    {"render water --csv - --json -", "--json and --csv both write to '-'"},
    {"render water -o - --json -", "--json and -o both write to '-'"},
    {"render water -o /dev/stdout --json -", "an image and the rows would both be written to '/dev/stdout'"},
    {"render water --estimator disc,cone --aov -o -", "-o - holds one image, and 14 are asked for"},
    {"render water --aov -o /dev/null", "-o /dev/null holds one image, and 7 are asked for"},
    {"render water plate -o /dev/stdout", "holds one image, and 2 are asked for"},
    {"render water --estimator disc,cone -o a.exr --json a.water.cone.exr",
     "an image and the rows would both be written to 'a.water.cone.exr'"},
    {"render water --aov --csv water.truth.exr",
     "an image and the rows would both be written to 'water.truth.exr'"},
};

START_TEST(every_usage_error)
{
    for (size_t i = 0; i < sizeof usage_errors / sizeof *usage_errors; i++)
        ck_assert_str_eq(pm__expect(usage_errors[i].arguments, 2, usage_errors[i].message)->out, "");
}
END_TEST

START_TEST(a_plan_renders_nothing)
{
    const pm__test_directory place = pm__test_directory_create();
    const pm__run *const run = run_at(&place, "a.exr", "render plate scene:water --plan --quiet -o %s", 0, NULL);
    ck_assert(strncmp(run->out, "scene:plate:ior=1.5,", 20) == 0);
    ck_assert_ptr_nonnull(strstr(run->out, ", method visualize:"));
    ck_assert_ptr_nonnull(strstr(run->out, "\nscene:water:"));
    ck_assert_ptr_nonnull(strstr(run->out, " done "));
    for (const char *line = run->out; *line; line += strcspn(line, "\n") + 1)
        ck_assert_uint_le(strcspn(line, "\n"), 100);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 0);
    json_t *const root = pm__expect_json("render water --plan --json -");
    json_t *const rows = json_object_get(root, "rows");
    ck_assert_uint_gt(json_array_size(rows), 0);
    for (size_t i = 0; i < json_array_size(rows); i++) {
        pm__check_keys(json_array_get(rows, i), "scene method step done why");
        ck_assert(json_is_boolean(json_object_get(json_array_get(rows, i), "done")));
    }
    json_decref(root);
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(rows_have_the_contract)
{
    const pm__test_directory place = pm__test_directory_create();
    json_error_t error;
    const pm__run *const run =
        run_at(&place, "a.exr", "render scene:water --estimator disc,cone:k=2" SMALL "--seed 7 --json - -o %s", 0,
               NULL);
    json_t *const root = json_loads(run->out, 0, &error);
    ck_assert_ptr_nonnull(root);
    pm__check_keys(root, "schema command version options seed machine wall_s rows");
    ck_assert_str_eq(json_string_value(json_object_get(root, "command")), "render");
    json_t *const rows = json_object_get(root, "rows");
    ck_assert_uint_eq(json_array_size(rows), 2);
    for (size_t i = 0; i < 2; i++) {
        json_t *const row = json_array_get(rows, i);
        pm__check_keys(row, row_keys);
        ck_assert_str_eq(json_string_value(json_object_get(row, "status")), "ok");
        ck_assert(strncmp(json_string_value(json_object_get(row, "method")), "visualize:", 10) == 0);
        ck_assert_int_eq(json_integer_value(json_object_get(row, "width")), 24);
        ck_assert_int_eq(json_integer_value(json_object_get(row, "height")), 20);
        ck_assert_int_eq(json_integer_value(json_object_get(row, "spp")), 2);
        ck_assert_int_eq(json_integer_value(json_object_get(row, "k")), 20);
        ck_assert_int_ge(json_integer_value(json_object_get(row, "emitted")), 2000);
        ck_assert_int_eq(access(json_string_value(json_object_get(row, "file")), R_OK), 0);
    }
    json_t *const cone = json_array_get(rows, 1);
    ck_assert_str_eq(json_string_value(json_object_get(cone, "estimator")), "cone:k=2,last=full");
    json_decref(root);
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(a_radius_alone_takes_all_photons)
{
    const pm__test_directory place = pm__test_directory_create();
    const pm__run *const run = run_at(
        &place, "a.exr", "render water --size 4x4 --spp 1 --photons 2000 --radius 0.125 --quiet --csv - -o %s", 0,
        NULL);
    ck_assert_ptr_nonnull(strstr(run->out, ",disc:last=full,,0.125,2000,"));
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(names_of_files)
{
    const pm__test_directory place = pm__test_directory_create();
    (void)run_at(&place, "one.exr", "render water" SMALL "-o %s", 0, NULL);
    ck_assert(is_there(&place, "one.exr"));
    (void)run_at(&place, "plain", "render water" SMALL "--aov --trials 2 -o %s", 0, NULL);
    ck_assert(is_there(&place, "plain") && is_there(&place, "plain.count.exr"));
    ck_assert(!is_there(&place, "plain.exr"));
    (void)pm__test_directory_entries(&place, 1);
    (void)run_at(&place, "n.exr", "render plate:ior=1.25,thickness=0.1,water --estimator disc,cone:k=2" SMALL "-o %s",
                 0, NULL);
    ck_assert(is_there(&place, "n.plate-ior=1.25-thickness=0.1.disc.exr"));
    ck_assert(is_there(&place, "n.plate-ior=1.25-thickness=0.1.cone-k=2.exr"));
    ck_assert(is_there(&place, "n.water.disc.exr") && is_there(&place, "n.water.cone-k=2.exr"));
    ck_assert_int_eq(pm__test_directory_entries(&place, 1), 4);
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(names_without_one_given)
{
    const pm__test_directory place = pm__test_directory_create();
    char before[PM__TEST_PATH];
    ck_assert_ptr_nonnull(getcwd(before, sizeof before));
    ck_assert_int_eq(chdir(place.path), 0);
    const char *const out = pm__expect("render water plate --size 3x3 --spp 1 --photons 2000 --k 20", 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, "water.exr: 3x3, 1 sample; "));
    ck_assert_ptr_nonnull(strstr(out, "\nplate.exr: 3x3, "));
    (void)pm__expect("render water --estimator cone,hull" SMALL, 0, NULL);
    ck_assert_int_eq(chdir(before), 0);
    ck_assert(is_there(&place, "water.exr") && is_there(&place, "plate.exr"));
    ck_assert(is_there(&place, "water.cone.exr") && is_there(&place, "water.hull.exr"));
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 4);
    pm__test_directory_remove(&place);
}
END_TEST

/* The path tracer makes no estimates: one image, however many estimators are named. */
START_TEST(a_method_without_estimates)
{
    const pm__test_directory place = pm__test_directory_create();
    const pm__run *const run =
        run_at(&place, "p.exr", "render water --method path --estimator disc,cone" SMALL "--csv - -o %s", 0, NULL);
    ck_assert_ptr_nonnull(strstr(run->out, ",path,,,,"));
    ck_assert(is_there(&place, "p.exr"));
    ck_assert_int_eq(pm__test_directory_entries(&place, 1), 1);
    (void)run_at(&place, "p.exr", "render water plate --method path" SMALL "-o %s", 0, NULL);
    ck_assert(is_there(&place, "p.water.path.exr") && is_there(&place, "p.plate.path.exr"));
    pm__test_directory_remove(&place);
}
END_TEST

/* Is a truth known of the only image of these JSON rows? */
static bool has_truth(const char *json)
{
    json_t *const root = json_loads(json, 0, NULL), *const rows = json_object_get(root, "rows");
    ck_assert_uint_eq(json_array_size(rows), 1);
    const bool known = !json_is_null(json_object_get(json_array_get(rows, 0), "truth"));
    json_decref(root);
    return known;
}

/* Truth, error and bias where a truth is known, and else no trace of them. */
START_TEST(aovs)
{
    const pm__test_directory place = pm__test_directory_create();
    char name[40];
    const bool known = has_truth(
        run_at(&place, "a.exr", "render water" SMALL "--aov --trials 3 --json - -o %s", 0, NULL)->out);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), known ? 1 + AOVS : 4);
    for (int i = -1; i < AOVS; i++) {
        (void)snprintf(name, sizeof name, "a%s.exr", i < 0 ? "" : aov_suffixes[i]);
        if (i >= 0 && i < 3 && !known)
            continue;
        ck_assert_msg(is_there(&place, name), "no %s", name);
        pm__image image = image_at(&place, name);
        ck_assert_uint_eq(image.width, 24);
        ck_assert_uint_eq(image.height, 20);
        ck_assert_int_eq(image.channels, i < 4 ? 3 : 1);
        pm__image_free(&image);
        ck_assert(header_says(&place, name, "photonbench render water --size 24x20 "));
    }
    ck_assert(header_says(&place, "a.exr", "disc:last=full"));
    ck_assert(header_says(&place, "a.exr", "scene:water:ior="));
    ck_assert(!header_says(&place, "a.exr", "interrupted"));
    /* Of one trial there is no noise, which is said once, unless quiet, and leaves no file. */
    (void)pm__test_directory_entries(&place, 1);
    (void)run_at(&place, "a.exr",
                 "render water --size 4x4 --spp 1 --photons 2000 --k 20 --aov --trials 1 --csv /dev/null -o %s", 0,
                 "bias, noise: it takes --trials 2 at least");
    ck_assert(!is_there(&place, "a.noise.exr") && !is_there(&place, "a.bias.exr") && is_there(&place, "a.count.exr"));
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(complete_or_absent)
{
    const pm__test_directory place = pm__test_directory_create();
    char path[PM__TEST_PATH], text[16];
    (void)pm__expect("render water" SMALL "-o /dev/full", 4, "/dev/full: cannot be written: No space left on device");
    (void)pm__expect("render water" SMALL "-o /nonexistent/a.exr", 4, "/nonexistent/a.exr: cannot be opened");
    (void)pm__expect("render water" SMALL "-o /proc/a.exr", 4, "/proc/a.exr: cannot be opened");
    (void)run_at(&place, ".", "render water" SMALL "-o %s", 4, "cannot be opened");
    /* A bad path shows before the work, which here would take days, and leaves what was there. */
    pm__test_write(pm__test_path(&place, "a.exr", path), "before", 6);
    (void)run_at(&place, "a.exr", "render water --size 2048x2048 --spp 1000000 --json /nonexistent/r -o %s", 4,
                 "/nonexistent/r: cannot be opened");
    ck_assert_int_eq(pm__test_read(path, text, sizeof text), 6);
    ck_assert_int_eq(pm__test_directory_entries(&place, 1), 1);
    (void)run_at(&place, "a.exr", "render water" SMALL "--json /dev/full -o %s", 4, "/dev/full: cannot be written");
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    (void)pm__expect("render water --size 16384x16384 --aov --estimator all", 4, "GB of memory");
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(an_image_on_standard_output)
{
    const pm__test_directory place = pm__test_directory_create();
    char out[PM__TEST_PATH], err[PM__TEST_PATH];
    (void)run_at(&place, "a.exr", "render water" SMALL "-o %s", 0, NULL);
    static const char *const names[] = {"-", "/dev/stdout"};
    for (int i = 0; i < 2; i++) {
        char arguments[200];
        (void)snprintf(arguments, sizeof arguments, "render water --size 24x20 --spp 2 --photons 2000 --k 20 -o %s",
                       names[i]);
        const pid_t child =
            pm__start(arguments, pm__test_path(&place, "out.exr", out), pm__test_path(&place, "err", err));
        ck_assert_int_eq(pm__wait(child), 0);
        ck_assert(same_files(&place, "a.exr", "out.exr"));
    }
    pm__test_directory_remove(&place);
}
END_TEST

START_TEST(threads_do_not_matter)
{
    static const char *const methods[] = {"visualize", "full", "path"};
    for (int m = 0; m < 3; m++) {
        const pm__test_directory place = pm__test_directory_create();
        char arguments[300], one[40], two[40];
        (void)snprintf(arguments, sizeof arguments,
                       "render glass-sphere --method %s" SMALL "--aov --trials 2 --threads 1 -o %%s", methods[m]);
        (void)run_at(&place, "one.exr", arguments, 0, NULL);
        *strstr(arguments, "--threads 1") = '\0';
        (void)strcat(arguments, "--threads 2 -o %s");
        (void)run_at(&place, "two.exr", arguments, 0, NULL);
        for (int i = -1; i < AOVS; i++) {
            (void)snprintf(one, sizeof one, "one%s.exr", i < 0 ? "" : aov_suffixes[i]);
            (void)snprintf(two, sizeof two, "two%s.exr", i < 0 ? "" : aov_suffixes[i]);
            ck_assert(is_there(&place, one) == is_there(&place, two));
            if (is_there(&place, one))
                ck_assert_msg(same_files(&place, one, two), "%s: %s differs", methods[m], one);
        }
        pm__test_directory_remove(&place);
    }
}
END_TEST

START_TEST(seeds_and_views_matter)
{
    const pm__test_directory place = pm__test_directory_create();
    (void)run_at(&place, "a.exr", "render water" SMALL "-o %s", 0, NULL);
    (void)run_at(&place, "same.exr", "render water" SMALL "--search recursive -o %s", 0, NULL);
    (void)run_at(&place, "seed.exr", "render water" SMALL "--seed 2 -o %s", 0, NULL);
    (void)run_at(&place, "view.exr", "render water" SMALL "--eye 0.1,0.2,0.5 --look 0,0,0 --up 0,1,0 --angle 50 -o %s",
                 0, NULL);
    ck_assert(same_files(&place, "a.exr", "same.exr"));
    ck_assert(!same_files(&place, "a.exr", "seed.exr"));
    ck_assert(!same_files(&place, "a.exr", "view.exr"));
    pm__test_directory_remove(&place);
}
END_TEST

static long long spp_of(const char *csv)
{
    const char *const found = strstr(csv, ",24,20,"); /* width, height, spp */
    ck_assert_msg(found != NULL, "no size in %s", csv);
    return strtoll(found + 7, NULL, 10);
}

START_TEST(seconds_end_it)
{
    const pm__test_directory place = pm__test_directory_create();
    const time_t start = time(NULL);
#define TIMED "render water --size 24x20 --photons 2000 --k 20 --quiet --csv - -o %s "
    ck_assert_int_ge(spp_of(run_at(&place, "a.exr", TIMED "--seconds 0.3", 0, NULL)->out), 1);
    ck_assert_int_ge(spp_of(run_at(&place, "a.exr", TIMED "--seconds 0.3 --spp 16000000", 0, NULL)->out), 1);
    ck_assert_int_eq(spp_of(run_at(&place, "a.exr", TIMED "--seconds 1000 --spp 3", 0, NULL)->out), 3);
    ck_assert_int_le(time(NULL) - start, 60);
    pm__test_directory_remove(&place);
}
END_TEST

static void pause_ms(long ms)
{
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
    (void)nanosleep(&t, NULL);
}

/* What was done is there and says so; of the scene that was not begun there is nothing. */
START_TEST(interrupted)
{
    const pm__test_directory place = pm__test_directory_create(), streams = pm__test_directory_create();
    char image[PM__TEST_PATH], json[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH];
    char arguments[3 * PM__TEST_PATH];
    (void)snprintf(arguments, sizeof arguments,
                   "render water plate --size 24x20 --spp 16000000 --photons 2000 --k 20 --quiet --json %s -o %s",
                   pm__test_path(&streams, "a.json", json), pm__test_path(&place, "a.exr", image));
    const pid_t child =
        pm__start(arguments, pm__test_path(&streams, "out", out), pm__test_path(&streams, "err", err));
    for (int i = 0; i < 2000 && pm__test_directory_entries(&place, 0) < 2; i++)
        pause_ms(5);
    pause_ms(2000); /* into the passes */
    ck_assert_int_eq(kill(child, SIGINT), 0);
    ck_assert_int_eq(pm__wait(child), 130);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    pm__image read = image_at(&place, "a.water.disc.exr");
    ck_assert_uint_eq(read.width, 24);
    pm__image_free(&read);
    ck_assert(header_says(&place, "a.water.disc.exr", "samples of a pixel, "));
    json_t *const root = json_load_file(json, 0, NULL);
    ck_assert_ptr_nonnull(root);
    ck_assert(json_is_true(json_object_get(root, "interrupted")));
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 1);
    json_t *const row = json_array_get(json_object_get(root, "rows"), 0);
    ck_assert_str_eq(json_string_value(json_object_get(row, "status")), "interrupted");
    ck_assert_int_ge(json_integer_value(json_object_get(row, "spp")), 1);
    json_decref(root);
    pm__test_directory_remove(&place);
    pm__test_directory_remove(&streams);
}
END_TEST

/* Before anything is begun a signal ends the program, here while it waits for a reader of its rows: the file that was
 * to be replaced stays, and nothing lies beside it. */
START_TEST(ended_before_it_began)
{
    const pm__test_directory place = pm__test_directory_create(), streams = pm__test_directory_create();
    char image[PM__TEST_PATH], fifo[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH];
    char arguments[3 * PM__TEST_PATH], text[16];
    pm__test_write(pm__test_path(&place, "a.exr", image), "before", 6);
    ck_assert_int_eq(mkfifo(pm__test_path(&streams, "pipe", fifo), 0600), 0);
    (void)snprintf(arguments, sizeof arguments, "render water" SMALL "--aov --json %s -o %s", fifo, image);
    const pid_t child =
        pm__start(arguments, pm__test_path(&streams, "out", out), pm__test_path(&streams, "err", err));
    for (int i = 0; i < 2000 && pm__test_directory_entries(&place, 0) < 8; i++)
        pause_ms(5);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 8); /* the old one, and temporary files */
    pause_ms(100);
    ck_assert_int_eq(kill(child, SIGINT), 0);
    ck_assert_int_eq(pm__wait(child), 130);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    ck_assert_int_eq(pm__test_read(image, text, sizeof text), 6);
    pm__test_directory_remove(&place);
    pm__test_directory_remove(&streams);
}
END_TEST

PM_TEST_MAIN("cli_render", every_usage_error, a_plan_renders_nothing, rows_have_the_contract,
             a_radius_alone_takes_all_photons, names_of_files, names_without_one_given, a_method_without_estimates,
             aovs, complete_or_absent, an_image_on_standard_output, threads_do_not_matter, seeds_and_views_matter,
             seconds_end_it, interrupted, ended_before_it_began)
