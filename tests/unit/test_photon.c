/* The 20-byte photon record: its bounds, all of its codes, hostile values. */
#include "../../src/base/random.h"
#include "../../src/base/vec3.h"
#include "../../src/photonmap.h"

#include "../test.h"

#include <float.h>
#include <string.h>

static const double pi = 3.14159265358979323846;

static pm_photon photon_of(double x, double y, double z)
{
    return (pm_photon){.direction = {(float)x, (float)y, (float)z}, .power = {1.0f, 1.0f, 1.0f}};
}

static pm_photon round_trip(const pm_photon *photon)
{
    pm_packed_photon packed;
    pm_photon back;
    pm_photon_pack(photon, &packed);
    pm_photon_unpack(&packed, &back);
    return back;
}

static double angle(const float a[3], const float b[3])
{
    const double u[3] = {(double)a[0], (double)a[1], (double)a[2]}, v[3] = {(double)b[0], (double)b[1], (double)b[2]};
    const double cross[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
    return atan2(sqrt(pm__dot(cross, cross)), pm__dot(u, v));
}

START_TEST(record)
{
    ck_assert_uint_eq(sizeof(pm_packed_photon), 20);
    const pm_photon photon = {.position = {1.0f / 3.0f, -0.0f, -FLT_MAX}, .direction = {0.0f, 0.0f, 1.0f}};
    pm_packed_photon packed;
    memset(&packed, 0xff, sizeof packed);
    pm_photon_pack(&photon, &packed);
    ck_assert_mem_eq(packed.position, photon.position, sizeof photon.position);
    ck_assert_uint_eq(packed.flags, 0);
    const pm_photon back = round_trip(&photon);
    ck_assert_mem_eq(back.position, photon.position, sizeof photon.position);
}
END_TEST

/* Within a cell theta and phi are nearly uniform and independent: mean square error
 * (pi/256)^2/12 + (2 pi/256)^2/12 E[sin^2 theta], E = 2/3; at most half the cell's diagonal. */
START_TEST(direction_error)
{
    enum { N = 200000 };
    double sum = 0.0, largest = 0.0;
    for (uint64_t i = 0; i < N; i++) {
        double u[2];
        pm__random_uniform(1, PM__FOR_TESTS, 0, i, u, 2);
        const double z = 1.0 - 2.0 * u[0], s = sqrt(1.0 - z * z), phi = 2.0 * pi * u[1];
        const pm_photon photon = photon_of(s * cos(phi), s * sin(phi), z), back = round_trip(&photon);
        const double e = angle(photon.direction, back.direction);
        sum += e * e;
        largest = fmax(largest, e);
    }
    const double cell = pi / 256.0, rms = cell * sqrt((1.0 + 4.0 * 2.0 / 3.0) / 12.0);
    /* The mean of 200000 squares has a relative standard deviation below 0.2 %; the root halves it. */
    PM_CHECK_NEAR(sqrt(sum / N) / rms, 1.0, 5.5 * 0.001);
    ck_assert_double_le(largest, hypot(cell / 2.0, cell) * (1.0 + 1e-6));
    ck_assert_double_ge(largest, 0.98 * hypot(cell / 2.0, cell));
}
END_TEST

/* Every direction code comes back, so each of the 65536 cells holds its own centre. */
START_TEST(direction_codes)
{
    for (unsigned code = 0; code < 65536; code++) {
        const pm_packed_photon packed = {.theta = (uint8_t)(code >> 8), .phi = (uint8_t)code};
        pm_photon photon;
        pm_packed_photon again;
        pm_photon_unpack(&packed, &photon);
        pm_photon_pack(&photon, &again);
        ck_assert_uint_eq((unsigned)again.theta << 8 | again.phi, code);
        const double v[3] = {(double)photon.direction[0], (double)photon.direction[1], (double)photon.direction[2]};
        PM_CHECK_NEAR(pm__dot(v, v), 1.0, 4.0 * (double)FLT_EPSILON);
        PM_CHECK_NEAR(acos(v[2]), (packed.theta + 0.5) * pi / 256.0, 3e-5);
    }
}
END_TEST

START_TEST(hostile_directions)
{
    const float values[] = {0.0f, -0.0f, 1.0f, -1.0f, 1e-40f, FLT_MAX, -FLT_MAX, INFINITY, -INFINITY, NAN};
    enum { N = sizeof values / sizeof *values };
    for (int i = 0; i < N * N * N; i++) {
        pm_photon photon = {.direction = {values[i % N], values[i / N % N], values[i / N / N]}};
        const pm_photon back = round_trip(&photon);
        const double v[3] = {(double)back.direction[0], (double)back.direction[1], (double)back.direction[2]};
        PM_CHECK_NEAR(pm__dot(v, v), 1.0, 4.0 * (double)FLT_EPSILON);
    }
    const pm_photon unit = photon_of(0.6, -0.48, 0.64), scaled = photon_of(0.6e30, -0.48e30, 0.64e30);
    pm_packed_photon a, b;
    pm_photon_pack(&unit, &a);
    pm_photon_pack(&scaled, &b);
    ck_assert_uint_eq(a.theta, b.theta);
    ck_assert_uint_eq(a.phi, b.phi);
}
END_TEST

/* 1 part in 256 of the largest band: half of one step of 1/128. */
START_TEST(power_error)
{
    for (uint64_t i = 0; i < 100000; i++) {
        double u[4];
        pm__random_uniform(2, PM__FOR_TESTS, 0, i, u, 4);
        const double scale = pow(10.0, -37.9 + 76.0 * u[3]);
        const double green = u[1] * u[1] * u[1];
        const pm_photon photon = {.power = {(float)(u[0] * scale), (float)(green * scale), (float)(u[2] * scale)}};
        const float *const p = photon.power;
        const double largest = (double)fmaxf(p[0], fmaxf(p[1], p[2]));
        if (largest < 1e-38 || largest >= 0x1p127)
            continue;
        const pm_photon back = round_trip(&photon);
        for (int band = 0; band < 3; band++)
            PM_CHECK_NEAR((double)back.power[band], (double)p[band], largest / 256.0 * (1.0 + 1e-6));
    }
}
END_TEST

/* Evenly spread mantissas: the mean error of a band is 0, of the largest band and of a lesser one. */
START_TEST(power_unbiased)
{
    enum { N = 1 << 16 };
    double largest = 0.0, lesser = 0.0;
    for (int i = 0; i < N; i++) {
        const double even = (i + 0.5) / N;
        const pm_photon photon = {.power = {(float)(1.0 + even), 1.5f, 1.0f}}, back = round_trip(&photon);
        const pm_photon dim = {.power = {1.5f, (float)even, 1.0f}}, dim_back = round_trip(&dim);
        largest += (double)back.power[0] - (double)photon.power[0];
        lesser += (double)dim_back.power[1] - (double)dim.power[1];
    }
    PM_CHECK_NEAR(largest / N, 0.0, 1e-7);
    PM_CHECK_NEAR(lesser / N, 0.0, 1e-7);
}
END_TEST

/* Every code that pack can make comes back. */
START_TEST(power_codes)
{
    for (unsigned exponent = 3; exponent < 256; exponent++)
        for (unsigned mantissa = 128; mantissa < 256; mantissa++) {
            const pm_packed_photon packed = {
                .rgbe = {(uint8_t)(255 - mantissa), (uint8_t)mantissa, 0, (uint8_t)exponent}};
            pm_photon photon;
            pm_packed_photon again;
            pm_photon_unpack(&packed, &photon);
            PM_CHECK_NEAR((double)photon.power[1] / ldexp(mantissa + 0.5, (int)exponent - 136), 1.0, 1e-6);
            pm_photon_pack(&photon, &again);
            ck_assert_mem_eq(again.rgbe, packed.rgbe, 4);
        }
}
END_TEST

static void check_power(float r, float g, float b, double want_r, double want_g, double want_b, double tolerance)
{
    const pm_photon photon = {.power = {r, g, b}}, back = round_trip(&photon);
    PM_CHECK_NEAR((double)back.power[0], want_r, tolerance * fabs(want_r));
    PM_CHECK_NEAR((double)back.power[1], want_g, tolerance * fabs(want_g));
    PM_CHECK_NEAR((double)back.power[2], want_b, tolerance * fabs(want_b));
}

START_TEST(hostile_powers)
{
    const double half_step = 0.5 / 128.0;
    check_power(0.0f, 0.0f, 0.0f, 0.0, 0.0, 0.0, 0.0);
    check_power(-1.0f, NAN, INFINITY, 0.0, 0.0, 0.0, 0.0);
    check_power(9.9e-39f, 1e-40f, 0.0f, 0.0, 0.0, 0.0, 0.0);
    check_power(1.0f, 0.0f, -5.0f, 1.0 + half_step, half_step, half_step, 1e-6);
    check_power(1.0f, -INFINITY, NAN, 1.0 + half_step, half_step, half_step, 1e-6);
    const double top = 255.5 * 0x1p119, step = 0x1p119;
    check_power(FLT_MAX, 0x1p127f, 0x1p126f, top, top, 0x1p126 + step / 2.0, 1e-6);
    check_power(1.2e-38f, 0.0f, 0.0f, 1.2e-38, 0x1p-134, 0x1p-134, 0.004);
}
END_TEST

PM_TEST_MAIN("photon", record, direction_error, direction_codes, hostile_directions, power_error, power_unbiased,
             power_codes, hostile_powers)
