/* The method full against the path tracer, by blocks of pixels: light by paths that have little in common but their
 * ends. Renders of different seeds are the replicates; a block passes within the joint interval of both methods' means,
 * for a false alarm in 1e-6 over all comparisons, and what the estimates may lack. An estimate with the radius R within
 * R of a wall's edge looks beyond it: of fixed R that is 8 R / (3 pi) of the light of a square of 1 m on average. It is
 * so of no more than the indirect light, and less where the next wall's photons make up for it. */
#include "../../src/cli/parallel.h"
#include "../../src/stats/stats.h"
#include "../picture.h"

enum { SIDE = 32, BLOCK = 8, ACROSS = SIDE / BLOCK, VALUES = 3 * ACROSS * ACROSS, REPEATS = 14 };
enum { K = 20, PHOTONS = 10000, COMPARISONS = 6 };

/* Sums over blocks, over repeats. */
typedef struct blocks {
    double mean[VALUES], variance[VALUES]; /* of the mean */
} blocks;

static void add_blocks(const pm__image *image, double sums[VALUES])
{
    for (size_t p = 0; p < SIDE * SIDE; p++)
        for (size_t b = 0; b < 3; b++)
            sums[(p / SIDE / BLOCK * ACROSS + p % SIDE / BLOCK) * 3 + b] +=
                (double)image->values[3 * p + b] / (BLOCK * BLOCK);
}

static void render_blocks(const char *scene, const char *method, size_t spp, uint64_t seed, bool no_skip,
                          blocks *result)
{
    static size_t threads;
    const pm_parallel parallel = pm__parallel_for(&threads);
    picture *const p = picture_create(scene, method, "disc:last=none");
    double square[VALUES] = {0.0};
    *result = (blocks){{0.0}, {0.0}};
    p->config.width = p->config.height = SIDE;
    p->config.spp = spp;
    p->config.k = K;
    p->config.photons = PHOTONS;
    p->config.parallel = &parallel;
    p->config.no_skip = no_skip;
    for (uint64_t i = 0; i < REPEATS; i++) {
        double sums[VALUES] = {0.0};
        p->config.seed = seed + i;
        pm__render_result image = picture_render(p);
        add_blocks(&image.images[0].radiance, sums);
        for (size_t v = 0; v < VALUES; v++) {
            result->mean[v] += sums[v] / REPEATS;
            square[v] += sums[v] * sums[v] / REPEATS;
        }
        pm__render_free(&image);
    }
    for (size_t i = 0; i < VALUES; i++)
        result->variance[i] = fmax(0.0, square[i] - result->mean[i] * result->mean[i]) / (REPEATS - 1);
    picture_free(p);
}

static void compare(const char *scene, const char *what, const blocks *a, const blocks *b, double allowed)
{
    /* Welch's degrees of freedom are at least those of either alone. */
    const double bound = pm__student_quantile(1.0 - 0.5e-6 / (COMPARISONS * VALUES), REPEATS - 1.0);
    for (size_t i = 0; i < VALUES; i++) {
        const double error = sqrt(a->variance[i] + b->variance[i]), off = a->mean[i] - b->mean[i];
        ck_assert_msg(fabs(off) <= allowed * b->mean[i] + bound * error, "%s, %s, block %zu, band %zu: %+.2f %% of %g, "
                      "%.1f standard errors", scene, what, i / 3, i % 3, 100.0 * off / b->mean[i], b->mean[i],
                      off / error);
    }
}

/* Of photons over the 6 m2 of a box of 1 m. */
static double lacking(void)
{
    const double pi = 3.14159265358979323846, radius = sqrt(K / (pi * PHOTONS / 6.0));
    return 8.0 * radius / (3.0 * pi);
}

START_TEST(full_is_as_path)
{
    static const char *const scenes[] = {"scene:cornell", "scene:cornell-diffuse", "scene:cornell-water"};
    static blocks path, full;
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++) {
        render_blocks(scenes[s], "path", 16, 100, false, &path);
        render_blocks(scenes[s], "full:gather=2", 4, 200, false, &full);
        compare(scenes[s], "shadow rays", &full, &path, lacking());
        if (s == 1) {
            render_blocks(scenes[s], "full:gather=2,direct=photons", 4, 300, false, &full);
            compare(scenes[s], "shadow photons", &full, &path, lacking());
        }
    }
}
END_TEST

/* The number of rays changes nothing but noise, nor does what the plan skips (but for how sharp caustics are, since
 * other photons are in their map). */
START_TEST(rays_and_plans_keep_the_mean)
{
    static blocks one, other;
    render_blocks("scene:cornell", "full:gather=1", 2, 400, false, &one);
    render_blocks("scene:cornell", "full:gather=8", 1, 500, false, &other);
    compare("scene:cornell", "8 rays for 1", &other, &one, 0.0);
    render_blocks("scene:cornell", "full:gather=1", 2, 600, true, &other);
    compare("scene:cornell", "no_skip", &other, &one, 0.01);
}
END_TEST

/* Gathered light where no edge spoils it: in a furnace of albedo 1/2 a quarter of what is seen. Irradiance that is
 * unbiased at the photons would be 2.1 % dark where it is used (errata 13), so the image 0.5 %; counted with the photon
 * itself it is right to 0.1 %, the front-side filter's share of 0.03 % included. */
START_TEST(gathered_light_is_unbiased)
{
    enum { IMAGES = 2, FURNACE_K = 50, FURNACE_PHOTONS = 100000 };
    static const char *const names[IMAGES] = {"disc:last=none", "hull:boundary=0"};
    static size_t threads;
    const pm_parallel parallel = pm__parallel_for(&threads);
    const double truth = 2.0, allowed = 0.25 * 1e-3 * truth;
    picture *const p = picture_create("scene:furnace:albedo=0.5", "full:gather=64", "disc:last=none,hull:boundary=0");
    double sum[IMAGES] = {0.0}, square[IMAGES] = {0.0};
    p->config.width = p->config.height = SIDE;
    p->config.spp = 1;
    p->config.k = FURNACE_K;
    p->config.photons = FURNACE_PHOTONS;
    p->config.parallel = &parallel;
    for (uint64_t seed = 700; seed < 700 + REPEATS; seed++) {
        p->config.seed = seed;
        pm__render_result result = picture_render(p);
        for (size_t i = 0; i < IMAGES; i++) {
            const double off = picture_mean(&result.images[i].radiance, 0) - truth;
            sum[i] += off;
            square[i] += off * off;
        }
        pm__render_free(&result);
    }
    picture_free(p);
    for (size_t i = 0; i < IMAGES; i++) {
        const double mean = sum[i] / REPEATS, error = sqrt((square[i] / REPEATS - mean * mean) / (REPEATS - 1));
        ck_assert_msg(fabs(mean) <= allowed + pm__student_quantile(1.0 - 0.5e-6 / IMAGES, REPEATS - 1.0) * error,
                      "%s: %+.3f %% of the truth, %.1f standard errors", names[i], 100.0 * mean / truth, mean / error);
    }
}
END_TEST

PM_TEST_MAIN("full", full_is_as_path, rays_and_plans_keep_the_mean, gathered_light_is_unbiased)
