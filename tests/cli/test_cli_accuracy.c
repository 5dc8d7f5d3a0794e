/* accuracy as a script sees it: rows, files, threads, interruption, terminals. */
#include "../program.h"
#include "../rows.h"

#include <pty.h>
#include <signal.h>
#include <stdbool.h>
#include <sys/stat.h>
#include <time.h>

#define SMALL "--trials 3 --probes 16 --photons 500 --k 10,20 "

/* As the outside contract has it. */
static const char head_keys[] = "schema command version options seed machine wall_s rows";
static const char machine_keys[] = "cpu cores simd governor load compiler flags";
static const char row_keys[] =
    "case region paths estimator kind k radius lookup front photons sampler search trials probes truth_mean "
    "rel_bias rel_bias_ci95 rms_bias rms_bias_ci95 rel_noise rel_noise_ci95 rel_rmse rel_rmse_ci95 "
    "predicted_rel_bias predicted_rel_noise ns_per_query ns_per_query_ci95 cost_s efficiency pareto status detail";

START_TEST(json_has_the_contract)
{
    json_t *const root = pm__expect_json("accuracy --case square --estimator disc,hull " SMALL "--seed 7 --json -");
    pm__check_keys(root, head_keys);
    ck_assert_str_eq(pm__text_of(root, "schema"), "photonbench/1");
    ck_assert_str_eq(pm__text_of(root, "command"), "accuracy");
    ck_assert_int_eq(json_integer_value(json_object_get(root, "seed")), 7);
    pm__check_keys(json_object_get(root, "machine"), machine_keys);
    json_t *const rows = json_object_get(root, "rows");
    ck_assert_uint_eq(json_array_size(rows), 4 * 2 * 2); /* regions, estimators, k */
    size_t index;
    json_t *row;
    json_array_foreach(rows, index, row) {
        pm__check_keys(row, row_keys);
        ck_assert_str_eq(pm__text_of(row, "case"), "square:irradiance=1");
        ck_assert_str_eq(pm__text_of(row, "kind"), "knn");
        ck_assert_str_eq(pm__text_of(row, "front"), "on");
        ck_assert(json_is_null(json_object_get(row, "radius")));
        json_t *const ci95 = json_object_get(row, "rel_bias_ci95");
        ck_assert_uint_eq(json_array_size(ci95), 2);
        ck_assert_double_le(json_real_value(json_array_get(ci95, 0)), json_real_value(json_array_get(ci95, 1)));
        ck_assert_str_eq(pm__text_of(row, "status"), "ok");
    }
    json_decref(root);
}
END_TEST

START_TEST(fixed_radius)
{
    json_t *const root = pm__expect_json("accuracy --case square --estimator disc --trials 2 --probes 4 --photons 500 "
                                         "--radius 0.25 --lookup disc:0.5 --front off --json -");
    json_t *const row = json_array_get(json_object_get(root, "rows"), 0);
    ck_assert_str_eq(pm__text_of(row, "kind"), "radius");
    ck_assert_str_eq(pm__text_of(row, "lookup"), "disc:0.5");
    ck_assert_str_eq(pm__text_of(row, "front"), "off");
    ck_assert(json_is_null(json_object_get(row, "k")));
    ck_assert(json_real_value(json_object_get(row, "radius")) == 0.25);
    json_decref(root);
    /* Searches work in single precision, but what was asked for is 0.04: in options and rows, JSON and CSV. */
    const char *const small = "accuracy --case square --estimator disc --trials 2 --probes 4 --photons 500 "
                              "--radius 0.04 %s -";
    char arguments[200];
    (void)snprintf(arguments, sizeof arguments, small, "--json");
    const char *const out = pm__expect(arguments, 0, NULL)->out;
    const char *const first = strstr(out, "\"radius\":0.04,");
    ck_assert_ptr_nonnull(first);
    ck_assert_ptr_nonnull(strstr(first + 1, "\"radius\":0.04,"));
    (void)snprintf(arguments, sizeof arguments, small, "--csv");
    ck_assert_ptr_nonnull(strstr(pm__expect(arguments, 0, NULL)->out, ",0.04,sphere,"));
}
END_TEST

START_TEST(a_volume_has_no_hull)
{
    json_t *const root = pm__expect_json("accuracy --case volume --estimator hull " SMALL "--json -");
    json_t *const row = json_array_get(json_object_get(root, "rows"), 0);
    pm__check_keys(row, row_keys);
    ck_assert_str_eq(pm__text_of(row, "status"), "unsupported");
    ck_assert(json_is_null(json_object_get(row, "rel_bias")));
    ck_assert(json_is_null(json_object_get(row, "rel_bias_ci95")));
    ck_assert_uint_gt(strlen(pm__text_of(row, "detail")), 0);
    json_decref(root);
}
END_TEST

/* The same run's rows without what is timed. */
static json_t *untimed_rows(const char *arguments)
{
    static const char *const timed[] = {"ns_per_query", "ns_per_query_ci95", "cost_s", "efficiency", "pareto"};
    json_t *const root = pm__expect_json(arguments);
    json_t *const rows = json_incref(json_object_get(root, "rows"));
    size_t index;
    json_t *row;
    json_array_foreach(rows, index, row) {
        for (size_t i = 0; i < sizeof timed / sizeof *timed; i++)
            (void)json_object_del(row, timed[i]);
    }
    json_decref(root);
    return rows;
}

START_TEST(threads_do_not_matter)
{
#define RUN "accuracy --case square,corner,scene:water --sampler poisson,stratified,sobol --trials 5 --probes 32 " \
            "--photons 600 --k 12,30 "
    json_t *const one = untimed_rows(RUN "--json - --threads 1");
    json_t *const two = untimed_rows(RUN "--json - --threads 2");
    json_t *const other = untimed_rows(RUN "--json - --threads 2 --seed 2");
    ck_assert_uint_gt(json_array_size(one), 0);
    ck_assert(json_equal(one, two));
    ck_assert(!json_equal(one, other));
    json_decref(one);
    json_decref(two);
    json_decref(other);
}
END_TEST

/* What a row is about must not move with the seed, or runs of two seeds would differ by more than their intervals
 * say. Theory is exact at the probes, so its means tell whether they are the same. */
START_TEST(seeds_share_their_probes)
{
    static const char *const same[] = {"truth_mean", "predicted_rel_bias", "predicted_rel_noise"};
#define SEED "accuracy --case sinusoid --estimator epanechnikov --trials 4 --probes 40 --photons 900 --k 20 --json - " \
             "--seed "
    json_t *const one = untimed_rows(SEED "1"), *const two = untimed_rows(SEED "2");
    ck_assert_uint_gt(json_array_size(one), 0);
    for (size_t i = 0; i < json_array_size(one); i++) {
        json_t *const a = json_array_get(one, i), *const b = json_array_get(two, i);
        for (size_t f = 0; f < sizeof same / sizeof *same; f++) {
            ck_assert(json_is_real(json_object_get(a, same[f])));
            ck_assert(json_equal(json_object_get(a, same[f]), json_object_get(b, same[f])));
        }
        ck_assert(!json_equal(json_object_get(a, "rel_bias"), json_object_get(b, "rel_bias")));
    }
    json_decref(one);
    json_decref(two);
}
END_TEST

START_TEST(lists_in_any_form)
{
    json_t *const commas = untimed_rows("accuracy --case square --estimator disc:last=none,cone,k=2 " SMALL "--json -");
    json_t *const repeated = untimed_rows("accuracy --case square --estimator disc:last=none --estimator cone:k=2 "
                                          "--estimator disc:last=none --trials 3 --probes 16 --photons 500 --k 10 "
                                          "--k 20,10 --json -");
    ck_assert(json_equal(commas, repeated));
    ck_assert_str_eq(pm__text_of(json_array_get(commas, 2), "estimator"), "cone:k=2,last=full");
    json_decref(commas);
    json_decref(repeated);
}
END_TEST

static size_t count_of(const char *text, char letter)
{
    size_t count = 0;
    for (; *text; text++)
        count += *text == letter;
    return count;
}

START_TEST(csv_and_markdown)
{
    const char *const csv =
        pm__expect("accuracy --case square --estimator cone,disc --photons 500 --k 10 --trials 2 --probes 4 --csv -", 0,
                   NULL)
            ->out;
    ck_assert_ptr_nonnull(strstr(csv, "rel_bias,rel_bias_ci95_low,rel_bias_ci95_high,rms_bias,"));
    ck_assert_ptr_nonnull(strstr(csv, "\nsquare:irradiance=1,all,LD,\"cone:k=1.1,last=full\",knn,10,,sphere,on,500,"));
    ck_assert_uint_eq(count_of(csv, '\n'), 1 + 4 * 2);
    const char *const markdown =
        pm__expect("accuracy --case square --estimator disc --photons 500 --k 10 --trials 2 --probes 4 --markdown -", 0,
                   NULL)
            ->out;
    ck_assert(strncmp(markdown, "| case | region | ", 18) == 0);
    ck_assert_uint_eq(count_of(markdown, '\n'), 2 + 4);
}
END_TEST

static void check_table(const char *text, const char *part)
{
    ck_assert_msg(strstr(text, part) != NULL, "no '%s' in: %.2000s", part, text);
    for (const char *line = text; *line; line += strcspn(line, "\n") + 1) {
        ck_assert_msg(strcspn(line, "\n") <= 100, "too wide: %.*s", (int)strcspn(line, "\n"), line);
        if (!line[strcspn(line, "\n")])
            break;
    }
}

START_TEST(tables)
{
    /* Few rows have a line each; many are packed. */
    const char *out = pm__expect("accuracy --case square --estimator disc,hull:boundary=0 " SMALL, 0, NULL)->out;
    check_table(out, "95 % interval predicted");
    check_table(out, "Least rmse");
    out =
        pm__expect("accuracy --case square,volume --trials 2 --probes 8 --photons 500 --k 12,15,20,30 --estimator all "
                   "--estimator differential:rule=significance,z=2,noise=stratified",
                   0, NULL)
            ->out;
    check_table(out, "   k=12 ");
    check_table(out, "\ndifferential:rule=significance,z=2,noise=stratified\n");
    check_table(out, "hull: unsupported");
}
END_TEST

START_TEST(quiet_and_files)
{
    const pm__test_directory place = pm__test_directory_create();
    char json[PM__TEST_PATH], table[PM__TEST_PATH], arguments[3 * PM__TEST_PATH];
    static char text[1 << 16];
    (void)snprintf(arguments, sizeof arguments,
                   "accuracy --case square --estimator disc " SMALL "--quiet --json %s -o %s",
                   pm__test_path(&place, "a.json", json), pm__test_path(&place, "a.txt", table));
    ck_assert_str_eq(pm__expect(arguments, 0, NULL)->out, "");
    ck_assert_int_gt(pm__test_read(table, text, sizeof text), 0);
    ck_assert_ptr_nonnull(strstr(text, "square:irradiance=1"));
    json_t *const root = json_load_file(json, 0, NULL);
    pm__check_keys(root, head_keys);
    json_decref(root);
    ck_assert_int_eq(pm__test_directory_entries(&place, 1), 2);

    /* An error found late leaves the file as it was. */
    pm__test_write(json, "before", 6);
    (void)snprintf(arguments, sizeof arguments, "accuracy --estimator combined --photons 500 --k 5 --json %s", json);
    (void)pm__expect(arguments, 2, "too few");
    ck_assert_int_eq(pm__test_read(json, text, sizeof text), 6);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    (void)pm__expect("accuracy --case square --estimator disc " SMALL "--json /dev/full", 4, "No space left on device");
    pm__test_directory_remove(&place);
}
END_TEST

static void pause_ms(long ms)
{
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
    (void)nanosleep(&t, NULL);
}

/* Waits until the program has opened its file in `place`. */
static void wait_for_file(const pm__test_directory *place)
{
    for (int i = 0; i < 1000 && !pm__test_directory_entries(place, 0); i++)
        pause_ms(5);
    ck_assert_int_eq(pm__test_directory_entries(place, 0), 1);
}

START_TEST(interrupted)
{
    const pm__test_directory place = pm__test_directory_create(), streams = pm__test_directory_create();
    char json[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH], arguments[2 * PM__TEST_PATH];
    (void)snprintf(
        arguments, sizeof arguments,
        "accuracy --case square --estimator disc --photons 40000 --k 10 --trials 100000 --probes 10 --json %s",
        pm__test_path(&place, "a.json", json));
    const pid_t child =
        pm__start(arguments, pm__test_path(&streams, "out", out), pm__test_path(&streams, "err", err));
    /* Once its temporary file is there the program listens to signals. */
    wait_for_file(&place);
    ck_assert_int_eq(kill(child, SIGINT), 0);
    ck_assert_int_eq(pm__wait(child), 130);
    json_t *const root = json_load_file(json, 0, NULL);
    ck_assert_ptr_nonnull(root);
    ck_assert(json_is_true(json_object_get(root, "interrupted")));
    ck_assert_uint_eq(json_array_size(json_object_get(root, "rows")), 0);
    json_decref(root);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    pm__test_directory_remove(&place);
    pm__test_directory_remove(&streams);
}
END_TEST

/* While rows are written to standard output nothing asks whether to stop: a pipe that nobody reads from holds the
 * program there for good, so only the second signal can end it. */
START_TEST(interrupted_twice)
{
    const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
    for (size_t i = 0; i < 3; i++) {
        const pm__test_directory place = pm__test_directory_create(), streams = pm__test_directory_create();
        char fifo[PM__TEST_PATH], csv[PM__TEST_PATH], err[PM__TEST_PATH], arguments[2 * PM__TEST_PATH];
        (void)snprintf(arguments, sizeof arguments,
                       "accuracy --case square --trials 2 --photons 1000 --probes 1 --json - --csv %s",
                       pm__test_path(&place, "a.csv", csv));
        (void)pm__test_path(&streams, "err", err);
        ck_assert_int_eq(mkfifo(pm__test_path(&streams, "out", fifo), 0600), 0);
        const int unread = open(fifo, O_RDWR | O_NONBLOCK | O_CLOEXEC);
        ck_assert_int_ge(unread, 0);
        char junk[4096] = "";
        while (write(unread, junk, sizeof junk) > 0) /* until it is full */
            continue;
        const pid_t child = pm__start(arguments, fifo, err);
        wait_for_file(&place);
        pause_ms(500);
        ck_assert_int_eq(kill(child, numbers[i]), 0);
        pause_ms(100);
        ck_assert_int_eq(waitpid(child, NULL, WNOHANG), 0);
        ck_assert_int_eq(kill(child, numbers[i]), 0);
        ck_assert_int_eq(pm__wait(child), 130);
        ck_assert_int_eq(pm__test_directory_entries(&place, 0), 0);
        (void)close(unread);
        pm__test_directory_remove(&place);
        pm__test_directory_remove(&streams);
    }
}
END_TEST

/* A pipe that nobody has opened at its other end must not hold the program against a signal. */
START_TEST(interrupted_at_a_pipe)
{
    static const char *const forms[] = {"list --json %s", "compare %s b.json", "estimate --photons %s --queries q.ply",
                                        "search --input %s"};
    for (size_t i = 0; i < sizeof forms / sizeof *forms; i++) {
        const pm__test_directory place = pm__test_directory_create();
        char fifo[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH], arguments[2 * PM__TEST_PATH];
        ck_assert_int_eq(mkfifo(pm__test_path(&place, "pipe", fifo), 0600), 0);
        (void)pm__test_path(&place, "out", out);
        (void)pm__test_path(&place, "err", err);
        (void)snprintf(arguments, sizeof arguments, forms[i], fifo);
        const pid_t child = pm__start(arguments, out, err);
        pause_ms(500);
        ck_assert_int_eq(waitpid(child, NULL, WNOHANG), 0);
        ck_assert_int_eq(kill(child, SIGINT), 0);
        ck_assert_int_eq(pm__wait(child), 130);
        pm__test_directory_remove(&place);
    }
}
END_TEST

/* Not even a single trial that takes minutes keeps the program from stopping. */
START_TEST(interrupted_in_a_long_trial)
{
    const pm__test_directory place = pm__test_directory_create(), streams = pm__test_directory_create();
    char json[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH], arguments[2 * PM__TEST_PATH];
    (void)snprintf(arguments, sizeof arguments,
                   "accuracy --case square --estimator disc --k 2000 --trials 2 --probes 3000000 --json %s",
                   pm__test_path(&place, "a.json", json));
    const pid_t child =
        pm__start(arguments, pm__test_path(&streams, "out", out), pm__test_path(&streams, "err", err));
    wait_for_file(&place);
    pause_ms(3000); /* into the trials */
    const time_t asked = time(NULL);
    ck_assert_int_eq(kill(child, SIGTERM), 0);
    ck_assert_int_eq(pm__wait(child), 130);
    ck_assert_int_le(time(NULL) - asked, 20);
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), 1);
    pm__test_directory_remove(&place);
    pm__test_directory_remove(&streams);
}
END_TEST

/* What does not fit is refused before it is begun, not begun until the system kills it. */
START_TEST(more_than_memory_holds)
{
    const char *const requests[] = {"--photons 1000000000 --trials 2 --threads 2 --estimator disc --k 5",
                                    "--photons 1000 --trials 10000000 --probes 10000000 --estimator disc --k 5",
                                    "--photons 500000000 --trials 200 --threads 200 --estimator combined --k 50"};
    for (size_t i = 0; i < sizeof requests / sizeof *requests; i++) {
        char arguments[300];
        (void)snprintf(arguments, sizeof arguments, "accuracy --case square %s", requests[i]);
        const time_t start = time(NULL);
        ck_assert_str_eq(pm__expect(arguments, 4, "GB of memory")->out, "");
        ck_assert_int_le(time(NULL) - start, 5);
    }
}
END_TEST

/* Runs on a terminal of its own, which standard error shares. */
static const char *on_terminal(const char *arguments, const char *term, const char *no_colour)
{
    static char text[1 << 18];
    size_t used = 0;
    int terminal;
    const pid_t child = forkpty(&terminal, NULL, NULL, NULL);
    ck_assert_int_ge(child, 0);
    if (child == 0) {
        (void)setenv("TERM", term, 1);
        if (no_colour)
            (void)setenv("NO_COLOR", no_colour, 1);
        else
            (void)unsetenv("NO_COLOR");
        pm__exec(arguments);
    }
    for (ssize_t got; used + 1 < sizeof text && (got = read(terminal, text + used, sizeof text - 1 - used)) > 0;)
        used += (size_t)got;
    text[used] = '\0';
    (void)close(terminal);
    ck_assert_int_eq(pm__wait(child), 0);
    return text;
}

/* A system stripped of its pseudo-terminals (a chroot without /dev/pts) cannot show this. */
static bool has_terminals(void)
{
    int master, slave;
    if (openpty(&master, &slave, NULL, NULL, NULL) != 0)
        return false;
    (void)close(master);
    (void)close(slave);
    return true;
}

START_TEST(terminals)
{
    if (!has_terminals()) {
        (void)puts("SKIP: no pseudo-terminals here: colours and the progress bar are not tried");
        return;
    }
#define SHOWN "accuracy --case square --estimator disc --photons 2000 --k 10 --trials 200 --probes 100"
    const char *text = on_terminal(SHOWN, "xterm", NULL);
    ck_assert_ptr_nonnull(strstr(text, "\033[1m"));
    ck_assert_ptr_nonnull(strstr(text, "\r["));
    text = on_terminal(SHOWN, "xterm", "1");
    ck_assert_ptr_null(strstr(text, "\033[1m"));
    ck_assert_ptr_nonnull(strstr(text, "\r["));
    text = on_terminal(SHOWN, "dumb", NULL);
    ck_assert_ptr_null(strchr(text, '\033'));
    ck_assert_ptr_null(strstr(text, "\r["));
    text = on_terminal(SHOWN " --quiet", "xterm", NULL);
    ck_assert_ptr_null(strstr(text, "\r["));
    ck_assert_ptr_null(strchr(pm__expect(SHOWN, 0, NULL)->out, '\033'));
}
END_TEST

PM_TEST_MAIN("cli accuracy", json_has_the_contract, fixed_radius, a_volume_has_no_hull, threads_do_not_matter,
             seeds_share_their_probes, lists_in_any_form, csv_and_markdown, tables, quiet_and_files, interrupted,
             interrupted_twice, interrupted_at_a_pipe, interrupted_in_a_long_trial, more_than_memory_holds, terminals)
