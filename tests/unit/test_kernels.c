/* The kernels' weights and normalisers against closed forms and quadrature. */
#include "../neighborhood.h"

#include <gsl/gsl_integration.h>

static const double pi = 3.14159265358979323846;
static const double alpha = 0.918, beta = 1.953;

static const char *const kernels[] = {"disc",
                                      "cone:k=0.5",
                                      "cone:k=0.9",
                                      "cone:k=1",
                                      "cone",
                                      "cone:k=2",
                                      "gaussian",
                                      "gaussian:form=pavicic",
                                      "gaussian:form=normalised",
                                      "epanechnikov",
                                      "biweight"};
enum { KERNELS = sizeof kernels / sizeof *kernels };

/* ---- Quadrature of the weight -------- */

typedef struct moment {
    const subject *subject;
    int t_power, w_power;
} moment;

static double moment_at(double t, void *context)
{
    const moment *m = context;
    const subject *s = m->subject;
    return pow(t, m->t_power) * pow(s->estimator->weight(s->spec.values, t * t), m->w_power);
}

/* Integral of t^t_power w^w_power over [0, 1]. */
static double integrate(const subject *s, int t_power, int w_power)
{
    moment m = {s, t_power, w_power};
    gsl_function f = {moment_at, &m};
    gsl_integration_workspace *const workspace = gsl_integration_workspace_alloc(200);
    /* the only kinks that there are */
    double points[] = {0.0, 0.5, 0.9, 1.0}, value, error;
    gsl_integration_qagp(&f, points, 4, 1e-13, 1e-12, 200, workspace, &value, &error);
    gsl_integration_workspace_free(workspace);
    return value;
}

START_TEST(test_norm_is_the_integral_of_the_weight)
{
    for (size_t i = 0; i < KERNELS; i++) {
        const subject s = subject_of(kernels[i]);
        if (!strcmp(kernels[i], "gaussian"))
            continue; /* the printed form has none */
        for (int d = 2; d <= 3; d++) {
            /* alpha = 0.918 makes the planar Pavicic form 1/pi to 1.4e-5 only (errata 4) */
            const double tolerance = !strcmp(kernels[i], "gaussian:form=pavicic") && d == 2 ? 5e-6 : 1e-11;
            PM_CHECK_NEAR(s.estimator->norm(s.spec.values, d), d * integrate(&s, d - 1, 1), tolerance);
        }
    }
}
END_TEST

/* Errata, section 3. */
START_TEST(test_kernel_constants)
{
    static const struct {
        const char *name;
        double c, inflation, m2, rim;
    } table[] = {{"disc", 1.0, 1.0, 0.5, 1.0},
                 {"cone:k=1", 1.0 / 3.0, 1.5, 0.3, 0.0},
                 {"cone", 13.0 / 33.0, 1.295858, 0.346154, 1.0 / 11.0},
                 {"cone:k=2", 2.0 / 3.0, 1.03125, 0.45, 0.5},
                 {"gaussian:form=normalised", 0.531154927, 1.1293085, 0.3970036, 0.25115},
                 {"gaussian:form=pavicic", 0.318305663, 1.6527221, 0.2736763, 0.0},
                 {"epanechnikov", 0.5, 4.0 / 3.0, 1.0 / 3.0, 0.0},
                 {"biweight", 1.0 / 3.0, 1.8, 0.25, 0.0}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const subject s = subject_of(table[i].name);
        const double c = 2.0 * integrate(&s, 1, 1);
        PM_CHECK_NEAR(c, table[i].c, 6e-10);
        PM_CHECK_NEAR(2.0 * integrate(&s, 1, 2) / (c * c), table[i].inflation, 6e-7);
        PM_CHECK_NEAR(2.0 * integrate(&s, 3, 1) / c, table[i].m2, 6e-7);
        PM_CHECK_NEAR(s.estimator->weight(s.spec.values, 1.0), table[i].rim, 6e-6);
    }
}
END_TEST

START_TEST(test_norms_in_closed_form)
{
    static const struct {
        const char *name;
        double plane, volume;
    } table[] = {{"disc", 1.0, 1.0},
                 {"cone:k=2", 1.0 - 2.0 / 6.0, 1.0 - 3.0 / 8.0},
                 {"cone:k=1", 1.0 / 3.0, 1.0 / 4.0},
                 {"cone:k=0.9", 0.81 / 3.0, 0.729 / 4.0},
                 {"gaussian", 1.0, 1.0},
                 {"epanechnikov", 0.5, 0.4},
                 {"biweight", 1.0 / 3.0, 8.0 / 35.0}};
    for (size_t i = 0; i < sizeof table / sizeof *table; i++) {
        const subject s = subject_of(table[i].name);
        PM_CHECK_NEAR(s.estimator->norm(s.spec.values, 2), table[i].plane, 1e-15);
        PM_CHECK_NEAR(s.estimator->norm(s.spec.values, 3), table[i].volume, 1e-15);
    }
    const subject s = subject_of("gaussian:form=normalised"), p = subject_of("gaussian:form=pavicic");
    const double e = exp(-beta);
    PM_CHECK_NEAR(s.estimator->norm(s.spec.values, 2), alpha * (1 - (1 - 2 / beta * (1 - exp(-beta / 2))) / (1 - e)),
                  1e-15);
    PM_CHECK_NEAR(p.estimator->norm(p.spec.values, 2), 1 / pi, 1e-16);
    PM_CHECK_NEAR(alpha * (1 / beta - 1 / (exp(beta) - 1)) * pi, 0.9999867, 5e-8);
}
END_TEST

START_TEST(test_weights_in_closed_form)
{
    const subject cone = subject_of("cone:k=2"), narrow_cone = subject_of("cone:k=0.5");
    const subject epanechnikov = subject_of("epanechnikov"), biweight = subject_of("biweight");
    const subject printed = subject_of("gaussian"), pavicic = subject_of("gaussian:form=pavicic");
    const subject normalised = subject_of("gaussian:form=normalised");
    for (int i = 0; i <= 1000; i++) {
        const double t = i / 1000.0, t2 = t * t;
        PM_CHECK_NEAR(cone.estimator->weight(cone.spec.values, t2), 1 - t / 2, 1e-15);
        PM_CHECK_NEAR(cone.estimator->weight(narrow_cone.spec.values, t2), fmax(0, 1 - 2 * t), 1e-15);
        PM_CHECK_NEAR(epanechnikov.estimator->weight(epanechnikov.spec.values, t2), 1 - t2, 1e-15);
        PM_CHECK_NEAR(biweight.estimator->weight(biweight.spec.values, t2), (1 - t2) * (1 - t2), 1e-15);
        const double wide = alpha * (1 - (1 - exp(-beta * t2 / 2)) / (1 - exp(-beta)));
        const double narrow = alpha * (1 - (1 - exp(-beta * t2)) / (1 - exp(-beta)));
        PM_CHECK_NEAR(printed.estimator->weight(printed.spec.values, t2), wide, 5e-14);
        PM_CHECK_NEAR(normalised.estimator->weight(normalised.spec.values, t2), wide, 5e-14);
        PM_CHECK_NEAR(pavicic.estimator->weight(pavicic.spec.values, t2), narrow, 5e-14);
        /* The exponential that the weight is made of, relatively. */
        const double scale = alpha / (1 - exp(-beta));
        const double w = printed.estimator->weight(printed.spec.values, t2);
        PM_CHECK_NEAR((w - alpha + scale) / scale / exp(-beta * t2 / 2), 1.0, 1e-13);
    }
}
END_TEST

START_TEST(test_weight_slopes)
{
    const double step = 1e-5;
    for (size_t i = 0; i < KERNELS; i++) {
        const subject s = subject_of(kernels[i]);
        for (int j = 1; j < 100; j++) {
            const double t = (j + 0.003) / 100.0, a = t - step, b = t + step;
            const double *v = s.spec.values;
            const double slope = (s.estimator->weight(v, b * b) - s.estimator->weight(v, a * a)) / (2 * step);
            PM_CHECK_NEAR(s.estimator->weight_slope(v, t), slope, 1e-8);
        }
    }
}
END_TEST

PM_TEST_MAIN("kernels", test_norm_is_the_integral_of_the_weight, test_kernel_constants, test_norms_in_closed_form,
             test_weights_in_closed_form, test_weight_slopes)
