/* Photons and probes of every case as they are drawn: against the truth, the regions, and the theory of lookups.
 * False alarms: 1e-8 for each chi-square and 1e-10 for each of the counts (there are some 4000), so below 1e-6 in
 * all. */
#include "../case_charts.h"

#include "../../src/base/random.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_integration.h>

enum { PHOTONS = 80000 };

typedef struct photon {
    double position[3], direction[3];
} photon;

static const char *const texts[] = {"square",
                                    "gradient",
                                    "gradient:slope=-1.9",
                                    "quadratic",
                                    "blob",
                                    "sinusoid",
                                    "sinusoid:cycles=2.5,contrast=1",
                                    "edge",
                                    "edge:dark=0.3",
                                    "point-light",
                                    "rect-light",
                                    "rect-light:width=0.3,depth=3,height=0.5",
                                    "corner:irradiance=2,wall=1",
                                    "wall:thickness=0.02",
                                    "sphere",
                                    "volume"};

enum { TEXTS = sizeof texts / sizeof *texts };

static const pm__case *parse(const char *text, pm__spec *spec)
{
    pm_error error;
    PM_CHECK_OK(pm__spec_parse(&pm__cases, text, spec, &error), error);
    return (const pm__case *)(const void *)spec->entry;
}

static void draw(const pm__case *c, const double *values, uint64_t number, photon *p, double normal[3])
{
    double u[4];
    pm__random_uniform(5, PM__FOR_PHOTONS, 0, number, u, c->sample_dimensions);
    c->photon(values, u, p->position, p->direction, normal);
}

/* Chi-square of counts against expected numbers, those below 10 pooled. */
static void check_counts(const char *what, const char *region, const double *counts, const double *expected, int bins)
{
    double chi2 = 0.0, pooled = 0.0, pooled_expected = 0.0;
    int freedom = -1;
    for (int i = 0; i < bins; i++) {
        if (expected[i] < 10.0) {
            ck_assert_msg(expected[i] > 0.0 || counts[i] <= 0.0, "%s %s: %g in a cell of none", what, region,
                          counts[i]);
            pooled += counts[i];
            pooled_expected += expected[i];
            continue;
        }
        chi2 += (counts[i] - expected[i]) * (counts[i] - expected[i]) / expected[i];
        freedom++;
    }
    if (pooled_expected >= 10.0) {
        chi2 += (pooled - pooled_expected) * (pooled - pooled_expected) / pooled_expected;
        freedom++;
    }
    ck_assert_int_ge(freedom, 15);
    ck_assert_msg(gsl_cdf_chisq_Q(chi2, freedom) > 1e-8, "%s %s: chi2 %g of %d", what, region, chi2, freedom);
}

/* ---- Photons are drawn from the irradiance ---- */

/* A grid of cells over the charts. */
enum { SIDE = 24, DEPTH = 6, CELLS = 2 * SIDE * SIDE * DEPTH };

static int depth_of(const pm__case *c)
{
    return c->dimensions == 3 ? DEPTH : 1;
}

static int index_of(double x, int cells)
{
    const int i = (int)(x * cells);
    return i < 0 ? 0 : i >= cells ? cells - 1 : i;
}

/* The truth times the area, integrated over the cell by 4 x 4 Gauss points (a volume's is constant). */
static double cell_power(const pm__case *c, const double *values, int chart, int i, int j, int k,
                         gsl_integration_glfixed_table *table)
{
    double sum = 0.0;
    for (size_t a = 0; a < 4; a++)
        for (size_t b = 0; b < 4; b++) {
            double s, t, ws, wt;
            gsl_integration_glfixed_point((double)i / SIDE, (i + 1.0) / SIDE, a, &s, &ws, table);
            gsl_integration_glfixed_point((double)j / SIDE, (j + 1.0) / SIDE, b, &t, &wt, table);
            pm__probe probe;
            const double st[3] = {s, t, (k + 0.5) / depth_of(c)};
            const double area = pm__chart_point(c, values, chart, st, &probe);
            sum += ws * wt * area * c->truth(values, &probe);
        }
    return sum / depth_of(c);
}

START_TEST(test_photons_follow_the_truth)
{
    gsl_integration_glfixed_table *const table = gsl_integration_glfixed_table_alloc(4);
    static double counts[CELLS], expected[CELLS];
    for (int i = 0; i < TEXTS; i++) {
        pm__spec spec;
        const pm__case *const c = parse(texts[i], &spec);
        const int depth = depth_of(c), bins = pm__chart_count(c) * SIDE * SIDE * depth;
        for (int bin = 0; bin < bins; bin++) {
            counts[bin] = 0.0;
            expected[bin] = PHOTONS / c->power(spec.values) *
                            cell_power(c, spec.values, bin / (SIDE * SIDE * depth), bin / (SIDE * depth) % SIDE,
                                       bin / depth % SIDE, bin % depth, table);
        }
        for (uint64_t n = 0; n < PHOTONS; n++) {
            photon p;
            double normal[3], st[3];
            draw(c, spec.values, n, &p, normal);
            const int chart = pm__chart_locate(c, spec.values, p.position, normal, st);
            const int column = (chart * SIDE + index_of(st[0], SIDE)) * SIDE + index_of(st[1], SIDE);
            counts[column * depth + index_of(st[2], depth)]++;
        }
        check_counts(texts[i], "photons", counts, expected, bins);
    }
    gsl_integration_glfixed_table_free(table);
}
END_TEST

/* ---- Probes are uniform in their regions ---- */

enum { BOX = 30 };

static int probes_of(const pm__case *c)
{
    return c->dimensions == 3 ? 60000 : 20000;
}

typedef struct box {
    int from[2][3], to[2][3]; /* for each chart, in steps of 1 / STEPS */
} box;

enum { STEPS = 240 };

/* A corner of step (i, j) is in the region; the corner is that of the step seen from inside. */
static bool touches(const pm__case *c, const double *values, const char *region, int chart, int i, int j, double depth)
{
    for (int corner = 0; corner < 4; corner++) {
        const double st[3] = {(i + (corner & 1 ? 1.0 - 1e-6 : 1e-6)) / STEPS,
                              (j + (corner & 2 ? 1.0 - 1e-6 : 1e-6)) / STEPS, depth};
        pm__probe probe;
        (void)pm__chart_point(c, values, chart, st, &probe);
        if (pm__in_region(c, values, region, &probe))
            return true;
    }
    return false;
}

/* The steps that the region covers. Most regions end where a step does, so that cells are cut as rarely as may be. */
static box find_box(const pm__case *c, const double *values, const char *region)
{
    box b = {{{STEPS, STEPS, 0}, {STEPS, STEPS, 0}}, {{0, 0, 1}, {0, 0, 1}}};
    for (int chart = 0; chart < pm__chart_count(c); chart++)
        for (int i = 0; i < STEPS; i++)
            for (int j = 0; j < STEPS; j++) {
                const int at[2] = {i, j};
                const bool in = touches(c, values, region, chart, i, j, 0.3);
                for (int d = 0; d < 2 && in; d++) {
                    b.from[chart][d] = at[d] < b.from[chart][d] ? at[d] : b.from[chart][d];
                    b.to[chart][d] = at[d] + 1 > b.to[chart][d] ? at[d] + 1 : b.to[chart][d];
                }
            }
    return b;
}

/* Area of the region in each cell of its boxes, by 20 x 20 points a cell; the sum is made that of the
 * probes. */
static void region_cells(const pm__case *c, const double *values, const char *region, const box *b, double *cells)
{
    enum { FINE = 20 };
    double sum = 0.0;
    const int charts = pm__chart_count(c), depth = depth_of(c);
    memset(cells, 0, sizeof *cells * (size_t)(2 * BOX * BOX * DEPTH));
    for (int chart = 0; chart < charts; chart++)
        for (int i = 0; i < BOX * FINE; i++)
            for (int j = 0; j < BOX * FINE; j++)
                for (int k = 0; k < depth; k++) {
                    const int *const from = b->from[chart], *const to = b->to[chart];
                    const double st[3] = {(from[0] + (to[0] - from[0]) * (i + 0.5) / (BOX * FINE)) / STEPS,
                                          (from[1] + (to[1] - from[1]) * (j + 0.5) / (BOX * FINE)) / STEPS,
                                          (k + 0.5) / depth};
                    if (to[0] <= from[0] || st[0] < 0 || st[0] > 1 || st[1] < 0 || st[1] > 1)
                        continue;
                    pm__probe probe;
                    const double area = (to[0] - from[0]) * (to[1] - from[1]) *
                                        pm__chart_point(c, values, chart, st, &probe);
                    if (!pm__in_region(c, values, region, &probe))
                        continue;
                    cells[((chart * BOX + i / FINE) * BOX + j / FINE) * depth + k] += area;
                    sum += area;
                }
    for (int i = 0; i < 2 * BOX * BOX * DEPTH; i++)
        cells[i] *= probes_of(c) / sum;
}

START_TEST(test_probes_are_uniform)
{
    static double counts[2 * BOX * BOX * DEPTH], expected[2 * BOX * BOX * DEPTH];
    for (size_t i = 0; i < pm__cases.count; i++) {
        const pm__case *const c = pm__test_case(i);
        pm__spec spec;
        pm__spec_default(&c->entry, &spec);
        for (size_t r = 0; r < c->region_count; r++) {
            const box b = find_box(c, spec.values, c->regions[r].name);
            region_cells(c, spec.values, c->regions[r].name, &b, expected);
            memset(counts, 0, sizeof counts);
            for (uint64_t n = 0; n < (uint64_t)probes_of(c); n++) {
                double u[3], st[3];
                pm__probe probe;
                pm__random_uniform(5, PM__FOR_PROBES, (uint32_t)r, n, u, 3);
                c->probe(spec.values, r, u, &probe);
                const int chart = pm__chart_locate(c, spec.values, probe.position, probe.normal, st);
                int at[2];
                for (int d = 0; d < 2; d++)
                    at[d] = index_of((st[d] * STEPS - b.from[chart][d]) / (b.to[chart][d] - b.from[chart][d]), BOX);
                counts[((chart * BOX + at[0]) * BOX + at[1]) * depth_of(c) + index_of(st[2], depth_of(c))]++;
            }
            check_counts(c->entry.name, c->regions[r].name, counts, expected, 2 * BOX * BOX * DEPTH);
        }
    }
}
END_TEST

/* ---- Mass: counting what a lookup accepts ---- */

/* The lookup's distance, or infinity where it does not accept the photon. */
static double distance(const pm__probe *probe, const pm__shape *shape, const photon *p)
{
    if (shape->front_only && !(pm__dot(p->direction, probe->normal) < 0.0))
        return HUGE_VAL;
    double v[3];
    for (int d = 0; d < 3; d++)
        v[d] = p->position[d] - probe->position[d];
    const double height = pm__dot(v, probe->normal), d2 = pm__dot(v, v);
    if (shape->shape == PM_LOOKUP_ELLIPSOID)
        return sqrt(d2 + (shape->parameter * shape->parameter - 1.0) * height * height);
    if (shape->shape == PM_LOOKUP_DISC)
        return fabs(height) <= shape->parameter ? sqrt(fmax(0.0, d2 - height * height)) : HUGE_VAL;
    return sqrt(d2);
}

static const pm__shape shapes[] = {{PM_LOOKUP_SPHERE, 0, false},      {PM_LOOKUP_SPHERE, 0, true},
                                   {PM_LOOKUP_ELLIPSOID, 2.5, false}, {PM_LOOKUP_ELLIPSOID, 2.5, true},
                                   {PM_LOOKUP_DISC, 0.015, false},    {PM_LOOKUP_DISC, 0.015, true}};

static const double radii[] = {0.0, 0.05, 0.12, 0.2}; /* shells between them */

static void check_probe(const char *text, const pm__case *c, const double *values, const photon *photons,
                        const pm__probe *probe)
{
    for (size_t s = 0; s < sizeof shapes / sizeof *shapes; s++) {
        if (isnan(c->mass(values, probe, &shapes[s], 0.0, 0.1)))
            continue;
        unsigned counts[3] = {0, 0, 0};
        for (int n = 0; n < PHOTONS; n++) {
            const double d = distance(probe, &shapes[s], &photons[n]);
            if (d <= radii[3])
                counts[d <= radii[1] ? 0 : d <= radii[2] ? 1 : 2]++;
        }
        for (int k = 0; k < 3; k++) {
            const double share = c->mass(values, probe, &shapes[s], radii[k], radii[k + 1]) / c->power(values);
            ck_assert_msg(
                gsl_cdf_binomial_P(counts[k], fmin(share, 1.0), PHOTONS) > 0.5e-10 &&
                    (counts[k] == 0 || gsl_cdf_binomial_Q(counts[k] - 1, fmin(share, 1.0), PHOTONS) > 0.5e-10),
                "%s at (%g, %g, %g), shape %zu, shell %d: %u photons, expected %g", text, probe->position[0],
                probe->position[1], probe->position[2], s, k, counts[k], share * PHOTONS);
        }
    }
}

START_TEST(test_mass_counts)
{
    static photon photons[PHOTONS];
    for (int i = 0; i < TEXTS; i++) {
        pm__spec spec;
        const pm__case *const c = parse(texts[i], &spec);
        for (uint64_t n = 0; n < PHOTONS; n++) {
            double normal[3];
            draw(c, spec.values, n, &photons[n], normal);
        }
        for (size_t r = 0; r < c->region_count; r++)
            for (uint64_t n = 0; n < 4; n++) {
                double u[3];
                pm__probe probe;
                pm__random_uniform(5, PM__FOR_PROBES, (uint32_t)r, n, u, 3);
                c->probe(spec.values, r, u, &probe);
                check_probe(texts[i], c, spec.values, photons, &probe);
            }
    }
}
END_TEST

PM_TEST_MAIN("photons of the cases", test_photons_follow_the_truth, test_probes_are_uniform, test_mass_counts)
