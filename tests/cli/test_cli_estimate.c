/* estimate as a script sees it, against sums made by hand. */
#include "../program.h"

#include <time.h>

enum { PHOTONS = 120, QUERIES = 3 };
static const char photon_header[] = "property float x\nproperty float y\nproperty float z\nproperty float dx\n"
                                    "property float dy\nproperty float dz\nproperty float r\nproperty float g\n"
                                    "property float b\nend_header\n";
static const char query_header[] = "property float x\nproperty float y\nproperty float z\nproperty float nx\n"
                                   "property float ny\nproperty float nz\nend_header\n";
static pm__test_directory place;

/* Photons on a crooked spiral in z = 0, going down; every fifth comes from below. */
static void photon(int i, double position[2], double *dz, double *power)
{
    const double angle = 2.4 * i, r = 0.09 * sqrt(i + 0.5);
    position[0] = (double)(float)(r * cos(angle));
    position[1] = (double)(float)(r * sin(angle) * 1.3);
    *dz = i % 5 ? -1.0 : 1.0;
    *power = (double)(float)(0.01 * (1 + i % 7));
}

static void write_file(const char *name, const char *header, int count, const char *body)
{
    char path[PM__TEST_PATH];
    FILE *const file = fopen(pm__test_path(&place, name, path), "wb");
    ck_assert_ptr_nonnull(file);
    (void)fprintf(file, "ply\nformat ascii 1.0\nelement vertex %d\n%s%s", count, header, body);
    ck_assert_int_eq(fclose(file), 0);
}

static void write_photons(const char *name, int count)
{
    char body[PHOTONS * 100] = "";
    size_t used = 0;
    for (int i = 0; i < count; i++) {
        double position[2], dz, power;
        photon(i, position, &dz, &power);
        used += (size_t)snprintf(body + used, sizeof body - used, "%.9g %.9g 0 0 0 %g %.9g %.9g 0\n", position[0],
                                 position[1], dz, power, 2.0 * power);
    }
    write_file(name, photon_header, count, body);
}

static void setup(void)
{
    place = pm__test_directory_create();
    write_photons("p.ply", PHOTONS);
    write_photons("none.ply", 0);
    write_file("q.ply", query_header, QUERIES, "0 0 0 0 0 1\n0.25 -0.125 0 0 0 2\n0.25 -0.125 0 0 0 -1\n");
    write_file("same.ply", photon_header, 3, "0 0 0 0 0 -1 1 1 1\n0 0 0 0 0 -1 1 1 1\n0 0 0 0 0 -1 1 1 1\n");
}

static void teardown(void)
{
    pm__test_directory_remove(&place);
}

/* "estimate" on the two files of the test's directory, and what else is asked for. */
static const char *command(const char *photons, const char *queries, const char *rest)
{
    static char text[3 * PM__TEST_PATH];
    (void)snprintf(text, sizeof text, "estimate --photons %s/%s --queries %s/%s %s", place.path, photons, place.path,
                   queries, rest);
    return text;
}

static int by_distance(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The cone of constant c on the k nearest photons that arrive from the side of the normal: errata 3's normaliser. */
static double cone(double x, double y, double nz, size_t k, double c)
{
    double found[PHOTONS][2], sum = 0.0;
    size_t count = 0;
    for (int i = 0; i < PHOTONS; i++) {
        double p[2], dz, power;
        photon(i, p, &dz, &power);
        if (dz * nz < 0.0) {
            found[count][0] = hypot(p[0] - x, p[1] - y);
            found[count++][1] = power;
        }
    }
    qsort(found, count, sizeof *found, by_distance);
    if (k > count)
        k = count;
    const double r = found[k - 1][0];
    for (size_t i = 0; i < k; i++)
        sum += found[i][1] * (1.0 - found[i][0] / (c * r));
    return sum / ((1.0 - 2.0 / (3.0 * c)) * acos(-1.0) * r * r);
}

static void check_cone(const char *csv, size_t k)
{
    static const double points[QUERIES][3] = {{0, 0, 1}, {0.25, -0.125, 1}, {0.25, -0.125, -1}};
    ck_assert(strncmp(csv, "query,e_r,e_g,e_b,radius,count\n", 31) == 0);
    for (int q = 0; q < QUERIES; q++) {
        int number, used = 0;
        double e[3], radius;
        size_t count;
        csv += strcspn(csv, "\n") + 1;
        ck_assert_int_eq(sscanf(csv, "%d,%lf,%lf,%lf,%lf,%zu%n", &number, &e[0], &e[1], &e[2], &radius, &count, &used),
                         6);
        ck_assert_int_eq(csv[used], '\n');
        ck_assert_int_eq(number, q);
        const size_t lit = points[q][2] > 0.0 ? PHOTONS - PHOTONS / 5 : PHOTONS / 5;
        ck_assert_uint_eq(count, k < lit ? k : lit);
        const double want = cone(points[q][0], points[q][1], points[q][2], k, 1.1);
        PM_CHECK_NEAR(e[0], want, 2e-6 * want); /* radii are kept in single precision */
        PM_CHECK_NEAR(e[1], 2.0 * want, 4e-6 * want);
        ck_assert(e[2] == 0.0);
    }
}

START_TEST(equals_a_sum_by_hand)
{
    check_cone(pm__expect(command("p.ply", "q.ply", "--estimator cone:k=1.1 --k 20 --csv -"), 0, NULL)->out, 20);
    check_cone(pm__expect(command("p.ply", "q.ply", "--estimator cone --k 20 --search brute"), 0, NULL)->out, 20);
    /* More than there are: all. */
    check_cone(pm__expect(command("p.ply", "q.ply", "--estimator cone --k 1000"), 0, NULL)->out, 1000);
}
END_TEST

START_TEST(fixed_radius)
{
    json_t *const root = pm__expect_json(command("p.ply", "q.ply", "--radius 0.3 --front off --json -"));
    pm__check_keys(root, "schema command version options seed machine wall_s rows");
    double sum = 0.0;
    size_t count = 0;
    for (int i = 0; i < PHOTONS; i++) {
        double p[2], dz, power;
        photon(i, p, &dz, &power);
        if (hypot(p[0], p[1]) <= (double)0.3f) {
            sum += power;
            count++;
        }
    }
    json_t *const row = json_array_get(json_object_get(root, "rows"), 0);
    pm__check_keys(row, "query e_r e_g e_b radius count status detail");
    const double want = sum / (acos(-1.0) * 0.09);
    PM_CHECK_NEAR(json_real_value(json_object_get(row, "e_r")), want, 1e-6 * want);
    ck_assert_int_eq(json_integer_value(json_object_get(row, "count")), (json_int_t)count);
    ck_assert(json_real_value(json_object_get(row, "radius")) == 0.3); /* as it was given */
    ck_assert(json_real_value(json_object_get(json_object_get(root, "options"), "radius")) == 0.3);
    ck_assert_str_eq(json_string_value(json_object_get(row, "status")), "ok");
    json_decref(root);
}
END_TEST

START_TEST(no_photons)
{
    ck_assert_str_eq(pm__expect(command("none.ply", "q.ply", "--radius 0.5"), 0, NULL)->out,
                     "query,e_r,e_g,e_b,radius,count\n0,0,0,0,0.5,0\n1,0,0,0,0.5,0\n2,0,0,0,0.5,0\n");
    const char *const estimators[] = {"disc", "hull", "combined", "precomputed"};
    char rest[64];
    for (size_t i = 0; i < 4; i++) {
        (void)snprintf(rest, sizeof rest, "--estimator %s --k 20", estimators[i]);
        ck_assert_ptr_nonnull(strstr(pm__expect(command("none.ply", "q.ply", rest), 0, NULL)->out, "\n0,0,0,0,"));
    }
}
END_TEST

START_TEST(degenerate)
{
    const char *const message = "1 of 3 queries have no estimate";
    ck_assert_ptr_nonnull(strstr(pm__expect(command("same.ply", "q.ply", ""), 0, message)->out, "\n0,,,,0,3\n1,"));
    json_t *const root = pm__expect_json(command("same.ply", "q.ply", "--json - --quiet"));
    json_t *const row = json_array_get(json_object_get(root, "rows"), 0);
    ck_assert(json_is_null(json_object_get(row, "e_r")));
    ck_assert_str_eq(json_string_value(json_object_get(row, "status")), "degenerate");
    ck_assert(json_is_string(json_object_get(row, "detail")));
    json_decref(root);
}
END_TEST

START_TEST(every_estimator_and_thread_count)
{
    const char *const estimators[] = {"disc",         "cone",        "gaussian",
                                      "epanechnikov", "biweight",    "differential",
                                      "hull",         "combined",    "combined:deal=roundrobin",
                                      "precomputed",  "precomputed:when=demand"};
    char rest[128];
    for (size_t i = 0; i < sizeof estimators / sizeof *estimators; i++) {
        (void)snprintf(rest, sizeof rest, "--k 24 --threads 1 --estimator %s", estimators[i]);
        char *const one = strdup(pm__expect(command("p.ply", "q.ply", rest), 0, NULL)->out);
        (void)snprintf(rest, sizeof rest, "--k 24 --threads 2 --estimator %s", estimators[i]);
        ck_assert_str_eq(pm__expect(command("p.ply", "q.ply", rest), 0, NULL)->out, one);
        free(one);
    }
}
END_TEST

/* More queries than a block of work holds: rows stay in the order of the queries. */
START_TEST(order_of_many_queries)
{
    enum { MANY = 900 };
    static const char *const lines[QUERIES] = {"0 0 0 0 0 1\n", "0.25 -0.125 0 0 0 2\n", "0.25 -0.125 0 0 0 -1\n"};
    static char body[MANY * 24];
    body[0] = '\0';
    for (size_t i = 0, used = 0; i < MANY; i++)
        used += (size_t)snprintf(body + used, sizeof body - used, "%s", lines[i % QUERIES]);
    write_file("many.ply", query_header, MANY, body);
    json_t *const root = pm__expect_json(command("p.ply", "many.ply", "--threads 2 --json -"));
    json_t *const rows = json_object_get(root, "rows");
    ck_assert_uint_eq(json_array_size(rows), MANY);
    for (size_t i = 0; i < MANY; i++) {
        json_t *const row = json_array_get(rows, i), *const same = json_array_get(rows, i % QUERIES);
        ck_assert_int_eq(json_integer_value(json_object_get(row, "query")), (json_int_t)i);
        ck_assert(json_equal(json_object_get(row, "e_r"), json_object_get(same, "e_r")));
        ck_assert(json_equal(json_object_get(row, "count"), json_object_get(same, "count")));
    }
    ck_assert(!json_equal(json_object_get(json_array_get(rows, 0), "e_r"),
                          json_object_get(json_array_get(rows, 1), "e_r")));
    json_decref(root);
}
END_TEST

/* Any k is min(k, N), and takes no more memory than that. */
START_TEST(k_beyond_the_photons)
{
    for (int i = 0; i < 2; i++) {
        const char *const form = i ? "--estimator precomputed --k %d --csv -" : "--k %d --csv -";
        char rest[100];
        (void)snprintf(rest, sizeof rest, form, 1000000000);
        char *const far_beyond = strdup(pm__expect(command("p.ply", "q.ply", rest), 0, NULL)->out);
        (void)snprintf(rest, sizeof rest, form, 1000);
        ck_assert_str_eq(pm__expect(command("p.ply", "q.ply", rest), 0, NULL)->out, far_beyond);
        free(far_beyond);
    }
}
END_TEST

START_TEST(dealing_follows_the_seed)
{
    char *const one = strdup(pm__expect(command("p.ply", "q.ply", "--k 24 --estimator combined"), 0, NULL)->out);
    const char *const two = pm__expect(command("p.ply", "q.ply", "--k 24 --estimator combined --seed 2"), 0, NULL)->out;
    ck_assert_str_ne(one, two);
    free(one);
}
END_TEST

/* Bad input: status 3, the file named, and no output. */
START_TEST(bad_files)
{
    char path[PM__TEST_PATH], rest[PM__TEST_PATH + 16];
    write_file("word.ply", photon_header, 1, "0 0 zero 0 0 -1 1 1 1\n");
    write_file("short.ply", photon_header, 2, "0 0 0 0 0 -1 1 1 1\n");
    write_file("nan.ply", photon_header, 1, "0 0 nan 0 0 -1 1 1 1\n");
    write_file("huge.ply", photon_header, 2000000000, "");
    pm__test_write(pm__test_path(&place, "junk.ply", path), "not a PLY\n", 10);
    const char *const names[] = {"missing.ply", "word.ply", "short.ply", "nan.ply", "huge.ply", "junk.ply", "q.ply"};
    (void)snprintf(rest, sizeof rest, "--json %s", pm__test_path(&place, "out.json", path));
    const int before = pm__test_directory_entries(&place, 0);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        ck_assert_str_eq(pm__expect(command(names[i], "q.ply", rest), 3, names[i])->out, "");
    (void)pm__expect(command("p.ply", "p.ply", rest), 3, "p.ply");
    (void)pm__expect(command("p.ply", "missing.ply", rest), 3, "missing.ply");
    ck_assert_int_eq(pm__test_directory_entries(&place, 0), before);
}
END_TEST

/* A binary file of `count` vertices that is one hole: it takes no room on the disk. */
static void write_hole(const char *name, const char *header, long count, long record)
{
    char path[PM__TEST_PATH], text[1000];
    const int length =
        snprintf(text, sizeof text, "ply\nformat binary_little_endian 1.0\nelement vertex %ld\n%s", count, header);
    pm__test_write(pm__test_path(&place, name, path), text, (size_t)length);
    ck_assert_int_eq(truncate(path, length + count * record), 0);
}

/* Files that are sound but do not fit are refused before they are read, not read until the system kills the program. */
START_TEST(more_than_memory_holds)
{
    static const char *const photon_rests[] = {"", "--estimator precomputed",
                                                "--estimator combined --search grid --radius 1"};
    write_hole("holes.ply", photon_header, 1000000000, 36);
    write_hole("queries.ply", query_header, 1000000000, 24);
    const time_t start = time(NULL);
    for (size_t i = 0; i < sizeof photon_rests / sizeof *photon_rests; i++) {
        const char *const err = pm__expect(command("holes.ply", "q.ply", photon_rests[i]), 4, "GB of memory")->err;
        ck_assert_ptr_nonnull(strstr(err, "holes.ply"));
        ck_assert_ptr_nonnull(strstr(err, "GB are free"));
    }
    (void)pm__expect(command("p.ply", "queries.ply", ""), 4, "queries.ply: 1000000000 of 1000000000 vertices take");
    ck_assert_int_le(time(NULL) - start, 5);
}
END_TEST

START_TEST(outputs)
{
    char path[PM__TEST_PATH], rest[PM__TEST_PATH + 16], text[4096];
    (void)snprintf(rest, sizeof rest, "-o %s", pm__test_path(&place, "out.csv", path));
    ck_assert_str_eq(pm__expect(command("p.ply", "q.ply", rest), 0, NULL)->out, "");
    ck_assert_int_gt(pm__test_read(path, text, sizeof text), 0);
    ck_assert_str_eq(pm__expect(command("p.ply", "q.ply", ""), 0, NULL)->out, text);
    (void)pm__expect(command("p.ply", "q.ply", "--csv /dev/full"), 4, "No space left on device");
    (void)pm__expect(command("p.ply", "q.ply", "--csv a -o b"), 2, "give one");
}
END_TEST

static Suite *suite(void)
{
    const TTest *const tests[] = {equals_a_sum_by_hand, fixed_radius,
                                  no_photons,           degenerate,   k_beyond_the_photons,
                                  every_estimator_and_thread_count, dealing_follows_the_seed,
                                  order_of_many_queries, bad_files,           more_than_memory_holds,
                                  outputs};
    Suite *const all = suite_create("cli estimate");
    TCase *const tcase = tcase_create("cli estimate");
    tcase_add_checked_fixture(tcase, setup, teardown);
    tcase_set_timeout(tcase, 60);
    for (size_t i = 0; i < sizeof tests / sizeof *tests; i++)
        tcase_add_test(tcase, tests[i]);
    suite_add_tcase(all, tcase);
    return all;
}

int main(void)
{
    SRunner *const runner = srunner_create(suite());
    srunner_run_all(runner, CK_ENV);
    const int failed = srunner_ntests_failed(runner);
    srunner_free(runner);
    return failed ? EXIT_FAILURE : EXIT_SUCCESS;
}
