/* PLY files: every form that is read, and what is written. */
#include "../../src/map/ply_reader.h"

#include "../ply.h"

#include <float.h>
#include <sys/stat.h>

static void check_vector(const float got[3], double x, double y, double z)
{
    PM_CHECK_NEAR((double)got[0], x, 1e-7);
    PM_CHECK_NEAR((double)got[1], y, 1e-7);
    PM_CHECK_NEAR((double)got[2], z, 1e-7);
}

/* The photons of a file that must be read, freed by the caller. */
static pm_photon *read_photons(const void *content, size_t size, size_t want)
{
    pm_photon *photons = NULL;
    size_t count = 99;
    pm_error error = {"untouched"};
    PM_CHECK_OK(pm_ply_read_photons(save(content, size), &photons, NULL, &count, &error), error);
    ck_assert_str_eq(error.text, "untouched");
    ck_assert_uint_eq(count, want);
    ck_assert_ptr_nonnull(photons);
    return photons;
}

static void check_text(const char *text)
{
    pm_photon *const photons = read_photons(text, strlen(text), 2);
    check_vector(photons[0].position, 1.5, -2.0, 3e2);
    check_vector(photons[0].direction, 0.0, 0.0, -1.0);
    check_vector(photons[0].power, 1.0, 0.5, 0.25);
    check_vector(photons[1].position, 4.0, 5.0, 6.0);
    check_vector(photons[1].direction, 0.6, 0.0, 0.8);
    check_vector(photons[1].power, 7.0, 8.0, 9.0);
    pm_free(photons);
}

START_TEST(ascii_forms)
{
    check_text(ASCII "element vertex 2\n" ALL "end_header\n1.5 -2 3e2 0 0 -1 1 .5 0.25\n4 5 6 .6 0 .8 7 8 9\n");
    /* CRLF, comments, tabs, blank lines, no end to the last line. */
    check_text("ply\r\nformat  ascii 1.0\r\ncomment made by hand\r\nobj_info x\r\nelement vertex 2\r\n"
               "property float x\r\nproperty double y\r\nproperty int z\r\ncomment\r\n"
               "property\tfloat32 dx\r\nproperty float64 dy\r\nproperty int8 dz\r\nproperty float power_r\r\n"
               "property float power_g\r\nproperty float power_b\r\nend_header\r\n"
               "1.5 -2 3e2 0\t0 -1 1 .5 0.25 \r\n\r\n  4 5 6 .6 0 .8 7 8 9");
    /* Another order, properties and lists that are not wanted, elements before and after. */
    check_text(ASCII "element camera 2\nproperty float fov\nproperty list uchar int id\n"
                     "element empty 1000000000000000000\n"
                     "element vertex 2\nproperty float b\nproperty list uchar float tags\n"
                     "property uchar red\n" DIRECTION "property float g\nproperty float r\n" POSITION
                     "element face 3\nproperty list uchar int v\n"
                     "end_header\n"
                     "60 3 1 2 3\n70\n0\n"
                     "0.25 2 9 9 255 0 0 -1 .5 1 1.5 -2 3e2\n9 0 3 .6 0 .8 8 7 4 5 6\nnothing that is looked at");
    cleanup();
}
END_TEST

static void check_sample(size_t more)
{
    pm_photon *const photons = read_photons(built, built_size, 1 + more);
    check_vector(photons[more].position, 1.5, -2.0, 300.0);
    check_vector(photons[more].direction, 0.6, 0.0, -0.8);
    check_vector(photons[more].power, 0.5, 0.25, 2.0);
    pm_free(photons);
}

START_TEST(binary_forms)
{
    put_text(BINARY "element vertex 1\n" ALL "end_header\n");
    put_floats(9, sample);
    check_sample(0);
    put_text(BINARY "element vertex 1\n" ALL "end_header\r\n");
    put_floats(9, sample);
    put("trailing bytes are allowed", 26);
    check_sample(0);
    cleanup();
}
END_TEST

START_TEST(binary_types)
{
    static const char *const names[8][2] = {{"char", "int8"},   {"uchar", "uint8"},   {"short", "int16"},
                                            {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                            {"float", "float32"}, {"double", "float64"}};
    static const int sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    static const double values[] = {-100.0, 200.0, -30000.0, 60000.0, -2147483648.0, 4294967040.0, -0.1, 1e-30};
    for (int i = 0; i < 16; i++) {
        const int type = i % 8;
        char header[1024];
        (void)snprintf(header, sizeof header,
                       BINARY "element vertex 1\nproperty %s x\nproperty double y\n%s" DIRECTION POWER "end_header\n",
                       names[type][i / 8], "property float z\n");
        put_text(header);
        if (type < 6)
            put_integer((int64_t)values[type], sizes[type]);
        else if (type == 6)
            put_float((float)values[type]);
        else
            put_double(values[type]);
        put_double(0.25);
        put_floats(7, sample + 2);
        pm_photon *const photons = read_photons(built, built_size, 1);
        ck_assert_float_eq(photons[0].position[0], (float)values[type]);
        check_vector(photons[0].position, (double)(float)values[type], 0.25, 300.0);
        pm_free(photons);
    }
    cleanup();
}
END_TEST

START_TEST(binary_skipping)
{
    put_text(BINARY "element face 2\nproperty uchar flag\nproperty list ushort double corners\nproperty short after\n"
                    "element vertex 2\nproperty list uchar int neighbours\n" ALL "end_header\n");
    put_integer(7, 1);
    put_integer(3, 2);
    for (int i = 0; i < 3; i++)
        put_double(i);
    put_integer(-1, 2);
    put_integer(7, 1);
    put_integer(0, 2);
    put_integer(-1, 2);
    put_integer(0, 1);
    put_floats(9, sample);
    put_integer(2, 1);
    put_integer(123456, 4);
    put_integer(123456, 4);
    put_floats(9, sample);
    check_sample(1);
    cleanup();
}
END_TEST

START_TEST(normals)
{
    static const char text[] = ASCII "element vertex 2\n" ALL NORMAL "end_header\n"
                                     "0 0 0 0 0 1 1 1 1 0 0 3\n0 0 0 0 0 1 1 1 1 3e-30 0 4e-30\n";
    pm_photon *photons;
    float(*n)[3];
    size_t count;
    pm_error error = {""};
    PM_CHECK_OK(pm_ply_read_photons(save(text, sizeof text - 1), &photons, &n, &count, &error), error);
    ck_assert_uint_eq(count, 2);
    check_vector(n[0], 0.0, 0.0, 1.0);
    check_vector(n[1], 0.6, 0.0, 0.8);
    pm_free(photons);
    pm_free(n);
    PM_CHECK_OK(pm_ply_read_photons(save(ONE "0 0 0 0 0 1 1 1 1\n", sizeof ONE + 17), &photons, &n, &count, &error),
                error);
    ck_assert_ptr_null(n);
    pm_free(photons);
    cleanup();
}
END_TEST

START_TEST(points)
{
    static const char text[] = ASCII "element vertex 2\n" NORMAL POSITION "end_header\n0 5 0 1 2 3\n0 0 -1e-3 4 5 6\n";
    pm_surface_point *p;
    size_t count;
    pm_error error = {""};
    PM_CHECK_OK(pm_ply_read_points(save(text, sizeof text - 1), &p, &count, &error), error);
    ck_assert_uint_eq(count, 2);
    check_vector(p[0].position, 1.0, 2.0, 3.0);
    check_vector(p[0].normal, 0.0, 1.0, 0.0);
    check_vector(p[1].normal, 0.0, 0.0, -1.0);
    pm_free(p);
    static const char zero[] = ASCII "element vertex 1\n" NORMAL POSITION "end_header\n0 0 0 1 2 3\n";
    ck_assert_int_eq(pm_ply_read_points(save(zero, sizeof zero - 1), &p, &count, &error), PM_EFORMAT);
    ck_assert_ptr_null(p);
    ck_assert_msg(strstr(error.text, "p.ply, line 11") && strstr(error.text, "vertex 0"), "%s", error.text);
    cleanup();
}
END_TEST

START_TEST(no_vertices)
{
    pm_free(read_photons(ASCII "element vertex 0\n" ALL "end_header\n",
                         sizeof ASCII "element vertex 0\n" ALL "end_header\n" - 1, 0));
    pm_free(read_photons(BINARY "element vertex 0\n" ALL "end_header\n",
                         sizeof BINARY "element vertex 0\n" ALL "end_header\n" - 1, 0));
    cleanup();
}
END_TEST

/* A direction within 1 % of unit length is made unit; one that is unit in float stays bit for bit. */
START_TEST(directions)
{
    pm_photon *photons = read_photons(ONE "0 0 0 0.605 0 0.807 1 1 1\n", sizeof ONE + 25, 1);
    const double length_of = hypot(0.605, 0.807);
    check_vector(photons[0].direction, 0.605 / length_of, 0.0, 0.807 / length_of);
    pm_free(photons);
    cleanup();
}
END_TEST

START_TEST(unreadable)
{
    pm_photon *photons;
    size_t count;
    pm_error error = {""};
    (void)save("", 0);
    char absent[PM__TEST_PATH];
    ck_assert_int_eq(
        pm_ply_read_photons(pm__test_path(&directory, "absent.ply", absent), &photons, NULL, &count, &error), PM_EIO);
    ck_assert_msg(strstr(error.text, absent) && strstr(error.text, "No such file or directory"), "%s", error.text);
    ck_assert_int_eq(pm_ply_read_photons(directory.path, &photons, NULL, &count, &error), PM_EIO);
    ck_assert_msg(strstr(error.text, directory.path) && strstr(error.text, "Is a directory"), "%s", error.text);
    ck_assert_int_eq(pm_ply_read_photons(NULL, &photons, NULL, &count, &error), PM_EINVAL);
    ck_assert_int_eq(pm_ply_read_photons(path, NULL, NULL, &count, &error), PM_EINVAL);
    ck_assert_int_eq(pm_ply_read_points("/dev/null", &(pm_surface_point *){NULL}, &count, NULL), PM_EFORMAT);
    /* Opens, and fails on reading. */
    ck_assert_int_eq(pm_ply_read_photons("/proc/self/mem", &photons, NULL, &count, &error), PM_EIO);
    ck_assert_msg(strstr(error.text, "/proc/self/mem: cannot be read: ") != NULL, "%s", error.text);
    cleanup();
}
END_TEST

/* A pipe that another process writes `count` photons to. */
static void make_pipe(char fifo[PM__TEST_PATH], int count)
{
    (void)save("", 0);
    ck_assert_int_eq(mkfifo(pm__test_path(&directory, "fifo.ply", fifo), 0600), 0);
    if (fork() == 0) {
        FILE *const file = fopen(fifo, "wb");
        (void)fprintf(file, ASCII "element vertex %d\n" ALL NORMAL "end_header\n", count);
        for (int i = 0; i < count; i++)
            (void)fprintf(file, "%d 0 0 0 0 1 1 1 1 0 0 %d\n", i, i + 1);
        (void)fclose(file);
        _exit(0);
    }
}

/* Of unknown size, so the arrays grow as the data come; and of more photons than one buffer holds. */
START_TEST(through_a_pipe)
{
    enum { N = 20000 };
    char fifo[PM__TEST_PATH];
    make_pipe(fifo, N);
    pm_photon *photons;
    float(*n)[3];
    size_t count;
    pm_error error = {""};
    PM_CHECK_OK(pm_ply_read_photons(fifo, &photons, &n, &count, &error), error);
    ck_assert_uint_eq(count, N);
    for (int i = 0; i < N; i++) {
        ck_assert_float_eq(photons[i].position[0], (float)i);
        ck_assert_float_eq(n[i][2], 1.0f);
    }
    pm_free(photons);
    pm_free(n);
    cleanup();
}
END_TEST

/* A vertex is 36 + 12 bytes read, and 52 that the caller will want: 2000 fit into 200,000 bytes. */
START_TEST(within_a_budget)
{
    static const int counts[] = {2000, 2001};
    const pm__ply_budget budget = {.memory = 200000.0, .per_vertex = 52.0};
    for (int i = 0; i < 2; i++) {
        static char text[100000];
        pm_photon *photons;
        float(*n)[3];
        size_t count, used = (size_t)snprintf(text, sizeof text, ASCII "element vertex %d\n" ALL NORMAL "end_header\n",
                                              counts[i]);
        for (int v = 0; v < counts[i]; v++)
            used += (size_t)snprintf(text + used, sizeof text - used, "%d 0 0 0 0 1 1 1 1 0 0 1\n", v);
        pm_error error = {""};
        const pm_status status = pm__ply_read_photons(save(text, used), &budget, &photons, &n, &count, &error);
        ck_assert_int_eq(status, i ? PM_ENOMEM : PM_OK);
        ck_assert((strstr(error.text, "2001 of 2001 vertices take") != NULL) == (i == 1));
        ck_assert((photons != NULL) == (i == 0));
        pm_free(photons);
        pm_free(n);
    }
    /* A pipe's count is a claim: what matters is what comes. */
    char fifo[PM__TEST_PATH];
    make_pipe(fifo, 20000);
    pm_photon *photons;
    size_t count;
    pm_error error = {""};
    ck_assert_int_eq(pm__ply_read_photons(fifo, &budget, &photons, NULL, &count, &error), PM_ENOMEM);
    ck_assert_ptr_null(photons);
    cleanup();
}
END_TEST

/* ---- Writing ---- */

START_TEST(round_trip)
{
    enum { N = 5000 };
    static pm_photon photons[N];
    unsigned state = 1;
    for (int i = 0; i < N; i++) {
        double v[9], sum = 0.0;
        for (int j = 0; j < 9; j++)
            v[j] = (double)(state = state * 1664525U + 1013904223U) / 4294967296.0 - 0.4;
        for (int j = 3; j < 6; j++)
            sum += v[j] * v[j];
        for (int j = 0; j < 3; j++) {
            photons[i].position[j] = (float)(v[j] * 1e6);
            photons[i].direction[j] = (float)(v[3 + j] / sqrt(sum));
            photons[i].power[j] = (float)(v[6 + j] * 1e-6);
        }
    }
    pm_error error = {""};
    (void)save("old", 3);
    PM_CHECK_OK(pm_ply_write_photons(path, photons, N, &error), error);
    pm_photon *got;
    size_t count;
    PM_CHECK_OK(pm_ply_read_photons(path, &got, NULL, &count, &error), error);
    ck_assert_uint_eq(count, N);
    ck_assert_mem_eq(got, photons, sizeof photons);
    pm_free(got);
    PM_CHECK_OK(pm_ply_write_photons(path, NULL, 0, &error), error);
    PM_CHECK_OK(pm_ply_read_photons(path, &got, NULL, &count, &error), error);
    ck_assert_uint_eq(count, 0);
    pm_free(got);
    ck_assert_int_eq(pm_ply_write_photons(path, NULL, 1, &error), PM_EINVAL);
    ck_assert_int_eq(pm_ply_write_photons("/dev/full", photons, N, &error), PM_EIO);
    ck_assert_msg(strstr(error.text, "/dev/full") && strstr(error.text, "No space left"), "%s", error.text);
    ck_assert_int_eq(pm__test_directory_entries(&directory, 0), 1);
    cleanup();
}
END_TEST

/* The bytes themselves: the form that other programs read. */
START_TEST(written_form)
{
    static const char header[] = "ply\nformat binary_little_endian 1.0\nelement vertex 1\n" ALL "end_header\n";
    const pm_photon photon = {{1.0f, 2.0f, -2.0f}, {0.0f, 0.0f, 1.0f}, {0.5f, 0.0f, 0.0f}};
    static const unsigned char record[36] = {0, 0, 0x80, 0x3f, 0, 0, 0, 0x40, 0, 0, 0, 0xc0, 0, 0, 0, 0, 0, 0,
                                             0, 0, 0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f};
    char got[1024];
    (void)save("", 0);
    PM_CHECK_OK(pm_ply_write_photons(path, &photon, 1, NULL), (pm_error){""});
    ck_assert_int_eq(pm__test_read(path, got, sizeof got), (long)(sizeof header - 1 + sizeof record));
    ck_assert_mem_eq(got, header, sizeof header - 1);
    ck_assert_mem_eq(got + sizeof header - 1, record, sizeof record);
    cleanup();
}
END_TEST

PM_TEST_MAIN("ply", ascii_forms, binary_forms, binary_types, binary_skipping, normals, points, no_vertices, directions,
             unreadable, through_a_pipe, within_a_budget, round_trip, written_form)
