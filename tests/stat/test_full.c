/* The method full against the path tracer, by blocks of pixels, by rows of blocks and as
 * a whole: light by paths that have little in common but their
 * ends. Renders of different seeds are the replicates; a block passes within the joint interval of both methods' means,
 * for a false alarm in 1e-6 over all comparisons, and what the estimates may blur. */
#include "../../src/cli/parallel.h"
#include "../../src/stats/stats.h"
#include "../picture.h"

enum { SIDE = 32, BLOCK = 8, ACROSS = SIDE / BLOCK, BLOCKS = ACROSS * ACROSS };
enum { PARTS = BLOCKS + ACROSS + 1, VALUES = 3 * PARTS };
enum { WIDE_K = 100, WIDE_PHOTONS = 2000 }; /* edges are a large part of what is seen */
enum { K = 20, PHOTONS = 10000, COMPARISONS = 6, FEW = 14 };

static const double blurred = 0.01;

/* Of blocks, rows of them, and all, by band: over repeats. */
typedef struct blocks {
    double mean[VALUES], variance[VALUES]; /* of the mean */
    double repeats;
} blocks;

static void add_blocks(const pm__image *image, double sums[VALUES])
{
    const double own = 1.0 / (BLOCK * BLOCK);
    for (size_t p = 0; p < SIDE * SIDE; p++)
        for (size_t b = 0; b < 3; b++) {
            const double value = own * (double)image->values[3 * p + b];
            const size_t row = p / SIDE / BLOCK;
            sums[(row * ACROSS + p % SIDE / BLOCK) * 3 + b] += value;
            sums[(BLOCKS + row) * 3 + b] += value / ACROSS;
            sums[(BLOCKS + ACROSS) * 3 + b] += value / BLOCKS;
        }
}

static void render_blocks(const char *scene, const char *method, size_t repeats, size_t spp, uint64_t seed,
                          bool no_skip, blocks *result)
{
    static size_t threads;
    const pm_parallel parallel = pm__parallel_for(&threads);
    picture *const p = picture_create(scene, method, "disc:last=none");
    double square[VALUES] = {0.0};
    *result = (blocks){{0.0}, {0.0}, (double)repeats};
    p->config.width = p->config.height = SIDE;
    p->config.spp = spp;
    p->config.k = K;
    p->config.photons = PHOTONS;
    p->config.parallel = &parallel;
    p->config.no_skip = no_skip;
    for (uint64_t i = 0; i < repeats; i++) {
        double sums[VALUES] = {0.0};
        p->config.seed = seed + i;
        pm__render_result image = picture_render(p);
        add_blocks(&image.images[0].radiance, sums);
        for (size_t v = 0; v < VALUES; v++) {
            result->mean[v] += sums[v] / result->repeats;
            square[v] += sums[v] * sums[v] / result->repeats;
        }
        pm__render_free(&image);
    }
    for (size_t i = 0; i < VALUES; i++)
        result->variance[i] = fmax(0.0, square[i] - result->mean[i] * result->mean[i]) / (result->repeats - 1.0);
    picture_free(p);
}

static void compare(const char *scene, const char *what, const blocks *a, const blocks *b, double allowed)
{
    for (size_t i = 0; i < VALUES; i++) {
        const double one = a->variance[i], two = b->variance[i], off = a->mean[i] - b->mean[i], error = sqrt(one + two);
        const double freedom = pow(one + two, 2) / (one * one / (a->repeats - 1.0) + two * two / (b->repeats - 1.0));
        const double bound = pm__student_quantile(1.0 - 0.5e-6 / (COMPARISONS * VALUES), freedom);
        ck_assert_msg(fabs(off) <= allowed * b->mean[i] + bound * error, "%s, %s, part %zu, band %zu: %+.2f %% of %g, "
                      "%.1f standard errors", scene, what, i / 3, i % 3, 100.0 * off / b->mean[i], b->mean[i],
                      off / error);
    }
}

START_TEST(full_is_as_path)
{
    static const char *const scenes[] = {"scene:cornell", "scene:cornell-diffuse", "scene:cornell-water"};
    static blocks path, full;
    for (size_t s = 0; s < sizeof scenes / sizeof *scenes; s++) {
        render_blocks(scenes[s], "path", 80, 4, 100, false, &path);
        render_blocks(scenes[s], "full:gather=2", FEW, 4, 200, false, &full);
        compare(scenes[s], "shadow rays", &full, &path, blurred);
        if (s == 1) {
            render_blocks(scenes[s], "full:gather=2,direct=photons", FEW, 4, 300, false, &full);
            compare(scenes[s], "shadow photons", &full, &path, blurred);
        }
    }
}
END_TEST

/* What plain edges lack of an image, averaged over it; the maps are the same, so nearly all noise is common. */
static void render_pairs(double lacking[FEW])
{
    picture *const covered = picture_create("scene:cornell-diffuse", "full:gather=2", "disc:last=none");
    picture *const plain = picture_create("scene:cornell-diffuse", "full:gather=2,edges=plain", "disc:last=none");
    picture *const both[] = {covered, plain};
    for (size_t i = 0; i < FEW; i++) {
        double mean[2];
        for (size_t j = 0; j < 2; j++) {
            both[j]->config.width = both[j]->config.height = SIDE;
            both[j]->config.spp = 4;
            both[j]->config.k = WIDE_K;
            both[j]->config.photons = WIDE_PHOTONS;
            both[j]->config.seed = 800 + i;
            pm__render_result image = picture_render(both[j]);
            mean[j] = picture_mean(&image.images[0].radiance, 1);
            pm__render_free(&image);
        }
        lacking[i] = 1.0 - mean[1] / mean[0];
    }
    picture_free(covered);
    picture_free(plain);
}

/* An estimate with the radius R whose middle is x from a straight edge looks beyond it with the share
 * (acos q - q sqrt(1 - q^2)) / pi of its disc, q = x / R. That is 2 R / (3 pi) when integrated over x, so a square of
 * 1 m with its four edges lacks 8 R / (3 pi) of its light. An image lacks something, and no more than that: what is
 * seen directly lacks nothing, and at the edges of a box the next wall's photons make up for some of it. */
START_TEST(plain_edges_are_dark)
{
    const double pi = 3.14159265358979323846, radius = sqrt(WIDE_K / (pi * WIDE_PHOTONS / 6.0)); /* of 6 m2 */
    double lacking[FEW], sum = 0.0, square = 0.0;
    render_pairs(lacking);
    for (size_t i = 0; i < FEW; i++) {
        sum += lacking[i];
        square += lacking[i] * lacking[i];
    }
    const double mean = sum / FEW, error = sqrt((square / FEW - mean * mean) / (FEW - 1));
    const double bound = pm__student_quantile(1.0 - 0.5e-6, FEW - 1.0) * error;
    ck_assert_msg(mean > bound && mean < 8.0 * radius / (3.0 * pi) + bound, "%.3f %% +- %.3f %% is lacking, at most "
                  "%.3f %% may be", 100.0 * mean, 100.0 * bound, 800.0 * radius / (3.0 * pi));
}
END_TEST

/* The number of rays changes nothing but noise, nor does what the plan skips (but for how sharp caustics are, since
 * other photons are in their map). */
START_TEST(rays_and_plans_keep_the_mean)
{
    static blocks one, other;
    render_blocks("scene:cornell", "full:gather=1", FEW, 2, 400, false, &one);
    render_blocks("scene:cornell", "full:gather=8", FEW, 1, 500, false, &other);
    compare("scene:cornell", "8 rays for 1", &other, &one, 0.0);
    render_blocks("scene:cornell", "full:gather=1", FEW, 2, 600, true, &other);
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
    for (uint64_t seed = 700; seed < 700 + FEW; seed++) {
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
        const double mean = sum[i] / FEW, error = sqrt((square[i] / FEW - mean * mean) / (FEW - 1));
        ck_assert_msg(fabs(mean) <= allowed + pm__student_quantile(1.0 - 0.5e-6 / IMAGES, FEW - 1.0) * error,
                      "%s: %+.3f %% of the truth, %.1f standard errors", names[i], 100.0 * mean / truth, mean / error);
    }
}
END_TEST

PM_TEST_MAIN("full", full_is_as_path, plain_edges_are_dark, rays_and_plans_keep_the_mean, gathered_light_is_unbiased)
