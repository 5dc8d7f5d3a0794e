/* Errata 21 to 24: the photon record as printed, and as it is here. The printed forms are test-local transcriptions
 * of [C02] 2.1.3; expected sizes of the errors are derived at each test. */
#include "../../src/base/random.h"
#include "../../src/base/vec3.h"
#include "../../src/photonmap.h"

#include "../test.h"

#include <string.h>

enum { N = 200000 };
static const double pi = 3.14159265358979323846;
static const double degrees = 57.29577951308232;
static const double sigmas = 5.5; /* 4e-8 two-sided */

static void uniform_direction(uint64_t number, float direction[3])
{
    double u[2];
    pm__random_uniform(1, PM__FOR_TESTS, 21, number, u, 2);
    const double z = 1.0 - 2.0 * u[0], s = sqrt(1.0 - z * z), phi = 2.0 * pi * u[1];
    direction[0] = (float)(s * cos(phi));
    direction[1] = (float)(s * sin(phi));
    direction[2] = (float)z;
}

/* As printed: 255 levels (errata 22), theta from the component `axis` (errata 21: x). */
static void printed_pack(const float d[3], int axis, unsigned code[2])
{
    code[0] = (unsigned)(255.0 * acos((double)d[axis]) / pi);
    code[1] = (unsigned)(255.0 * (atan2((double)d[1], (double)d[0]) + pi) / (2.0 * pi));
}

/* The inverse of spherical coordinates about z, `inside` of the cell. */
static void printed_unpack(const unsigned code[2], double inside, double d[3])
{
    const double theta = (code[0] + inside) * pi / 255.0, phi = (code[1] + inside) * 2.0 * pi / 255.0 - pi;
    d[0] = sin(theta) * cos(phi);
    d[1] = sin(theta) * sin(phi);
    d[2] = cos(theta);
}

static void packed(const float d[3], pm_packed_photon *p, double back[3])
{
    pm_photon photon = {.direction = {d[0], d[1], d[2]}};
    pm_photon_pack(&photon, p);
    pm_photon_unpack(p, &photon);
    for (int i = 0; i < 3; i++)
        back[i] = (double)photon.direction[i];
}

static double angle(const float a[3], const double v[3])
{
    const double u[3] = {(double)a[0], (double)a[1], (double)a[2]};
    const double cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return atan2(sqrt(pm__dot(cross, cross)), pm__dot(u, v));
}

typedef struct errors {
    double rms, max;
} errors;

/* In degrees, over uniform directions. inside < 0: the library. */
static errors direction_errors(int axis, double inside)
{
    double sum = 0.0, max = 0.0;
    for (uint64_t i = 0; i < N; i++) {
        float d[3];
        double back[3];
        unsigned code[2];
        pm_packed_photon p;
        uniform_direction(i, d);
        printed_pack(d, axis, code);
        if (inside < 0.0)
            packed(d, &p, back);
        else
            printed_unpack(code, inside, back);
        const double e = angle(d, back);
        sum += e * e;
        max = fmax(max, e);
    }
    return (errors){sqrt(sum / N) * degrees, max * degrees};
}

/* acos(dx) with the inverse for z: tens of degrees. And no inverse can help: dz and -dz have one code. */
START_TEST(erratum_21)
{
    const errors printed = direction_errors(0, 0.5), corrected = direction_errors(2, 0.5);
    const errors ours = direction_errors(2, -1.0);
    PM_CHECK_NEAR(printed.rms, 55.0, 0.5);
    ck_assert_double_le(corrected.max, 0.8);
    ck_assert_double_le(ours.rms, 0.395);
    ck_assert_double_le(ours.max, 0.79);
    for (uint64_t i = 0; i < 1000; i++) {
        float d[3];
        unsigned up[2], down[2];
        pm_packed_photon p, q;
        double back[3];
        uniform_direction(i, d);
        d[2] = fabsf(d[2]) + 0.01f;
        const float mirrored[3] = {d[0], d[1], -d[2]};
        printed_pack(d, 0, up);
        printed_pack(mirrored, 0, down);
        ck_assert(up[0] == down[0] && up[1] == down[1]);
        packed(d, &p, back);
        ck_assert_double_gt(back[2], 0.0);
        packed(mirrored, &q, back);
        ck_assert_double_lt(back[2], 0.0);
        ck_assert_uint_ne(p.theta, q.theta);
    }
}
END_TEST

/* Of cells a by 2a (a = pi/255), with the direction anywhere in a cell and E[sin^2 theta] = 2/3, the mean square
 * error is a^2 (1 + 4 (2/3)) / 3 from the cell's edge and a quarter of that from its centre; the largest is the
 * diagonal, and half of it. */
START_TEST(erratum_22_decoding)
{
    const double a = 180.0 / 255.0, b = 180.0 / 256.0, shape = sqrt((1.0 + 8.0 / 3.0) / 3.0);
    const errors edge = direction_errors(2, 0.0), centre = direction_errors(2, 0.5), ours = direction_errors(2, -1.0);
    const double noise = sigmas * 0.001; /* relative, of the root of a mean of 200000 squares */
    PM_CHECK_NEAR(edge.rms / (a * shape), 1.0, noise);
    PM_CHECK_NEAR(edge.max / (a * sqrt(5.0)), 1.0, 0.01);
    PM_CHECK_NEAR(centre.rms / (a * shape / 2.0), 1.0, noise);
    PM_CHECK_NEAR(ours.rms / (b * shape / 2.0), 1.0, noise);
    PM_CHECK_NEAR(ours.max / (b * sqrt(5.0) / 2.0), 1.0, 0.01);
    PM_CHECK_NEAR(edge.rms, 0.780, 0.005);
    PM_CHECK_NEAR(edge.max, 1.576, 0.01);
    PM_CHECK_NEAR(ours.rms, 0.39, 0.005);
    PM_CHECK_NEAR(ours.max, 0.787, 0.005);
}
END_TEST

/* Level 255 belongs to the two single angles pi alone. */
START_TEST(erratum_22_levels)
{
    static unsigned char used[256][256], ours[256][256];
    unsigned printed_count = 0, our_count = 0;
    for (unsigned i = 0; i < 256 * 256; i++) {
        const unsigned centre[2] = {i >> 8, i & 255};
        const double theta = (centre[0] + 0.5) * pi / 256.0, phi = (centre[1] + 0.5) * pi / 128.0 - pi;
        const float d[3] = {(float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)), (float)cos(theta)};
        unsigned code[2];
        pm_packed_photon p;
        double back[3];
        printed_pack(d, 2, code);
        ck_assert_uint_le(code[0] | code[1], 255);
        printed_count += !used[code[0]][code[1]]++;
        packed(d, &p, back);
        our_count += !ours[p.theta][p.phi]++;
    }
    for (uint64_t i = 0; i < N; i++) {
        float d[3];
        unsigned code[2];
        uniform_direction(i, d);
        printed_pack(d, 2, code);
        printed_count += !used[code[0]][code[1]]++;
    }
    for (unsigned i = 0; i < 256; i++)
        ck_assert(!used[255][i] && !used[i][255]);
    ck_assert_uint_le(printed_count, 65025);
    ck_assert_uint_eq(our_count, 65536);
}
END_TEST

/* The front-side test with the decoded direction. With 255 levels the middle cell straddles 90 degrees, and the half
 * of it that is not its decoded side is judged wrongly: sin(pi/510)/2 = 0.31 % of all directions. */
START_TEST(erratum_22_front_side)
{
    unsigned printed_wrong = 0, ours_wrong = 0;
    for (uint64_t i = 0; i < N; i++) {
        float d[3];
        double back[3];
        unsigned code[2];
        pm_packed_photon p;
        uniform_direction(i, d);
        printed_pack(d, 2, code);
        printed_unpack(code, 0.5, back);
        printed_wrong += (back[2] < 0.0) != (d[2] < 0.0f);
        packed(d, &p, back);
        ours_wrong += (back[2] < 0.0) != (d[2] < 0.0f);
    }
    const double expected = sin(pi / 510.0) / 2.0;
    PM_CHECK_NEAR(expected, 0.0031, 0.00005);
    PM_CHECK_NEAR((double)printed_wrong / N, expected, sigmas * sqrt(expected / N));
    ck_assert_uint_eq(ours_wrong, 0);
}
END_TEST

/* The 1996 paper's `char theta, phi`: where char is signed, codes above 127 are negative indices of a table of
 * sines. P(theta code > 127) = (1 + cos(128 pi/255))/2, P(phi code > 127) = 127/255. */
START_TEST(erratum_23)
{
    unsigned negative = 0;
    for (uint64_t i = 0; i < N; i++) {
        float d[3];
        unsigned code[2];
        uniform_direction(i, d);
        printed_pack(d, 2, code);
        for (int j = 0; j < 2; j++) {
            const unsigned char byte = (unsigned char)code[j];
            signed char index;
            memcpy(&index, &byte, 1);
            negative += index < 0;
        }
    }
    const double expected = ((1.0 + cos(128.0 * pi / 255.0)) / 2.0 + 127.0 / 255.0) / 2.0;
    PM_CHECK_NEAR(expected, 0.497, 0.0006);
    PM_CHECK_NEAR(negative / (2.0 * N), expected, sigmas * sqrt(0.25 / (2.0 * N)));
    const pm_packed_photon p = {.theta = 255, .phi = 255};
    ck_assert_int_eq(p.theta, 255);
    ck_assert_int_eq(p.phi, 255);
}
END_TEST

/* Ward's decoding as commonly written: mantissa / 256, the lower end of the code's cell. */
static double printed_power(const uint8_t rgbe[4], int band)
{
    return ldexp((double)rgbe[band], (int)rgbe[3] - 136);
}

/* A quantity whose logarithm is uniform over an octave has mantissas m of density 1/(m ln 2) on [128, 256). The lower
 * end of the cell loses half a step on average: -1/2 E[1/m] = -1/(512 ln 2) = -0.282 %, at most -1/128. The centre
 * leaves a root mean square of sqrt(E[1/m^2]/12) = 0.166 %, at most 1/256, and of the mean only the slope of the
 * density over a cell, below 1e-5. */
START_TEST(erratum_24_largest_band)
{
    double printed = 0.0, ours = 0.0, squares = 0.0, worst = 0.0, largest = 0.0;
    for (int i = 0; i < N; i++) {
        const float power = (float)exp2((i + 0.5) / N);
        pm_photon photon = {.power = {power, 0.1f, 0.3f}};
        pm_packed_photon p;
        pm_photon_pack(&photon, &p);
        pm_photon_unpack(&p, &photon);
        const double was = (double)power, low = printed_power(p.rgbe, 0) / was - 1.0;
        const double centre = (double)photon.power[0] / was - 1.0;
        printed += low / N;
        ours += centre / N;
        squares += centre * centre / N;
        worst = fmin(worst, low);
        largest = fmax(largest, fabs(centre));
    }
    PM_CHECK_NEAR(printed, -1.0 / (512.0 * log(2.0)), 1e-5);
    PM_CHECK_NEAR(printed, -0.0028, 0.00005);
    PM_CHECK_NEAR(worst, -1.0 / 129.0, 1e-4);
    PM_CHECK_NEAR(ours, 0.0, 1e-5);
    PM_CHECK_NEAR(sqrt(squares), sqrt((1.0 / 128.0 / 128.0 - 1.0 / 65536.0) / (24.0 * log(2.0))), 1e-5);
    ck_assert_double_le(largest, 1.0 / 256.0);
}
END_TEST

/* Over colours whose mantissas are spread evenly each band loses half a step, so the sum one and a half; of what
 * is here, none. The standard deviation of a band's error is step/sqrt(12). */
START_TEST(erratum_24_sum)
{
    double printed = 0.0, ours = 0.0;
    for (uint64_t i = 0; i < N; i++) {
        double u[3];
        pm__random_uniform(1, PM__FOR_TESTS, 24, i, u, 3);
        pm_photon photon = {.power = {(float)(1.0 + u[0]), (float)(2.0 * u[1]), (float)(2.0 * u[2])}};
        pm_packed_photon p;
        const float *const power = photon.power;
        const double was = (double)power[0] + (double)power[1] + (double)power[2];
        pm_photon_pack(&photon, &p);
        pm_photon_unpack(&p, &photon);
        printed += printed_power(p.rgbe, 0) + printed_power(p.rgbe, 1) + printed_power(p.rgbe, 2) - was;
        ours += (double)power[0] + (double)power[1] + (double)power[2] - was;
    }
    const double step = 1.0 / 128.0, noise = sigmas * step * sqrt(3.0 / 12.0 / N);
    PM_CHECK_NEAR(printed / N, -1.5 * step, noise);
    PM_CHECK_NEAR(ours / N, 0.0, noise);
}
END_TEST

/* Photons of one power all carry the same error, so no number of them averages it away. */
START_TEST(erratum_24_constant_error)
{
    pm_photon photon = {.power = {128.9f, 0.0f, 0.0f}};
    pm_packed_photon p;
    pm_photon_pack(&photon, &p);
    pm_photon_unpack(&p, &photon);
    PM_CHECK_NEAR(printed_power(p.rgbe, 0) / 128.9 - 1.0, -0.9 / 128.9, 1e-6);
    PM_CHECK_NEAR((double)photon.power[0] / 128.9 - 1.0, -0.4 / 128.9, 1e-6);
}
END_TEST

PM_TEST_MAIN("errata_photon", erratum_21, erratum_22_decoding, erratum_22_levels, erratum_22_front_side, erratum_23,
             erratum_24_largest_band, erratum_24_sum, erratum_24_constant_error)
