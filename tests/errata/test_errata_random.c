/* Errata 39: running drand48 a few times does not make the streams of neighbouring photon numbers independent. The
 * generator is affine in its state and the state is affine in the seed, so the draw of photon i + 1 less that of photon
 * i is one constant modulo 1, A^(k) 2^-32 after k draws, for every i: the photons lie on a lattice. */
#include "../test.h"

#include "../../src/base/random.h"

#include <gsl/gsl_cdf.h>
#include <stdint.h>
#include <string.h>

enum { PHOTONS = 40000, CELLS = 20 };

/* What the course has a photon do: seed with its number, drop `skip` draws, take two. */
static void printed(uint32_t photon, int skip, double u[2])
{
    unsigned short state[3] = {0x330e, (unsigned short)photon, (unsigned short)(photon >> 16)}; /* srand48 */
    for (int i = 0; i < skip; i++)
        (void)erand48(state);
    u[0] = erand48(state);
    u[1] = erand48(state);
}

static void ours(uint32_t photon, int skip, double u[2])
{
    (void)skip;
    pm__random_uniform(1, PM__FOR_PHOTONS, 0, photon, u, 2);
}

static double chi_square(void (*draw)(uint32_t photon, int skip, double u[2]), int skip)
{
    double counts[CELLS * CELLS] = {0.0}, chi2 = 0.0;
    const double expected = (double)PHOTONS / (CELLS * CELLS);
    for (uint32_t i = 0; i < PHOTONS; i++) {
        double u[2];
        draw(i, skip, u);
        counts[(int)(u[0] * CELLS) * CELLS + (int)(u[1] * CELLS)]++;
    }
    for (int i = 0; i < CELLS * CELLS; i++)
        chi2 += (counts[i] - expected) * (counts[i] - expected) / expected;
    return chi2;
}

static const int skips[] = {0, 1, 3, 10};

START_TEST(test_drand48_is_a_lattice)
{
    for (int s = 0; s < 4; s++) {
        /* A^(skip + 1) 2^-32 mod 1, A = 0x5deece66d modulo 2^48. */
        uint64_t power = 1;
        for (int i = 0; i <= skips[s]; i++)
            power = power * UINT64_C(0x5deece66d) & UINT64_C(0xffffffffffff);
        const double step = (double)(power & UINT64_C(0xffffffff)) * 0x1p-32;
        double before[2];
        printed(0, skips[s], before);
        for (uint32_t i = 1; i < 1000; i++) {
            double u[2];
            printed(i, skips[s], u);
            const double difference = u[0] - before[0];
            PM_CHECK_NEAR(difference < 0.0 ? difference + 1.0 : difference, step, 1e-15);
            memcpy(before, u, sizeof u);
        }
    }
}
END_TEST

/* Far too even to be random: no skip helps. */
START_TEST(test_drand48_cells)
{
    for (int s = 0; s < 4; s++)
        ck_assert_double_lt(gsl_cdf_chisq_P(chi_square(printed, skips[s]), CELLS * CELLS - 1), 1e-9);
}
END_TEST

/* Counter-based draws: no constant step, and cells as random as they should be (false alarm 1e-8). */
START_TEST(test_ours_is_random)
{
    const double p = gsl_cdf_chisq_P(chi_square(ours, 0), CELLS * CELLS - 1);
    ck_assert(p > 0.5e-8 && p < 1 - 0.5e-8);
    double before[2], steps[20] = {0.0}, chi2 = 0.0;
    ours(0, 0, before);
    for (uint32_t i = 1; i <= PHOTONS; i++) {
        double u[2];
        ours(i, 0, u);
        const double difference = u[0] - before[0];
        steps[(int)(20 * (difference < 0.0 ? fmin(difference + 1.0, 0x1.fffffffffffffp-1) : difference))]++;
        memcpy(before, u, sizeof u);
    }
    for (int i = 0; i < 20; i++)
        chi2 += pow(steps[i] - PHOTONS / 20, 2) / (PHOTONS / 20);
    ck_assert_double_gt(gsl_cdf_chisq_Q(chi2, 19), 1e-8);
}
END_TEST

PM_TEST_MAIN("errata: random numbers", test_drand48_is_a_lattice, test_drand48_cells, test_ours_is_random)
