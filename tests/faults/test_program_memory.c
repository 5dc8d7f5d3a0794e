/* The program when memory runs out at any moment: commands from their options to their files, one allocation after the
 * other refused. Each ends with status 4 and says why, or does without what was refused; files are complete or
 * absent. */
#include "../../src/image/image.h"
#include "allocation.h"
#include "command.h"

#include <stdlib.h>

/* With files "rows.json" and others that it may write; `keep`: files of the directory that are to stay. */
typedef struct commanding {
    const char *line;
    int keep;
} commanding;

/* Not its bytes: times are in the header. */
static void digest_image(uint64_t *digest)
{
    char path[PM__TEST_PATH];
    pm__image image;
    PM_MUST(pm__exr_read(pm__test_path(&pm__place, "image.exr", path), &image, NULL) == PM_OK);
    pm__digest(digest, image.values, image.width * image.height * (size_t)image.channels * sizeof *image.values);
    pm__image_free(&image);
}

static void digest_rows(const char *line, uint64_t *digest)
{
    if (!strstr(line, "--json @rows.json"))
        return;
    char *const rows = pm__rows_of("rows.json");
    PM_MUST(rows != NULL);
    static const char *const timed[] = {"search", "advise", "storage", "speed"}; /* what they measure is time */
    bool is_timed = false;
    for (size_t i = 0; i < sizeof timed / sizeof *timed; i++)
        is_timed |= strncmp(line, timed[i], strlen(timed[i])) == 0;
    if (!is_timed)
        pm__digest(digest, rows, strlen(rows));
    free(rows);
}

static void remove_outputs(void)
{
    static const char *const names[] = {"rows.json", "rows.csv", "rows.md", "out", "err", "state", "image.exr",
                                        "map.mse.exr", "map.mse.png", "map.ssim.exr", "map.ssim.png",
                                        "map.hdrflip.exr", "map.hdrflip.png", "index.html"};
    char path[PM__TEST_PATH];
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        (void)unlink(pm__test_path(&pm__place, names[i], path));
}

static pm_status run(void *context, uint64_t *digest, pm_error *error)
{
    const commanding *const c = context;
    const int status = pm__run_command(c->line);
    const bool was_on = pm__the_heap.on;
    pm__the_heap.on = false;
    pm__listen();
    (void)snprintf(error->text, sizeof error->text, "status %d: %.290s", status, pm__said);
    if (status == PM__EXIT_DONE) {
        digest_rows(c->line, digest);
        if (strstr(c->line, "@image.exr"))
            digest_image(digest);
        PM_MUST(!strstr(pm__said, "emory"));
    } else {
        PM_MUST(status != PM__EXIT_OTHER || strstr(pm__said, "emory"));
    }
    remove_outputs();
    PM_MUST(pm__test_directory_entries(&pm__place, 0) == c->keep);
    pm__the_heap.on = was_on;
    /* A contender that had no memory is a row that says so. */
    if (status == PM__EXIT_CHECK_FAILED && strncmp(c->line, "search", 6) == 0)
        return PM_ENOMEM;
    return status == PM__EXIT_DONE ? PM_OK : status == PM__EXIT_OTHER ? PM_ENOMEM : PM_EBROKEN;
}

static void check_command(const char *line)
{
    pm__place = pm__test_directory_create();
    pm__each_refusal(line, run, &(commanding){line, 0});
    pm__test_directory_remove(&pm__place);
}

#define QUICK " --threads 1 --quiet"

START_TEST(accuracy)
{
    check_command("accuracy --case square --estimator disc,hull --k 5 --photons 50 --trials 2 --probes 4 "
                  "--json @rows.json" QUICK);
}
END_TEST

START_TEST(accuracy_of_scenes)
{
    check_command("accuracy --case scene:plate --estimator disc --k 5 --photons 50 --trials 2 --probes 4 "
                  "--json @rows.json" QUICK);
}
END_TEST

START_TEST(search)
{
    pm__each_part = 8;
    pm__all_below = 60; /* clocks are waited for */
    check_command("search --case square --photons 100 --k 5 --search wide --samples 1 --json @rows.json" QUICK);
}
END_TEST

START_TEST(render)
{
    check_command("render plate --size 4x4 --photons 50 --spp 1 --k 5 -o @image.exr --json @rows.json" QUICK);
}
END_TEST

START_TEST(converge)
{
    check_command("converge plate --passes 2 --trials 2 --photons-per-pass 50 --size 4x4 --k 5 --checkpoint @state "
                  "--json @rows.json" QUICK);
}
END_TEST

#define SERIES "converge plate --passes 2 --trials 2 --photons-per-pass 50 --size 4x4 --k 5"

/* With files of the user's: they stay as they are. */
static void check_with_files(const char *line)
{
    static const char photons[] = "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
                                  "property float z\nproperty float dx\nproperty float dy\nproperty float dz\n"
                                  "property float r\nproperty float g\nproperty float b\nend_header\n"
                                  "0 0 0 0 0 -1 1 1 1\n1 0 0 0 0 -1 1 1 1\n0 1 0 0 0 -1 1 1 1\n1 1 0 0 0 -1 1 1 1\n";
    static const char queries[] = "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                                  "property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                                  "end_header\n0.5 0.5 0 0 0 1\n0.6 0.5 0 0 0 1\n";
    char path[PM__TEST_PATH];
    pm__place = pm__test_directory_create();
    pm__test_write(pm__test_path(&pm__place, "p.ply", path), photons, sizeof photons - 1);
    pm__test_write(pm__test_path(&pm__place, "q.ply", path), queries, sizeof queries - 1);
    (void)pm__run_command("accuracy --case square --estimator disc --k 5 --photons 50 --trials 2 --probes 4 "
                          "--json @a.json --quiet");
    (void)pm__run_command(SERIES " --checkpoint @kept --quiet");
    remove_outputs();
    pm__each_refusal(line, run, &(commanding){line, 4});
    pm__test_directory_remove(&pm__place);
}

START_TEST(estimates)
{
    check_with_files("estimate --photons @p.ply --queries @q.ply --k 3 --estimator hull --json @rows.json "
                     "--csv @rows.csv --markdown @rows.md" QUICK);
}
END_TEST

START_TEST(comparisons)
{
    check_with_files("compare @a.json @a.json --json @rows.json");
}
END_TEST

START_TEST(reports)
{
    check_with_files("report @a.json -o @. --quiet");
}
END_TEST

/* Maps that were complete before the refusal may stay. */
START_TEST(comparisons_of_images)
{
    pm__place = pm__test_directory_create();
    (void)pm__run_command("render plate --size 5x4 --photons 50 --spp 1 --k 5 -o @a.exr" QUICK);
    (void)pm__run_command("render plate --size 5x4 --photons 90 --spp 2 --k 5 -o @b.exr" QUICK);
    remove_outputs();
    static const char line[] = "compare @a.exr @b.exr --metric mse,ssim,hdrflip -o @map --json @rows.json --quiet";
    pm__each_refusal(line, run, &(commanding){line, 2});
    pm__test_directory_remove(&pm__place);
}
END_TEST

/* What was done is still there to go on from, whatever failed before. */
START_TEST(resumed)
{
    check_with_files(SERIES " --resume @kept --json @rows.json" QUICK);
}
END_TEST

START_TEST(advice)
{
    pm__all_below = 20; /* clocks are waited for */
    pm__each_part = 4;
    check_command("advise square --error 0.3 --seconds 0.01 --probes 16 --photons 500 --estimator disc "
                  "--json @rows.json" QUICK);
}
END_TEST

START_TEST(stress)
{
    pm__each_part = 20;
    check_command("stress --test single --estimator disc --search wide --json @rows.json" QUICK);
}
END_TEST

START_TEST(storage)
{
    pm__each_part = 3;
    pm__all_below = 40; /* each passes over its scene's importance and its reference */
    pm__full_below = 200;
    pm__full_part = 60;
    check_command("storage torus --policy density --photons 100 --trials 2 --spp 4 "
                  "--paths 100 --json @rows.json --csv @rows.csv" QUICK);
}
END_TEST

START_TEST(speed)
{
    pm__each_part = 3;
    pm__all_below = 20; /* clocks are waited for */
    pm__full_below = 200;
    pm__full_part = 60;
    check_command("speed corner --quantity trace,visualize,skip,pass --photons 50 --k 5 --size 4x4 "
                  "--seconds 0.01 --json @rows.json" QUICK);
}
END_TEST

START_TEST(list)
{
    check_command("list searches --json @rows.json");
}
END_TEST

PM_TEST_MAIN("memory of the program", accuracy, accuracy_of_scenes, search, render, converge, estimates, comparisons,
             comparisons_of_images, reports, resumed, advice, stress, storage, speed, list)
