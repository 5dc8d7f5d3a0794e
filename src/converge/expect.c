/* What theory expects of a run's answer at each point.
 *
 * A pass looks up independent photons, as many as are emitted, of which a disc of radius r about a point holds each
 * with the probability mass(r) / power: the mean and variance of its estimate follow exactly (law.h). Passes are
 * independent but for their radii, which are taken as they are where photons are as dense in every pass: the share of
 * the first disc's area that the schedule says. So after i passes
 *     bias = (1/i) sum of the passes' biases,   variance = (1/i^2) sum of their variances.
 * One map of the photons of all passes has the law of one lookup, with that many photons. Both are smooth in the share,
 * so the law is worked out at some shares and read off between.
 *
 * Where points are drawn anew, the mean and variance of one pass are those over the ways through mirrors and glass
 * too, of which some reach no surface: a radius that shrinks by what is found does so in passes that find one alone.
 * Where in the pixel a pass has its sample is left out: passes are stratified there, so that what this adds to the
 * variance falls faster than the rest. */
#include "measure.h"

#include "../accuracy/law.h"
#include "../base/memory.h"
#include "../base/parallel.h"

#include <math.h>
#include <stdatomic.h>
#include <stdlib.h>

enum { POINTS = 16, SHARES = 12, DRAWN = 8, NODES = PM__MOST_RECORDS };

#define LAW_SEED 0x6c6177ull

/* The law of one lookup at a point, by node: of a pass by the share of the first disc; of all photons by record. */
typedef struct one_lookup {
    double bias[NODES], variance[NODES]; /* W/(m2 sr), and its square */
    double reached; /* the share of a pixel's points that reach a surface */
} one_lookup;

typedef struct expecting {
    const pm__progression *of;
    const pm__progressive *method;
    pm__law_rule rule;
    pm__kernel_law kernel;
    double power;       /* W in a band, of what is emitted */
    const uint32_t *passes;
    size_t records;
    size_t nodes;
    double shares[NODES];  /* of the first disc's area, from 1 downward; of lookups that do not shrink 1 alone */
    size_t k[NODES], photons[NODES]; /* k 0: all within the share */
    pm__expectation *to;
    _Atomic bool canceled;
} expecting;

/* ---- One pass at one point --------------------------------------------------------------------- */

static pm__probe probe_of(const pm__hit_point *point)
{
    pm__probe probe;
    for (int a = 0; a < 3; a++) {
        probe.position[a] = point->position[a];
        probe.normal[a] = point->normal[a];
        probe.outgoing[a] = point->outgoing[a];
    }
    return probe;
}

/* The probability that a photon lies within r0 and r1; NAN: not known. */
static double share_between(const expecting *e, const pm__probe *probe, double r0, double r1)
{
    const pm__shape shape = {PM_LOOKUP_SPHERE, 0.0, e->of->config->front_only};
    return e->of->stage.subject->mass(e->of->stage.values, probe, &shape, r0, r1) / e->power;
}

/* Far enough for k photons of so many. */
static double reach_for(const expecting *e, const pm__probe *probe, size_t k, size_t photons)
{
    const double wanted = fmin(1.0, exp(pm__largest_log_p(k, photons)));
    double reach = 1e-3;
    while (reach < 1e6 && share_between(e, probe, 0.0, reach) < wanted)
        reach *= 1.5;
    return reach;
}

/* p(s) up to `reach`, as p/s^2, which is smooth where light is. */
static bool tabulate(const expecting *e, const pm__probe *probe, double reach, pm__radial *radial)
{
    double sum = 0.0, before = 0.0;
    radial->dimensions = 2;
    radial->reach = reach;
    for (int i = 1; i <= PM__LAW_CELLS; i++) {
        const double s = reach * i / PM__LAW_CELLS;
        sum += share_between(e, probe, before, s);
        radial->ratio[i] = sum / (s * s);
        before = s;
    }
    radial->ratio[0] = fmax(0.0, 3.0 * radial->ratio[1] - 3.0 * radial->ratio[2] + radial->ratio[3]);
    radial->total = sum;
    return isfinite(sum) && reach > 0.0;
}

/* Of pooled lookups: the flux expected over the area expected, and the variance of one lookup's part in it. Kernels
 * other than the disc weigh photons by a radius that differs: not known. */
static pm__moments pooled_moments(const expecting *e, const pm__law_grid *grid, size_t k, double flux)
{
    double area = 0.0, square = 0.0;
    for (size_t i = 0; i < grid->count; i++) {
        const double a = 3.14159265358979323846 * grid->radius[i] * grid->radius[i];
        area += grid->probability[i] * a;
        square += grid->probability[i] * a * a;
    }
    if (e->kernel.rim != 1.0 || e->kernel.norm != 1.0)
        return (pm__moments){NAN, NAN};
    const double mean = ((double)k - 1.0 + e->kernel.last) * flux / area;
    return (pm__moments){mean, mean * mean * (square / (area * area) - 1.0)};
}

/* Irradiance's moments at each node. */
static bool look_at(const expecting *e, const pm__hit_point *point, double first_radius, pm__moments moments[NODES])
{
    const pm__probe probe = probe_of(point);
    pm__radial radial;
    if (isnan(share_between(e, &probe, 0.0, 1e-3)) ||
        !tabulate(e, &probe, e->k[0] ? reach_for(e, &probe, e->k[0], e->photons[0]) : first_radius, &radial))
        return false;
    for (size_t n = 0; n < e->nodes; n++) {
        pm__law_grid grid;
        const double radius = e->k[n] ? INFINITY : first_radius * sqrt(e->shares[n]);
        const double flux = e->power / (double)e->photons[n];
        if (!pm__law_grid_init(&grid, &e->rule, true, &radial, e->k[n], e->photons[n], radius))
            return false;
        moments[n] = e->method->law == PM__LAW_POOLED ? pooled_moments(e, &grid, e->k[n], flux)
                                                      : pm__kernel_moments(&e->kernel, &grid, flux);
        if (isnan(moments[n].mean))
            return false;
    }
    return true;
}

/* Adds one of `drawn` points of a pixel to sums of the mean, its square and the variance. */
static bool add_point(const expecting *e, const pm__hit_point *point, double first_radius, double drawn,
                      one_lookup *sums, double squares[NODES], double *truth)
{
    pm__moments moments[NODES];
    double exact[3], brdf[3];
    if (!point->material)
        return true;
    pm__point_truth(e->of, point, exact);
    if (point->material->kind != PM__DIFFUSE || !isfinite(exact[0]) || !look_at(e, point, first_radius, moments))
        return false;
    pm__hit_point_brdf(point, point->normal, brdf);
    const double worth = point->weight[0] * brdf[0];
    *truth += (exact[0] - point->emitted[0]) / drawn;
    sums->reached += 1.0 / drawn;
    for (size_t n = 0; n < e->nodes; n++) {
        const double mean = worth * moments[n].mean;
        sums->bias[n] += mean / drawn;
        squares[n] += mean * mean / drawn;
        sums->variance[n] += worth * worth * moments[n].variance / drawn;
    }
    return true;
}

/* Is the law known all over the pixel? */
static bool is_lawful_around(const expecting *e, size_t i)
{
    for (uint32_t s = 0; s < DRAWN; s++) {
        pm__eye eye;
        pm__hit_point point;
        pm__run_eye(e->of, e->of->config->seed ^ LAW_SEED, s, i, false, &eye);
        pm__hit_point_follow(&eye, &point);
        const pm__probe probe = probe_of(&point);
        if (point.material && !isfinite(share_between(e, &probe, 0.0, fmax((double)e->of->radius[i], 1e-3))))
            return false;
    }
    return true;
}

static bool find_law(const expecting *e, size_t i, one_lookup *law)
{
    const bool redraws = e->method->redraws;
    const uint32_t drawn = redraws ? DRAWN : 1;
    double squares[NODES] = {0.0}, truth = 0.0;
    *law = (one_lookup){.reached = 0.0};
    if (redraws && !is_lawful_around(e, i))
        return false;
    for (uint32_t s = 0; s < drawn; s++) {
        pm__hit_point point = e->of->fixed[i];
        if (redraws) {
            pm__eye eye;
            pm__run_eye(e->of, e->of->config->seed ^ LAW_SEED, s, i, true, &eye);
            pm__hit_point_follow(&eye, &point);
        }
        if (!add_point(e, &point, (double)e->of->radius[i], drawn, law, squares, &truth))
            return false;
    }
    for (size_t n = 0; n < e->nodes; n++) {
        const double among = drawn > 1 ? drawn / (drawn - 1.0) : 0.0; /* unbiased over the few points */
        law->variance[n] += among * fmax(0.0, squares[n] - law->bias[n] * law->bias[n]);
        law->bias[n] -= truth;
    }
    return law->reached > 0.0;
}

/* ---- Many passes ------------------------------------------------------------------------------- */

/* Between nodes bias / share and variance * share hardly change; nodes are even in the logarithm. */
static void read_law(const expecting *e, const one_lookup *law, double share, double *bias, double *variance)
{
    if (e->nodes == 1) {
        *bias = law->bias[0];
        *variance = law->variance[0];
        return;
    }
    const double end = log(e->shares[e->nodes - 1]);
    const double x = fmin(fmax(log(share) / end, 0.0), 1.0) * (double)(e->nodes - 1);
    const size_t n = (size_t)fmin(x, (double)(e->nodes - 2));
    const double f = x - (double)n;
    *bias = share * ((1.0 - f) * law->bias[n] / e->shares[n] + f * law->bias[n + 1] / e->shares[n + 1]);
    *variance = ((1.0 - f) * law->variance[n] * e->shares[n] + f * law->variance[n + 1] * e->shares[n + 1]) / share;
}

static double share_of(const expecting *e, double pass)
{
    const pm__progressive_config *const c = e->of->config;
    return e->method->schedule ? e->method->schedule(c->method->values, c->alpha, pass) : 1.0;
}

/* How many passes from this one on share a value: of later ones the share hardly changes from one to the next. */
static uint32_t stride_at(uint32_t pass)
{
    return pass < 128 ? 1 : pass / 64;
}

static void take_records(const expecting *e, const one_lookup *law, size_t i)
{
    for (size_t r = 0; r < e->records; r++) {
        e->to->bias[r * e->of->points + i] = law->bias[r];
        e->to->variance[r * e->of->points + i] = law->variance[r];
    }
}

static void sum_passes(const expecting *e, const one_lookup *law, size_t i)
{
    const size_t points = e->of->points;
    double bias = 0.0, variance = 0.0;
    uint32_t pass = 0;
    for (size_t r = 0; r < e->records; r++) {
        while (pass < e->passes[r]) {
            const uint32_t left = e->passes[r] - pass, stride = stride_at(pass), some = stride < left ? stride : left;
            double b, v;
            read_law(e, law, share_of(e, law->reached * (pass + 0.5 * (some - 1.0))), &b, &v);
            bias += some * b;
            variance += some * v;
            pass += some;
        }
        e->to->bias[r * points + i] = bias / pass;
        e->to->variance[r * points + i] = variance / ((double)pass * pass);
    }
}

static void expect_block(void *argument, size_t block)
{
    expecting *const e = argument;
    const pm__progressive_config *const config = e->of->config;
    if (config->canceled && config->canceled(config->context)) {
        atomic_store(&e->canceled, true);
        return;
    }
    for (size_t i = block * POINTS; i < (block + 1) * POINTS && i < e->of->points; i++) {
        one_lookup law;
        for (size_t r = 0; r < e->records; r++)
            e->to->bias[r * e->of->points + i] = e->to->variance[r * e->of->points + i] = NAN;
        e->to->lawful[i] = find_law(e, i, &law);
        if (!e->to->lawful[i])
            continue;
        if (e->method->law == PM__LAW_GROWING)
            take_records(e, &law, i);
        else
            sum_passes(e, &law, i);
    }
}

/* ---- All points -------------------------------------------------------------------------------- */

/* Are all photons alike, bands too, independent, and the light's law known? */
static bool has_law(expecting *e)
{
    const pm__progressive_config *const config = e->of->config;
    const pm__case *const subject = e->of->stage.subject;
    const pm__spec *const spec = &config->estimator->spec;
    const pm__variant kernel = {.spec = spec, .estimator = pm__estimator_of(spec)};
    const pm__progress_law law = e->method->law;
    pm__law_rule_init(&e->rule);
    for (size_t i = 0; i < pm__scene_light_count(e->of->stage.scene); i++)
        e->power += pm__scene_light_at(e->of->stage.scene, i)->power[0];
    return law != PM__LAW_UNKNOWN && law != PM__LAW_UNBIASED && subject->truth &&
           subject->mass && !subject->truth_bands && !subject->brdf && subject->dimensions == 2 &&
           (!config->sampler || config->sampler->independent) && pm__kernel_law_init(&e->kernel, &e->rule, &kernel, 2);
}

static void set_nodes(expecting *e)
{
    const pm__progressive_config *const config = e->of->config;
    const bool shrinking = e->method->law == PM__LAW_SHRINKING, growing = e->method->law == PM__LAW_GROWING;
    const double end = fmin(share_of(e, (double)e->passes[e->records - 1]), 0.999);
    e->nodes = shrinking ? SHARES : growing ? e->records : 1;
    for (size_t n = 0; n < e->nodes; n++) {
        e->shares[n] = shrinking ? pow(end, (double)n / (SHARES - 1.0)) : 1.0;
        e->k[n] = shrinking ? 0 : growing ? e->method->photons_of(config, e->passes[n]) : config->k;
        e->photons[n] = config->photons * (growing ? e->passes[n] : 1);
    }
}

pm_status pm__expectation_create(const pm__progression *progression, const uint32_t *passes, size_t records,
                                 pm__expectation *expectation, pm_error *error)
{
    const size_t points = progression->points;
    *expectation = (pm__expectation){.lawful = NULL};
    expecting e = {.of = progression,
                   .method = (const pm__progressive *)(const void *)progression->config->method->entry,
                   .passes = passes,
                   .records = records,
                   .to = expectation};
    if (!has_law(&e))
        return PM_OK;
    set_nodes(&e);
    expectation->lawful = pm__alloc_zero(points, sizeof *expectation->lawful);
    expectation->bias = pm__alloc(points * records, sizeof *expectation->bias);
    expectation->variance = pm__alloc(points * records, sizeof *expectation->variance);
    if (!expectation->lawful || !expectation->bias || !expectation->variance) {
        pm__expectation_destroy(expectation);
        return pm__fail(error, PM_ENOMEM, "out of memory for what is expected of %zu points", points);
    }
    pm__for(progression->config->parallel, (points + POINTS - 1) / POINTS, expect_block, &e);
    for (size_t i = 0; i < points; i++)
        expectation->lawful_count += expectation->lawful[i];
    const bool canceled = atomic_load(&e.canceled);
    if (!expectation->lawful_count || canceled)
        pm__expectation_destroy(expectation);
    return canceled ? pm__fail(error, PM_ECANCELED, "canceled before what is expected was known") : PM_OK;
}

void pm__expectation_destroy(pm__expectation *expectation)
{
    free(expectation->lawful);
    free(expectation->bias);
    free(expectation->variance);
    *expectation = (pm__expectation){.lawful = NULL};
}
