/* `photonbench converge --checkpoint` and `--resume` as a user runs them: interrupted or killed at any moment, the rows
 * that come out at last are those of an undisturbed run. */
#include "../program.h"

#include <stdbool.h>
#include <sys/stat.h>
#include <time.h>

#define SERIES "converge plate --method ppm,pppm --alpha 0.5,0.8 --trials 3 --passes 100 --photons-per-pass 1000 " \
               "--size 4x4 --k 20 --at 1,2 "
#define OFTEN "--checkpoint-seconds 0.01 "

static pm__test_directory place;
static char state[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH], json[PM__TEST_PATH];
static char line[4 * PM__TEST_PATH];

static void set_up(void)
{
    place = pm__test_directory_create();
    (void)pm__test_path(&place, "state", state);
    (void)pm__test_path(&place, "out", out);
    (void)pm__test_path(&place, "err", err);
    (void)pm__test_path(&place, "rows.json", json);
}

static void tear_down(void)
{
    pm__test_directory_remove(&place);
}

/* Arguments with the state's file in place of each '@'. */
static const char *with_state(const char *arguments)
{
    size_t used = 0;
    for (const char *c = arguments; *c; c++)
        used += (size_t)snprintf(line + used, sizeof line - used, "%.*s", *c == '@' ? PM__TEST_PATH : 1,
                                 *c == '@' ? state : c);
    return line;
}

/* Rows, fits and points but for times. */
static json_t *comparable(json_t *root)
{
    ck_assert_ptr_nonnull(root);
    json_t *const kept = json_pack("{s: O, s: O, s: O}", "rows", json_object_get(root, "rows"), "fits",
                                   json_object_get(root, "fits"), "points", json_object_get(root, "points"));
    ck_assert_ptr_nonnull(kept);
    size_t index;
    json_t *row;
    json_array_foreach(json_object_get(kept, "rows"), index, row)
        (void)json_object_del(row, "seconds");
    json_decref(root);
    return kept;
}

static void check_same(json_t *want, json_t *got)
{
    ck_assert_msg(json_equal(want, got), "the rows differ: %.1000s", json_dumps(got, JSON_COMPACT));
    json_decref(got);
}

static json_t *undisturbed(const char *arguments)
{
    char all[1000];
    (void)snprintf(all, sizeof all, "%s--threads 1 --json -", arguments);
    return comparable(pm__expect_json(all));
}

static void pause_ms(long ms)
{
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
    (void)nanosleep(&t, NULL);
}

static bool is_there(const char *path)
{
    return access(path, F_OK) == 0;
}

/* Runs, and sends the signal after a while, if it is still there; the exit status. */
static int disturb(const char *arguments, int number, long ms)
{
    const pid_t child = pm__start(arguments, out, err);
    pause_ms(ms);
    (void)kill(child, number);
    return pm__wait(child);
}

static void check_message(const char *part)
{
    char text[4000];
    ck_assert_int_ge(pm__test_read(err, text, sizeof text), 0);
    ck_assert_msg(strstr(text, part) != NULL, "'%s' lacks '%s'", text, part);
}

/* Interrupted again and again, by signals in turn, until it comes to its end; one thread, that a busy machine be no
 * trouble, but for some runs of two. */
static void interrupt_until_done(const char *series)
{
    static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
    char arguments[3 * PM__TEST_PATH];
    json_t *const want = undisturbed(series);
    int status = 130, times = 0;
    for (; status == 130 && times < 200; times++) {
        (void)snprintf(arguments, sizeof arguments, "%s%s--threads %d %s %s --json %s", series, OFTEN,
                       times % 4 == 2 ? 2 : 1, is_there(state) ? "--resume" : "--checkpoint", state, json);
        status = disturb(arguments, signals[times % 3], 30 + 25 * times);
        if (status == 128 + signals[times % 3]) /* ended before it had begun */
            status = 130;
    }
    ck_assert_int_eq(status, 0);
    ck_assert_int_ge(times, 3);
    check_same(want, comparable(json_load_file(json, 0, NULL)));
    json_decref(want);
}

START_TEST(interrupted_and_resumed)
{
    set_up();
    interrupt_until_done(SERIES);
    tear_down();
}
END_TEST

START_TEST(other_methods_too)
{
    set_up();
    interrupt_until_done("converge furnace --method pm,path,light --trials 2 --passes 100 --photons-per-pass 1000 "
                         "--size 4x4 --k 20 ");
    tear_down();
}
END_TEST

/* The last complete checkpoint is there, however suddenly it ended. */
START_TEST(killed_and_resumed)
{
    set_up();
    json_t *const want = undisturbed(SERIES);
    char arguments[3 * PM__TEST_PATH];
    int status = 128 + SIGKILL, times = 0;
    for (; status == 128 + SIGKILL && times < 200; times++) {
        (void)snprintf(arguments, sizeof arguments, "%s%s--threads 1 %s %s --json %s", SERIES, OFTEN,
                       is_there(state) ? "--resume" : "--checkpoint", state, json);
        status = disturb(arguments, SIGKILL, 30 + 25 * times);
    }
    ck_assert_int_eq(status, 0);
    ck_assert_int_ge(times, 3);
    check_same(want, comparable(json_load_file(json, 0, NULL)));
    json_decref(want);
    tear_down();
}
END_TEST

/* A run that takes days, told to stop once its first checkpoint is there. */
static void stop_a_long_run(const char *options, int number)
{
    (void)snprintf(line, sizeof line,
                   "converge plate water --trials 100000 --passes 3 --photons-per-pass 500 --size 4x4 --k 20 %s%s %s",
                   OFTEN, options, state);
    const pid_t child = pm__start(line, out, err);
    for (int i = 0; i < 4000 && !is_there(state); i++)
        pause_ms(5);
    ck_assert_msg(is_there(state), "nothing is saved while it runs");
    pause_ms(300);
    ck_assert_int_eq(kill(child, number), 0);
    ck_assert_int_eq(pm__wait(child), 130);
}

/* What the message says to type does go on. */
START_TEST(the_message_tells_how)
{
    static const int signals[] = {SIGINT, SIGTERM};
    for (size_t i = 0; i < 2; i++) {
        char text[4000];
        set_up();
        stop_a_long_run("--checkpoint", signals[i]);
        check_message("converge: interrupted: ");
        ck_assert_int_gt(pm__test_read(err, text, sizeof text), 0);
        const char *const told = strstr(text, "to go on: photonbench converge plate water ");
        ck_assert_msg(told != NULL && strstr(told, " --resume ") != NULL, "%s", text);
        char typed[sizeof text];
        (void)snprintf(typed, sizeof typed, "%s", told + strlen("to go on: photonbench "));
        typed[strcspn(typed, "\n")] = '\0';
        ck_assert_int_eq(disturb(typed, SIGINT, 400), 130);
        check_message(": of 2 series 0 were done, one was in hand\n");
        ck_assert_int_gt(pm__test_read(err, text, sizeof text), 0);
        const char *const again = strstr(text, "to go on: photonbench ");
        ck_assert_ptr_nonnull(again); /* the same words, not one --resume more */
        ck_assert_msg(strncmp(again + strlen("to go on: photonbench "), typed, strlen(typed)) == 0 &&
                          again[strlen("to go on: photonbench ") + strlen(typed)] == '\n',
                      "%s", again);
        tear_down();
    }
}
END_TEST

START_TEST(quiet_says_nothing)
{
    char text[100];
    set_up();
    stop_a_long_run("--quiet --checkpoint", SIGINT);
    ck_assert_int_eq(pm__test_read(err, text, sizeof text), 0);
    tear_down();
}
END_TEST

#define SMALL "converge plate water --trials 2 --passes 3 --photons-per-pass 500 --size 4x4 --k 20 "

/* What is done need not be done again, and another machine's threads do not matter. */
START_TEST(what_is_done_is_read)
{
    set_up();
    json_t *const want = undisturbed(SMALL);
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 0, NULL);
    const pm__run *const run = pm__expect(with_state(SMALL "--resume @ --threads 1 --json -"), 0,
                                          "state: of 2 series 2 were done\n");
    check_same(want, comparable(json_loads(run->out, 0, NULL)));
    (void)pm__expect(with_state(SMALL "--resume @ --profile full --quiet"), 0, NULL);
    json_decref(want);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1); /* nothing temporary */
    tear_down();
}
END_TEST

/* A series that cannot be measured has nothing to save, and does not disturb those that can. */
START_TEST(what_cannot_be_measured)
{
    set_up();
    json_t *const want = undisturbed(SMALL "--estimator combined,disc ");
    (void)pm__expect(with_state(SMALL "--estimator combined,disc --checkpoint @"), 0, NULL);
    json_t *const got = comparable(
        pm__expect_json(with_state(SMALL "--estimator combined,disc --resume @ --quiet --json -")));
    check_same(want, got);
    json_decref(want);
    tear_down();
}
END_TEST

/* --resume reads one, --checkpoint writes the other; links stay links. */
START_TEST(two_files_and_links)
{
    char other[PM__TEST_PATH], behind[PM__TEST_PATH], arguments[4 * PM__TEST_PATH];
    struct stat status;
    set_up();
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 0, NULL);
    ck_assert_int_eq(symlink("behind", pm__test_path(&place, "other", other)), 0);
    (void)snprintf(arguments, sizeof arguments, SMALL "--quiet --resume %s --checkpoint %s", state, other);
    (void)pm__expect(arguments, 0, NULL);
    ck_assert_int_eq(lstat(other, &status), 0);
    ck_assert(S_ISLNK(status.st_mode));
    (void)pm__test_path(&place, "behind", behind);
    (void)snprintf(arguments, sizeof arguments, SMALL "--quiet --resume %s", behind);
    (void)pm__expect(arguments, 0, NULL);
    tear_down();
}
END_TEST

static const struct {
    const char *options, *message;
} others[] = {
    {"plate water --trials 3", "--trials was 2 and is 3 now"},
    {"plate water --passes 4", "--passes was 3 and is 4 now"},
    {"plate water --photons-per-pass 501", "--photons-per-pass was 500 and is 501 now"},
    {"plate water --photons 1500", "--photons was null and is 1500 now"},
    {"plate water --size 4x5", "--size was \"4x4\" and is \"4x5\" now"},
    {"plate water --k 21", "--k was 20 and is 21 now"},
    {"plate water --radius 0.5", "--radius was null and is 0.5 now"},
    {"plate water --seconds 50", "--seconds was null and is 50"},
    {"plate water --at 1,1", "--at was [] and is [[1,1]] now"},
    {"plate water --alpha 0.5", "--alpha was [0.667] and is [0.5] now"},
    {"plate water --method pppm", "--method was [\"ppm:flux=corrected,start=zero\"] and is [\"pppm\"] now"},
    {"plate water --estimator cone", "--estimator was [\"disc:last=full\"] and is "},
    {"plate water --sampler sobol", "--sampler was [\"poisson\"] and is [\"sobol\"] now"},
    {"plate water --front off", "--front was \"on\" and is \"off\" now"},
    {"plate water --search grid", "--search was \"auto\" and is \"grid\" now"},
    {"plate water --seed 2", "--seed was 1 and is 2 now"},
    {"plate", "scene was [\"scene:plate:ior=1.5,thickness=0.2\",\"scene:water:"},
    {"water plate", "scene was ["},
};

START_TEST(other_options_are_refused)
{
    set_up();
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 0, NULL);
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) {
        char all[1000];
        (void)snprintf(all, sizeof all, "converge --trials 2 --passes 3 --photons-per-pass 500 --size 4x4 --k 20 "
                                        "--resume @ %s", others[i].options);
        const pm__run *const run = pm__expect(with_state(all), 2, others[i].message);
        ck_assert_ptr_nonnull(strstr(run->err, "state: a checkpoint of other options: "));
        ck_assert_str_eq(run->out, "");
    }
    /* One by a search that was named: by the same and no other. */
    (void)pm__expect(with_state(SMALL "--search wide --checkpoint @"), 0, NULL);
    (void)pm__expect(with_state(SMALL "--resume @"), 2, "--search was \"wide\" and is \"auto\" now");
    (void)pm__expect(with_state(SMALL "--search wide --quiet --resume @"), 0, "");
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 0, NULL);
    /* Sums depend on the processor's width. */
    ck_assert_int_eq(setenv("PHOTONBENCH_SIMD", "v2", 1), 0);
    const pm__run *const run = pm__run_program(with_state(SMALL "--quiet --resume @"));
    ck_assert(run->status == 2 ? strstr(run->err, "PHOTONBENCH_SIMD was ") != NULL : run->status == 0);
    ck_assert_int_eq(unsetenv("PHOTONBENCH_SIMD"), 0);
    tear_down();
}
END_TEST

/* Refused before anything is done, and left as it is. */
START_TEST(damage_is_refused)
{
    static char before[1 << 20], bytes[1 << 20], after[1 << 20];
    set_up();
    (void)pm__expect(with_state(SMALL "--resume @"), 3, "state: cannot be opened: No such file");
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 0, NULL);
    const long size = pm__test_read(state, before, sizeof before);
    ck_assert_int_gt(size, 100);
    for (long i = 0; i < 24; i++) {
        const long at = i * (size - 1) / 23;
        memcpy(bytes, before, (size_t)size);
        if (i % 2)
            bytes[at] ^= 4;
        pm__test_write(state, bytes, i % 2 ? (size_t)size : (size_t)at);
        const pm__run *const run = pm__expect(with_state(SMALL "--resume @"), 3, "state, byte ");
        ck_assert_ptr_nonnull(strstr(run->err, ": expected "));
        ck_assert_str_eq(run->out, "");
        ck_assert_int_eq(pm__test_read(state, after, sizeof after), i % 2 ? size : at);
    }
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    tear_down();
}
END_TEST

/* A series whose bytes are wrong though the file is whole: the place is that of the series. */
START_TEST(wrong_series_are_refused)
{
    static unsigned char bytes[1 << 20];
    set_up();
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 0, NULL);
    const long size = pm__test_read(state, (char *)bytes, sizeof bytes);
    uint64_t at = 32, length, sum = 14695981039346656037u;
    for (int i = 0; i < 2; i++) { /* version, options */
        memcpy(&length, bytes + at, 8);
        at += 8 + length;
    }
    at += 8 + 16;
    memset(bytes + at + 72, 255, 8); /* the first series' count of readings */
    for (long i = 0; i < size - 8; i++)
        sum = (sum ^ bytes[i]) * 1099511628211u;
    memcpy(bytes + size - 8, &sum, 8);
    pm__test_write(state, bytes, (size_t)size);
    char want[100];
    (void)snprintf(want, sizeof want, "state, byte %d: expected the state of series 1: ", (int)at);
    ck_assert_str_eq(pm__expect(with_state(SMALL "--quiet --resume @"), 3, want)->out, "");
    tear_down();
}
END_TEST

START_TEST(usage_and_bad_paths)
{
    set_up();
    (void)pm__expect("converge plate --checkpoint -", 2, "--checkpoint: '-': expected a file");
    (void)pm__expect("converge plate --resume -", 2, "--resume: '-': expected a file");
    (void)pm__expect("converge plate --checkpoint a --checkpoint-seconds 0", 2, "'0' is not a number above 0");
    (void)pm__expect("converge plate --checkpoint-seconds 5", 2, "--checkpoint-seconds needs --checkpoint or --resume");
    (void)pm__expect("converge plate --checkpoint a --json a", 2, "--checkpoint and an output of rows are both 'a'");
    (void)pm__expect("converge plate --resume a --csv a", 2, "--resume and an output of rows are both 'a'");
    /* Before the work, which here would take days. */
    (void)pm__expect("converge plate --size 1024x1024 --trials 1000 --checkpoint /nonexistent/a", 4,
                     "/nonexistent/a: cannot be opened");
    (void)pm__expect("converge plate --resume /dev/zero", 3, "no regular file");
    (void)pm__expect("converge plate --size 1024x1024 --trials 1000 --checkpoint /dev/full", 4,
                     "/dev/full: cannot be written: a checkpoint is a regular file");
    /* A pipe, which opening would wait at; what is there stays as it was. */
    ck_assert_int_eq(mkfifo(state, 0600), 0);
    (void)pm__expect(with_state(SMALL "--checkpoint @"), 4, "state: cannot be written: a checkpoint is a regular file");
    ck_assert_int_eq(unlink(state), 0);
    pm__test_write(state, "kept", 4);
    (void)pm__expect(with_state(SMALL "--checkpoint @ --csv /nonexistent/a.csv"), 4, "/nonexistent/a.csv");
    char kept[8];
    ck_assert_int_eq(pm__test_read(state, kept, sizeof kept), 4);
    ck_assert_int_eq(unlink(state), 0);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 0);
    tear_down();
}
END_TEST

PM_TEST_MAIN("cli checkpoint", interrupted_and_resumed, other_methods_too, killed_and_resumed, the_message_tells_how,
             quiet_says_nothing, what_is_done_is_read, what_cannot_be_measured, two_files_and_links,
             other_options_are_refused, damage_is_refused, wrong_series_are_refused, usage_and_bad_paths)
