/* PLY files that are refused, and what the refusal says. */
#include "../../src/photonmap.h"

#include "../ply.h"

static void refuse(const void *text, size_t count, pm_status want, const char *const parts[3])
{
    pm_photon *photons = (pm_photon *)&built_size;
    size_t found = 99;
    pm_error error = {""};
    const pm_status got = pm_ply_read_photons(save(text, count), &photons, NULL, &found, &error);
    ck_assert_msg(got == want, "expected %s, got %s (%s) for:\n%.200s", pm_status_text(want), pm_status_text(got),
                  error.text, (const char *)text);
    ck_assert_ptr_null(photons);
    ck_assert_uint_eq(found, 0);
    ck_assert_msg(strstr(error.text, "p.ply") && !strchr(error.text, '\n'), "%s", error.text);
    for (int i = 0; i < 3 && parts[i]; i++)
        ck_assert_msg(strstr(error.text, parts[i]) != NULL, "no \"%s\" in: %s", parts[i], error.text);
}

typedef struct refusal {
    const char *text;
    pm_status status;
    const char *parts[3];
} refusal;

static void refuse_all(const refusal *refusals, size_t count)
{
    for (size_t i = 0; i < count; i++)
        refuse(refusals[i].text, strlen(refusals[i].text), refusals[i].status, refusals[i].parts);
    cleanup();
}

#define HEADER(vertices, properties) ASCII "element vertex " vertices "\n" properties "end_header\n"
#define WITHOUT_G POSITION DIRECTION "property float r\nproperty float b\n"

START_TEST(bad_headers)
{
    static const refusal refusals[] = {
        {"", PM_EFORMAT, {"line 1", "\"ply\"", "end of the file"}},
        {"pl", PM_EFORMAT, {"line 1", "\"ply\"", "\"pl\""}},
        {"plywood\n", PM_EFORMAT, {"line 1", "\"ply\"", "plywood"}},
        {"\n\nply\n", PM_EFORMAT, {"line 1", "\"ply\""}},
        {"OFF\n3 1 0\n", PM_EFORMAT, {"line 1", "\"ply\"", "\"OFF\""}},
        {"ply\n", PM_EFORMAT, {"line 2", "end_header", "end of the file"}},
        {"ply\nformat ascii 1.0\nelement vertex 1", PM_EFORMAT, {"line 3", "end_header"}},
        {"ply\nformat binary_big_endian 1.0\nend_header\n", PM_EFORMAT,
         {"line 2", "format binary_little_endian 1.0", "\"binary_big_endian\""}},
        {"ply\nformat ascii 2.0\nend_header\n", PM_EFORMAT, {"line 2", "1.0", "\"2.0\""}},
        {"ply\nformat ascii\nend_header\n", PM_EFORMAT, {"line 2", "format ascii 1.0"}},
        {"ply\nend_header\n", PM_EFORMAT, {"line 2", "format"}},
        {"ply\nelement vertex 1\nformat ascii 1.0\nend_header\n", PM_EFORMAT, {"line 2", "format"}},
        {ASCII "format ascii 1.0\nend_header\n", PM_EFORMAT, {"line 3", "once"}},
        {ASCII "end_header\n", PM_EFORMAT, {"line 3", "element vertex"}},
        {ASCII "element face 1\nproperty float x\nend_header\n", PM_EFORMAT, {"element vertex"}},
        {ASCII "elements vertex 1\nend_header\n", PM_EFORMAT, {"line 3", "\"elements\""}},
        {ASCII "\nend_header\n", PM_EFORMAT, {"line 3"}},
        {ASCII "element vertex\nend_header\n", PM_EFORMAT, {"line 3", "element NAME COUNT"}},
        {ASCII "element vertex 1 2\nend_header\n", PM_EFORMAT, {"line 3", "element NAME COUNT"}},
        {ASCII "element vertex -1\nend_header\n", PM_EFORMAT, {"line 3", "whole number", "\"-1\""}},
        {ASCII "element vertex ten\nend_header\n", PM_EFORMAT, {"line 3", "whole number", "\"ten\""}},
        {ASCII "element vertex 1e18\nend_header\n", PM_EFORMAT, {"line 3", "whole number", "\"1e18\""}},
        {ASCII "element vertex 99999999999999999999\nend_header\n", PM_EFORMAT, {"line 3", "whole number"}},
        {ASCII "element vertex 18446744073709551616\nend_header\n", PM_EFORMAT, {"line 3", "whole number"}},
        {HEADER("1073741824", ALL), PM_EFORMAT, {"1073741823", "1073741824"}},
        {HEADER("1000000000000000000", ALL), PM_EFORMAT, {"1073741823"}},
        {HEADER("1000000000", ALL) "1 2 3\n", PM_EFORMAT, {"line 14", "1000000000 vertex", "last 6 bytes"}},
        {HEADER("1", ALL "property float x\n"), PM_EFORMAT, {"line 13", "once", "\"x\""}},
        {ASCII "element vertex 1\n" ALL "element vertex 1\nend_header\n", PM_EFORMAT, {"line 13", "once", "vertex"}},
        {ASCII "property float x\nend_header\n", PM_EFORMAT, {"line 3", "element"}},
        {ASCII "element vertex 1\nproperty x\nend_header\n", PM_EFORMAT, {"line 4", "property TYPE NAME"}},
        {ASCII "element vertex 1\nproperty\nend_header\n", PM_EFORMAT, {"line 4", "property TYPE NAME"}},
        {ASCII "element vertex 1\nproperty real x\nend_header\n", PM_EFORMAT, {"line 4", "a type", "\"real\""}},
        {ASCII "element vertex 1\nproperty list int x\nend_header\n", PM_EFORMAT, {"line 4", "property list"}},
        {ASCII "element vertex 1\nproperty list float int x\nend_header\n", PM_EFORMAT, {"line 4", "integer"}},
        {ASCII "element vertex 1\nproperty list int real x\nend_header\n", PM_EFORMAT, {"line 4", "\"real\""}},
        {HEADER("1", WITHOUT_G) "1 2 3 0 0 1 1 1\n", PM_EFORMAT, {"property g or power_g", "none"}},
        {HEADER("1", POSITION POWER) "1 2 3 0 0 1\n", PM_EFORMAT, {"property dx of", "none"}},
        {HEADER("1", ALL "property float power_g\n"), PM_EFORMAT, {"either g or power_g", "both"}},
        {HEADER("1", "property list uchar float x\nproperty float y\nproperty float z\n" DIRECTION POWER), PM_EFORMAT,
         {"number for property x", "list"}},
        {ASCII "end_header now\n", PM_EFORMAT, {"line 3", "\"now\""}},
    };
    refuse_all(refusals, sizeof refusals / sizeof *refusals);
}
END_TEST

START_TEST(bad_text)
{
    static const refusal refusals[] = {
        {ONE, PM_EFORMAT, {"line 14", "1 vertex", "last 0 bytes"}},
        {ONE "\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n\n", PM_EFORMAT, {"line 33", "x of vertex 0", "end of the file"}},
        {ONE "1 2 3 0 0 1.0 1.0 1.0\n", PM_EFORMAT, {"line 14", "b of vertex 0", "end of the line"}},
        {ONE "1 2 3 0 0 1 1 1 1 1\n", PM_EFORMAT, {"line 14", "end of the line", "\"1\""}},
        {ONE "1 2 3 0 0 1 1 green 1\n", PM_EFORMAT, {"line 14", "g of vertex 0", "\"green\""}},
        {ONE "1 2,3 3 0 0 1 1 1 1\n", PM_EFORMAT, {"line 14", "y of vertex 0", "\"2,3\""}},
        {ONE "1 2 3 0 0 1 1 1 nan\n", PM_ENONFINITE, {"line 14", "b of vertex 0", "nan"}},
        {ONE "-inf 2 3 0 0 1 1 1 1\n", PM_ENONFINITE, {"line 14", "x of vertex 0", "inf"}},
        {ONE "1 1e39 3 0 0 1 1 1 1\n", PM_ENONFINITE, {"line 14", "y of vertex 0", "1e+39"}},
        {ONE "1 1e999 3 0 0 1 1 1 1\n", PM_ENONFINITE, {"line 14", "y of vertex 0"}},
        {ONE "1 2 3 0 0 0 1 1 1\n", PM_EFORMAT, {"line 14: ", "direction dx dy dz", "vertex 0, found one of length 0"}},
        {ONE "1 2 3 0 0 1.02 1 1 1\n", PM_EFORMAT, {"line 14: ", "vertex 0", "length 1.02"}},
        {ONE "1 2 3 0 0 0.98 1 1 1\n", PM_EFORMAT, {"direction", "vertex 0", "length 0.98"}},
        {HEADER("2", ALL) "1 2 3 0 0 1 1 1 1\n0.00000000000000 0\n", PM_EFORMAT, {"line 15", "z of vertex 1"}},
        {ONE "1 \v2 3 0 0 1 1 1 1\n", PM_EFORMAT, {"line 14", "y of vertex 0"}},
        {HEADER("1", ALL "property list uchar int v\n") "1 2 3 0 0 1 1 1 1 2 7\n8\n", PM_EFORMAT,
         {"line 15", "v of vertex 0", "end of the line"}},
        {HEADER("1", ALL "property list uchar int v\n") "1 2 3 0 0 1 1 1 1 1.5 7\n", PM_EFORMAT,
         {"line 15", "length", "found 1.5"}},
        {ASCII "element edge 2\nproperty list int int v\nelement vertex 0\n" ALL "end_header\n-1\n0\n", PM_EFORMAT,
         {"length", "v of edge 0", "-1"}},
        {ASCII "element edge 1\nproperty list int int v\nelement vertex 0\n" ALL "end_header\n4000000000 1 2 3",
         PM_EFORMAT, {"v of edge 0", "end of the file"}},
        {ASCII "element edge 1000000000000000000\nproperty int v\nelement vertex 0\n" ALL "end_header\n1 2 3",
         PM_EFORMAT, {"1000000000000000000 edge", "last 5 bytes"}},
        {ASCII "element edge 1\nproperty int v\nelement vertex 0\n" ALL "end_header\none\n", PM_EFORMAT,
         {"v of edge 0", "\"one\""}},
    };
    refuse_all(refusals, sizeof refusals / sizeof *refusals);
}
END_TEST

START_TEST(bad_binary)
{
    static const char header[] = BINARY "element vertex 2\n" ALL "end_header\n";
    const size_t start = sizeof header - 1;
    for (size_t cut = 0; cut < 72; cut++) {
        put_text(header);
        put_floats(9, sample);
        put_floats(9, sample);
        refuse(built, start + cut, PM_EFORMAT, (const char *const[3]){"byte", "expected 2 vertex", "36 bytes"});
    }
    put_text(header);
    put_floats(9, sample);
    put_floats(7, sample);
    put_float(NAN);
    put_floats(1, sample);
    char place[32];
    (void)snprintf(place, sizeof place, "byte %zu", start + 36 + 32); /* behind the value */
    refuse(built, built_size, PM_ENONFINITE, (const char *const[3]){place, "g of vertex 1", "nan"});
    put_text(BINARY "element vertex 1\nproperty double x\nproperty float y\nproperty float z\n" DIRECTION POWER
                    "end_header\n");
    put_double(-3.5e38);
    put_floats(8, sample + 1);
    refuse(built, built_size, PM_ENONFINITE, (const char *const[3]){"x of vertex 0", "-3.5e+38"});
    put_text(BINARY "element edge 1\nproperty list uint double v\nelement vertex 0\n" ALL "end_header\n");
    put_integer(4294967295, 4);
    refuse(built, built_size, PM_EFORMAT, (const char *const[3]){"v of edge 0", "end of the file"});
    put_text(BINARY "element vertex 1\n" ALL "end_header\n");
    put_floats(3, sample);
    put_float(0.5f);
    put_floats(5, sample + 4);
    (void)snprintf(place, sizeof place, "byte %zu", start);
    refuse(built, built_size, PM_EFORMAT, (const char *const[3]){place, "direction dx dy dz", "vertex 0"});
    put_text(BINARY "element edge 1\nproperty list char double v\nelement vertex 0\n" ALL "end_header\n");
    put_integer(-1, 1);
    refuse(built, built_size, PM_EFORMAT, (const char *const[3]){"length", "v of edge 0", "-1"});
    cleanup();
}
END_TEST

/* Headers without an end, long lines, too many names; a number of 100000 digits. */
START_TEST(oversized)
{
    enum { SIZE = 4 << 20 };
    char *const big = malloc(SIZE);
    ck_assert_ptr_nonnull(big);
    size_t at = (size_t)snprintf(big, SIZE, ASCII "comment ");
    memset(big + at, 'c', SIZE - at);
    refuse(big, SIZE, PM_EFORMAT, (const char *const[3]){"line 3", "4096"});
    for (; at + 8 <= SIZE; at += 8)
        memcpy(big + at, "comment\n", 8);
    refuse(big, SIZE, PM_EFORMAT, (const char *const[3]){"1048576", "end_header"});
    at = (size_t)snprintf(big, SIZE, ASCII);
    for (int i = 0; i < 100; i++)
        at += (size_t)snprintf(big + at, SIZE - at, "element e%d 1\n", i);
    refuse(big, at, PM_EFORMAT, (const char *const[3]){"line 35", "32 elements", "\"e32\""});
    at = (size_t)snprintf(big, SIZE, ASCII "element vertex 1\n");
    for (int i = 0; i < 1000; i++)
        at += (size_t)snprintf(big + at, SIZE - at, "property float p%d\n", i);
    refuse(big, at, PM_EFORMAT, (const char *const[3]){"line 260", "256 properties", "\"p256\""});
    at = (size_t)snprintf(big, SIZE, ASCII "element %0100d 1\n", 1);
    refuse(big, at, PM_EFORMAT, (const char *const[3]){"line 3", "64 characters"});
    at = (size_t)snprintf(big, SIZE, ONE);
    memset(big + at, '1', 100000);
    refuse(big, at + 100000, PM_EFORMAT, (const char *const[3]){"line 14", "x of vertex 0", "111..."});
    free(big);
    cleanup();
}
END_TEST

PM_TEST_MAIN("ply_refusals", bad_headers, bad_text, bad_binary, oversized)
