/* Materials: Fresnel's equations against known values, albedos by quadrature against closed forms, and scattering
 * against the BRDF. Bounds on samples are 6 standard deviations: a false alarm once in 5e8 comparisons. */
#include "../../src/base/random.h"
#include "../../src/scene/material.h"
#include "../test.h"

#include <string.h>

static const double pi = 3.14159265358979323846;
static const double up[3] = {0.0, 0.0, 1.0};
static const double roughnesses[] = {1.0, 0.5, 0.1, 0.01, 0.001};
static const double cosines[] = {1.0, 0.8, 0.4, 0.1, 0.03};
enum { ROUGHNESSES = 5, COSINES = 5 };

static pm__material glossy(double diffuse, double specular, double roughness)
{
    return (pm__material){.kind = PM__GLOSSY, .diffuse = {diffuse, diffuse, diffuse},
                          .specular = {specular, specular, specular}, .roughness = roughness};
}

static void at_cosine(double cosine, double turn, double direction[3])
{
    const double sine = sqrt(1.0 - cosine * cosine);
    direction[0] = sine * cos(turn);
    direction[1] = sine * sin(turn);
    direction[2] = cosine;
}

/* ---- Fresnel --------------------------------------------------------------------------------- */

START_TEST(test_fresnel_known_values)
{
    double far;
    PM_CHECK_NEAR(pm__fresnel(1.0, 1.5, &far), 0.04, 1e-15);
    PM_CHECK_NEAR(far, 1.0, 1e-15);
    PM_CHECK_NEAR(pm__fresnel(1.0, 1.0 / 1.5, &far), 0.04, 1e-15);
    /* Brewster's angle, tan = n: one polarisation is not reflected, of the other ((n^2 - 1) / (n^2 + 1))^2. */
    const double rs = 1.25 / 3.25;
    PM_CHECK_NEAR(pm__fresnel(1.0 / sqrt(1.0 + 2.25), 1.5, &far), 0.5 * rs * rs, 1e-15);
    PM_CHECK_NEAR(pm__fresnel(0.0, 1.5, &far), 1.0, 1e-15);
    /* Out of glass: total from the angle of sine 1 / n. */
    const double critical = sqrt(1.0 - 1.0 / 2.25);
    PM_CHECK_NEAR(pm__fresnel(critical - 1e-9, 1.0 / 1.5, &far), 1.0, 0.0);
    PM_CHECK_NEAR(far, 0.0, 0.0);
    ck_assert(pm__fresnel(critical + 1e-6, 1.0 / 1.5, &far) < 0.999);
}
END_TEST

START_TEST(test_fresnel_is_reciprocal)
{
    for (int i = 1; i <= 100; i++) {
        double far, back;
        const double there = pm__fresnel(0.01 * i, 1.33, &far);
        PM_CHECK_NEAR(pm__fresnel(far, 1.0 / 1.33, &back), there, 1e-13);
        PM_CHECK_NEAR(back, 0.01 * i, 1e-13);
    }
}
END_TEST

static double diffuse_reflectance(double eta)
{
    enum { STEPS = 1000000 };
    double sum = 0.0, far;
    for (int i = 0; i < STEPS; i++)
        sum += pm__fresnel(sqrt((i + 0.5) / STEPS), eta, &far); /* 2 c dc = d(c^2) */
    return sum / STEPS;
}

/* Diffuse light inside water and glass: known values. From outside by (1 - inside) n^2 = 1 - outside, which follows
 * from reciprocity and Snell's law. */
START_TEST(test_fresnel_averages)
{
    PM_CHECK_NEAR(diffuse_reflectance(1.0 / 1.5), 0.5963457598, 1e-7);
    PM_CHECK_NEAR(diffuse_reflectance(1.0 / 1.33), 0.4719491488, 1e-7);
    PM_CHECK_NEAR(diffuse_reflectance(1.5), 1.0 - 2.25 * (1.0 - 0.5963457598), 1e-7);
}
END_TEST

/* ---- BRDF ------------------------------------------------------------------------------------ */

START_TEST(test_brdf_is_reciprocal)
{
    for (uint64_t i = 0; i < 2000; i++) {
        double u[5], in[3], out[3], there[3], back[3];
        pm__random_uniform(1, PM__FOR_TESTS, 0, i, u, 5);
        at_cosine(1.0 - u[0], 2.0 * pi * u[1], in);
        at_cosine(1.0 - u[2], 2.0 * pi * u[3], out);
        pm__material material = glossy(0.3, 0.6, u[4]);
        material.printed = i % 2;
        pm__material_brdf(&material, up, in, out, there);
        pm__material_brdf(&material, up, out, in, back);
        PM_CHECK_NEAR(there[1], back[1], 1e-12 * fabs(there[1]));
        ck_assert(there[1] > 0.0);
    }
}
END_TEST

/* The integral of f g cos over what leaves, g = outgoing component (3: 1), for the lobe alone, by half vectors on a
 * grid where the lobe's factor is uniform: with 1 - t^2 = alpha q / (1 - (1 - alpha) q), Z t dh = pi dq dturn / (2 pi),
 * and dout = 4 <in, h> dh. q = 1 - p^2 takes away the 1 / t of facets on edge. */
static double lobe_moment(const pm__material *material, const double in[3], int component)
{
    enum { STEPS = 600 };
    const double alpha = material->roughness;
    double sum = 0.0;
    for (int i = 0; i < STEPS; i++) {
        const double p = (i + 0.5) / STEPS, q = 1.0 - p * p;
        const double sine2 = alpha * q / (1.0 - (1.0 - alpha) * q), t = sqrt(1.0 - sine2);
        for (int j = 0; j < STEPS; j++) {
            double half[3], out[4] = {0.0, 0.0, 0.0, 1.0}, value[3];
            at_cosine(t, 2.0 * pi * (j + 0.5) / STEPS, half);
            const double along = pm__dot(in, half);
            if (!(along > 0.0))
                continue;
            for (int k = 0; k < 3; k++)
                out[k] = 2.0 * along * half[k] - in[k];
            pm__material_brdf(material, up, in, out, value);
            const double w = alpha * t * t + sine2, facets = alpha / (pi * w * w) * t;
            sum += value[0] * fmax(0.0, out[2]) * 4.0 * along / facets * out[component] * 2.0 * p;
        }
    }
    return sum / (STEPS * STEPS);
}

/* At alpha = 1 the lobe is 1 / (pi (1 + v) (1 + v')), whose albedo is 2 (1 - ln 2) / (1 + v). At normal incidence out
 * is at twice the angle of the facet, so with w = v' = 2 t^2 - 1 the albedo is a single integral over t^2. */
START_TEST(test_lobe_albedo_closed_forms)
{
    for (int i = 0; i < COSINES; i++) {
        double in[3];
        at_cosine(cosines[i], 0.4, in);
        const pm__material rough = glossy(0.0, 1.0, 1.0);
        PM_CHECK_NEAR(lobe_moment(&rough, in, 3), 2.0 * (1.0 - log(2.0)) / (1.0 + cosines[i]), 2e-4);
    }
    for (int i = 0; i < ROUGHNESSES; i++) {
        enum { STEPS = 1000000 };
        const double alpha = roughnesses[i];
        double want = 0.0;
        for (int j = 0; j < STEPS; j++) {
            const double s = 0.5 + 0.5 * (j + 0.5) / STEPS, w = 2.0 * s - 1.0, d = 1.0 - (1.0 - alpha) * s;
            want += alpha / (d * d) * 2.0 * w / (w + sqrt(alpha + (1.0 - alpha) * w * w)) / (2.0 * STEPS);
        }
        const pm__material material = glossy(0.0, 1.0, alpha);
        PM_CHECK_NEAR(lobe_moment(&material, up, 3), want, 2e-4);
    }
}
END_TEST

START_TEST(test_glossy_adds_no_light)
{
    for (int i = 0; i < ROUGHNESSES; i++)
        for (int j = 0; j < COSINES; j++) {
            double in[3];
            at_cosine(cosines[j], 0.0, in);
            const pm__material material = glossy(0.0, 1.0, roughnesses[i]);
            const double albedo = lobe_moment(&material, in, 3);
            ck_assert_msg(albedo <= 1.0 + 1e-5 && albedo > 0.3, "alpha %g, cosine %g: %g", roughnesses[i], cosines[j],
                          albedo);
        }
}
END_TEST

/* What the printed formula reflects, as derived apart from this code (erratum 25). */
START_TEST(test_printed_albedo)
{
    static const double want[][3] = {{0.1, 1.0, 4.2}, {0.01, 1.0, 48.0}, {0.01, 0.05, 810.0}};
    for (int i = 0; i < 3; i++) {
        enum { STEPS = 100000 };
        pm__material material = glossy(1.0, 1.0, want[i][0]);
        material.printed = true;
        double in[3], sum = 0.0;
        at_cosine(want[i][1], 0.0, in);
        for (int j = 0; j < STEPS; j++) {
            double out[3], value[3];
            at_cosine((j + 0.5) / STEPS, 1.0, out);
            pm__material_brdf(&material, up, in, out, value);
            sum += 2.0 * pi * value[0] * out[2] / STEPS;
        }
        PM_CHECK_NEAR(sum, want[i][2], 0.02 * want[i][2]);
    }
}
END_TEST

START_TEST(test_sides)
{
    pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {0.5, 0.5, 0.5}, .back = {0.2, 0.2, 0.2}};
    const double down[3] = {0.0, 0.0, -1.0};
    double value[3];
    for (int two_sided = 0; two_sided < 2; two_sided++) {
        wall.two_sided = two_sided;
        pm__material_brdf(&wall, up, up, up, value);
        PM_CHECK_NEAR(value[0], 0.5 / pi, 1e-15);
        pm__material_brdf(&wall, up, down, down, value);
        PM_CHECK_NEAR(value[0], (two_sided ? 0.2 : 0.5) / pi, 1e-15);
        pm__material_brdf(&wall, up, up, down, value);
        PM_CHECK_NEAR(value[0], 0.0, 0.0);
        /* A photon that travels up comes from the back, and stays there. */
        double power[3] = {1.0, 1.0, 1.0}, out[3];
        const double low[3] = {0.0, 0.3, 0.3}, middle[3] = {0.3, 0.3, 0.3};
        ck_assert_int_eq(pm__scatter(&wall, up, up, low, power, out), PM__REFLECTED_DIFFUSE);
        ck_assert(out[2] < 0.0);
        ck_assert_int_eq(pm__scatter(&wall, up, up, middle, power, out),
                         two_sided ? PM__ABSORBED : PM__REFLECTED_DIFFUSE);
    }
}
END_TEST

/* ---- Scattering ------------------------------------------------------------------------------ */

/* Means with their errors, of what samples give. */
typedef struct mean {
    double sum, square;
} mean;

static void add(mean *m, double x)
{
    m->sum += x;
    m->square += x * x;
}

static void check_mean(const mean *m, int count, double want, double slack, const char *what)
{
    const double average = m->sum / count;
    const double error = sqrt(fmax(0.0, m->square / count - average * average) / count);
    ck_assert_msg(fabs(average - want) <= 6.0 * error + slack, "%s: %g, expected %g, error %g", what, average, want,
                  error);
}

/* Power and its mean direction, of the lobe and of the printed formula, as the BRDF says. */
START_TEST(test_glossy_samples_follow_brdf)
{
    enum { SAMPLES = 100000 };
    for (int i = 0; i < ROUGHNESSES; i++)
        for (int j = 0; j < COSINES; j++) {
            const pm__material material = glossy(0.0, 1.0, roughnesses[i]);
            mean means[4] = {{0.0, 0.0}};
            double in[3];
            at_cosine(cosines[j], 0.7, in);
            const double incoming[3] = {-in[0], -in[1], -in[2]};
            for (uint64_t n = 0; n < SAMPLES; n++) {
                double u[3], power[3] = {1.0, 1.0, 1.0}, out[3] = {0.0, 0.0, 0.0};
                pm__random_uniform(2, PM__FOR_TESTS, (uint32_t)(i * COSINES + j), n, u, 3);
                const bool on = pm__scatter(&material, up, incoming, u, power, out) != PM__ABSORBED;
                for (int k = 0; k < 4; k++)
                    add(&means[k], on ? power[0] * (k < 3 ? out[k] : 1.0) : 0.0);
            }
            for (int k = 0; k < 4; k++)
                check_mean(&means[k], SAMPLES, lobe_moment(&material, in, k), 3e-4, "glossy moment");
        }
}
END_TEST

START_TEST(test_printed_samples_follow_brdf)
{
    enum { SAMPLES = 100000, STEPS = 100000 };
    pm__material material = glossy(0.6, 0.4, 0.3);
    material.printed = true;
    const double in[3] = {0.6, 0.0, 0.8}, incoming[3] = {-0.6, 0.0, -0.8};
    double want = 0.0;
    for (int j = 0; j < STEPS; j++) {
        double out[3], value[3];
        at_cosine((j + 0.5) / STEPS, 1.0, out);
        pm__material_brdf(&material, up, in, out, value);
        want += 2.0 * pi * value[0] * out[2] / STEPS;
    }
    mean got = {0.0, 0.0};
    for (uint64_t n = 0; n < SAMPLES; n++) {
        double u[3], power[3] = {1.0, 1.0, 1.0}, out[3];
        pm__random_uniform(3, PM__FOR_TESTS, 0, n, u, 3);
        add(&got, pm__scatter(&material, up, incoming, u, power, out) == PM__ABSORBED ? 0.0 : power[0]);
    }
    check_mean(&got, SAMPLES, want, 1e-6, "printed albedo");
}
END_TEST

/* Erratum 20's material and photon (0.7 + 0.8 > 1), and coloured photons: each band of each part keeps its power. */
START_TEST(test_roulette_is_unbiased_by_band)
{
    enum { SAMPLES = 200000 };
    static const double photons[][3] = {{1.0, 1.0, 1.0}, {0.2, 1.0, 3.0}, {5.0, 0.0, 0.1}, {0.0, 0.0, 1.0}};
    static const double diffuse[3] = {0.7, 0.1, 0.1}, specular[3] = {0.2, 0.8, 0.8};
    pm__material material = {.kind = PM__GLOSSY, .roughness = 0.01};
    memcpy(material.diffuse, diffuse, sizeof diffuse);
    memcpy(material.specular, specular, sizeof specular);
    const pm__material facets = glossy(0.0, 1.0, 0.01);
    const double in[3] = {0.6, 0.0, 0.8}, incoming[3] = {-0.6, 0.0, -0.8}, albedo = lobe_moment(&facets, in, 3);
    for (uint32_t p = 0; p < 4; p++) {
        mean parts[2][3] = {{{0.0, 0.0}}};
        for (uint64_t n = 0; n < SAMPLES; n++) {
            double u[3], power[3], out[3];
            memcpy(power, photons[p], sizeof power);
            pm__random_uniform(4, PM__FOR_TESTS, p, n, u, 3);
            const pm__event event = pm__scatter(&material, up, incoming, u, power, out);
            for (int b = 0; b < 3; b++) {
                add(&parts[0][b], event == PM__REFLECTED_DIFFUSE ? power[b] : 0.0);
                add(&parts[1][b], event == PM__REFLECTED_SPECULAR ? power[b] : 0.0);
            }
        }
        for (int b = 0; b < 3; b++) {
            check_mean(&parts[0][b], SAMPLES, diffuse[b] * photons[p][b], 1e-12, "diffuse");
            check_mean(&parts[1][b], SAMPLES, specular[b] * photons[p][b] * albedo, 3e-4 * photons[p][b], "specular");
        }
    }
}
END_TEST

/* One colour: photons that go on keep their power, and go on with chance albedo. */
START_TEST(test_grey_photons_keep_their_power)
{
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {0.4, 0.4, 0.4}};
    const pm__material mirror = {.kind = PM__MIRROR, .specular = {0.4, 0.4, 0.4}};
    const double incoming[3] = {0.6, 0.0, -0.8}, below[3] = {0.399999, 0.5, 0.5}, above[3] = {0.400001, 0.5, 0.5};
    double power[3] = {2.0, 2.0, 2.0}, out[3];
    ck_assert_int_eq(pm__scatter(&wall, up, incoming, below, power, out), PM__REFLECTED_DIFFUSE);
    ck_assert_int_eq(pm__scatter(&mirror, up, incoming, below, power, out), PM__REFLECTED_SPECULAR);
    PM_CHECK_NEAR(power[2], 2.0, 1e-15);
    PM_CHECK_NEAR(out[0], 0.6, 1e-15);
    PM_CHECK_NEAR(out[2], 0.8, 1e-15);
    ck_assert_int_eq(pm__scatter(&wall, up, incoming, above, power, out), PM__ABSORBED);
    ck_assert_int_eq(pm__scatter(&mirror, up, incoming, above, power, out), PM__ABSORBED);
    double none[3] = {0.0, 0.0, 0.0};
    ck_assert_int_eq(pm__scatter(&wall, up, incoming, below, none, out), PM__ABSORBED);
}
END_TEST

/* Snell's law both ways, total reflection, Beer's law. */
START_TEST(test_glass)
{
    const pm__material glass = {.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}, .absorption = {0.0, 1.0, 2.0}};
    const double incoming[3] = {0.6, 0.0, -0.8}, through[3] = {0.99, 0.5, 0.5}, turned[3] = {0.0, 0.5, 0.5};
    double power[3] = {1.0, 2.0, 3.0}, in[3], out[3];
    ck_assert_int_eq(pm__scatter(&glass, up, incoming, turned, power, out), PM__REFLECTED_SPECULAR);
    PM_CHECK_NEAR(out[2], 0.8, 1e-15);
    ck_assert_int_eq(pm__scatter(&glass, up, incoming, through, power, in), PM__TRANSMITTED);
    PM_CHECK_NEAR(in[0], 0.4, 1e-15);
    PM_CHECK_NEAR(in[2], -sqrt(0.84), 1e-15);
    const double back[3] = {in[0], 0.0, -in[2]};
    ck_assert_int_eq(pm__scatter(&glass, up, back, through, power, out), PM__TRANSMITTED);
    PM_CHECK_NEAR(out[0], 0.6, 1e-15);
    PM_CHECK_NEAR(out[2], 0.8, 1e-15);
    const double flat[3] = {0.8, 0.0, 0.6}; /* sine 0.8 > 1 / 1.5 */
    ck_assert_int_eq(pm__scatter(&glass, up, flat, through, power, out), PM__REFLECTED_SPECULAR);
    PM_CHECK_NEAR(out[2], -0.6, 1e-15);
    PM_CHECK_NEAR(power[2], 3.0, 0.0);
    pm__beer(&glass, 0.5, power);
    PM_CHECK_NEAR(power[0], 1.0, 0.0);
    PM_CHECK_NEAR(power[1], 2.0 * exp(-0.5), 1e-15);
    PM_CHECK_NEAR(power[2], 3.0 * exp(-1.0), 1e-15);
}
END_TEST

/* Each band bends by its own index, and keeps its power on average. */
START_TEST(test_dispersion)
{
    enum { SAMPLES = 100000 };
    const pm__material prism = {.kind = PM__GLASS, .ior = {1.4, 1.5, 1.6}};
    const double incoming[3] = {0.6, 0.0, -0.8};
    mean bands[3] = {{0.0, 0.0}};
    for (uint64_t n = 0; n < SAMPLES; n++) {
        double u[3], power[3] = {1.0, 0.5, 2.0}, out[3], far;
        pm__random_uniform(5, PM__FOR_TESTS, 0, n, u, 3);
        const pm__event event = pm__scatter(&prism, up, incoming, u, power, out);
        int alive = 0;
        for (int b = 0; b < 3; b++) {
            alive += power[b] > 0.0;
            if (power[b] > 0.0 && event == PM__TRANSMITTED)
                PM_CHECK_NEAR(out[0], 0.6 / prism.ior[b], 1e-14);
            add(&bands[b], event == PM__TRANSMITTED ? power[b] / (1.0 - pm__fresnel(0.8, prism.ior[b], &far)) : 0.0);
        }
        ck_assert_int_eq(alive, 1);
    }
    check_mean(&bands[0], SAMPLES, 1.0, 0.0, "red");
    check_mean(&bands[1], SAMPLES, 0.5, 0.0, "green");
    check_mean(&bands[2], SAMPLES, 2.0, 0.0, "blue");
}
END_TEST

START_TEST(test_refusals)
{
    static const struct {
        pm__material material;
        const char *text;
    } cases[] = {
        {{.kind = PM__DIFFUSE, .diffuse = {0.5, 1.25, 0.5}}, "diffuse[1] is 1.25, not within 0 and 1"},
        {{.kind = PM__DIFFUSE, .diffuse = {NAN, 0.5, 0.5}}, "diffuse[0] is nan"},
        {{.kind = PM__DIFFUSE, .two_sided = true, .back = {0.5, 0.5, 2.0}}, "back[2] is 2"},
        {{.kind = PM__MIRROR, .specular = {1.0, 1.0, 1.5}}, "specular[2] is 1.5"},
        {{.kind = PM__GLOSSY, .diffuse = {0.5, 0.5, 0.5}, .specular = {0.6, 0.6, 0.6}}, "diffuse and specular add up"},
        {{.kind = PM__GLOSSY, .two_sided = true, .back = {0.5}, .specular = {0.6}}, "back and specular add up"},
        {{.kind = PM__GLOSSY, .diffuse = {-0.1, 0.5, 0.5}}, "diffuse[0] is -0.1"},
        {{.kind = PM__GLOSSY, .roughness = NAN}, "roughness is nan"},
        {{.kind = PM__GLOSSY, .roughness = 1.5}, "roughness is 1.5"},
        {{.kind = PM__GLASS, .ior = {1.5, 1.5, 0.0}}, "ior[2] is 0"},
        {{.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}, .absorption = {0.0, INFINITY, 0.0}}, "absorption[1] is inf"},
        {{.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}, .outside = {0.0, 0.0, -1.0}}, "outside[2] is -1"},
        {{.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}, .outside = {NAN, 0.0, 0.0}}, "outside[0] is nan"},
        {{.kind = (pm__material_kind)17}, "kind is 17"},
    };
    pm_error error;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        ck_assert_int_eq(pm__material_check(&cases[i].material, &error), PM_EINVAL);
        ck_assert_msg(strstr(error.text, cases[i].text) != NULL, "%zu: \"%s\"", i, error.text);
    }
    const pm__material good = glossy(0.2, 0.8, 0.1);
    PM_CHECK_OK(pm__material_check(&good, &error), error);
}
END_TEST

PM_TEST_MAIN("material", test_fresnel_known_values, test_fresnel_is_reciprocal, test_fresnel_averages,
             test_brdf_is_reciprocal, test_lobe_albedo_closed_forms, test_glossy_adds_no_light, test_printed_albedo,
             test_sides, test_glossy_samples_follow_brdf, test_printed_samples_follow_brdf,
             test_roulette_is_unbiased_by_band, test_grey_photons_keep_their_power, test_glass, test_dispersion,
             test_refusals)
