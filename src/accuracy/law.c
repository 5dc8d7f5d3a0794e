#include "law.h"

#include "../base/gauss.h"

/* What is e^-36 times less likely than the mode is left out. */
static const double tail = 36.0;

void pm__law_rule_init(pm__law_rule *rule)
{
    pm__gauss_legendre(PM__LAW_INNER, rule->inner, rule->inner_weight);
    pm__gauss_legendre(PM__LAW_OUTER, rule->outer, rule->outer_weight);
}

static double to_power(double s, int dimensions)
{
    return dimensions == 3 ? s * s * s : s * s;
}

double pm__radial_at(const pm__radial *radial, double s)
{
    if (!(s > 0.0))
        return 0.0;
    const double x = fmin(s / radial->reach, 1.0) * PM__LAW_CELLS;
    int cell = (int)x - 1;
    cell = cell < 0 ? 0 : cell > PM__LAW_CELLS - 3 ? PM__LAW_CELLS - 3 : cell;
    const double f = x - cell, a = f - 1.0, b = f - 2.0, c = f - 3.0, *const y = &radial->ratio[cell];
    const double ratio =
        (3.0 * f * (y[1] * b * c - y[2] * a * c) + (y[3] * f * a * b - y[0] * a * b * c)) / 6.0;
    return fmin(fmax(ratio * to_power(s, radial->dimensions), 0.0), radial->total);
}

/* The s in [low, high] with p(s) = p: regula falsi (Illinois) in s^d, of which p is nearly a multiple. */
static double radius_of(const pm__radial *radial, double p, double low, double high)
{
    double f_low = pm__radial_at(radial, low) - p, f_high = pm__radial_at(radial, high) - p;
    for (int i = 0; i < 50 && high - low > 1e-12 * high; i++) {
        const double a = to_power(low, radial->dimensions), b = to_power(high, radial->dimensions);
        const double x = b - f_high * (b - a) / (f_high - f_low);
        double s = radial->dimensions == 3 ? cbrt(x) : sqrt(x);
        if (!(s > low && s < high))
            s = 0.5 * (low + high);
        const double f = pm__radial_at(radial, s) - p;
        if (fabs(f) <= 1e-13 * p)
            return s;
        if (f < 0.0) {
            low = s;
            f_low = f;
            f_high *= 0.5;
        } else {
            high = s;
            f_high = f;
            f_low *= 0.5;
        }
    }
    return high;
}

/* ln of the density of y = ln p, p ~ Beta(k, N-k+1), less a constant. */
static double log_density(size_t k, size_t photons, double y)
{
    return (double)k * y + (double)(photons - k) * log1p(-exp(y));
}

/* ln (n - 1)!. lgamma would write its sign to a global variable. */
static double log_factorial_before(size_t n)
{
    int sign;
    return lgamma_r((double)n, &sign);
}

static double log_constant(size_t k, size_t photons)
{
    return log_factorial_before(photons + 1) - log_factorial_before(k) - log_factorial_before(photons - k + 1);
}

/* Where the density has fallen by e^-tail, from the mode in direction `sign`. */
static double edge_of_density(size_t k, size_t photons, double sign)
{
    const double mode = log((double)k / (double)photons), top = log_density(k, photons, fmin(mode, -1e-9));
    double inside = mode, step = sign / sqrt((double)k);
    for (int i = 0; i < 200; i++) {
        const double y = inside + step;
        if (y < 0.0 && log_density(k, photons, y) > top - tail)
            inside = y;
        else
            step *= 0.5;
        if (fabs(step) < 1e-3 / sqrt((double)k))
            break;
    }
    return fmin(inside + 2.0 * step, -1e-12);
}

double pm__largest_log_p(size_t k, size_t photons)
{
    return edge_of_density(k, photons, 1.0);
}

/* E[j; j < k] and E[j^2; j < k] of j ~ Binomial(N, p). */
static void truncated_binomial(pm__law_grid *grid, double p)
{
    const double n = (double)grid->photons;
    grid->cut_mean = grid->cut_square = 0.0;
    if (!(p > 0.0))
        return;
    const double log_odds = log(p) - log1p(-fmin(p, 1.0 - 1e-15));
    double log_term = n * log1p(-fmin(p, 1.0 - 1e-15)); /* ln P(j = 0) */
    for (size_t j = 0; j < grid->k; j++) {
        const double x = (double)j, term = exp(log_term);
        grid->cut_mean += x * term;
        grid->cut_square += x * x * term;
        log_term += log((n - x) / (x + 1.0)) + log_odds;
    }
}

static void set_inner(double inner_p[PM__LAW_INNER], const pm__law_rule *rule, const pm__radial *radial, double r)
{
    for (int j = 0; j < PM__LAW_INNER; j++)
        inner_p[j] = pm__radial_at(radial, r * rule->inner[j]);
}

static void set_cut(pm__law_grid *grid, const pm__law_rule *rule, const pm__radial *radial, double radius)
{
    grid->cut = true;
    grid->cut_radius = radius;
    grid->cut_p = pm__radial_at(radial, radius);
    set_inner(grid->cut_inner_p, rule, radial, radius);
    if (grid->k) {
        truncated_binomial(grid, grid->cut_p);
    } else {
        const double n = (double)grid->photons, p = grid->cut_p;
        grid->cut_mean = n * p;
        grid->cut_square = n * p * (1.0 - p) + n * n * p * p;
    }
}

static void set_radii(pm__law_grid *grid, const pm__law_rule *rule, bool with_inner, const pm__radial *radial,
                      double from, double to)
{
    const double constant = log_constant(grid->k, grid->photons);
    double low = 0.0;
    int cell = 1;
    for (size_t i = 0; i < PM__LAW_OUTER; i++) {
        const double y = from + (to - from) * rule->outer[i], p = exp(y);
        while (cell < PM__LAW_CELLS && pm__radial_at(radial, cell * radial->reach / PM__LAW_CELLS) < p)
            low = cell++ * radial->reach / PM__LAW_CELLS;
        const double r = radius_of(radial, p, low, cell * radial->reach / PM__LAW_CELLS);
        grid->probability[i] =
            rule->outer_weight[i] * (to - from) * exp(constant + log_density(grid->k, grid->photons, y));
        grid->radius[i] = r;
        grid->p[i] = p;
        if (with_inner)
            set_inner(grid->inner_p[i], rule, radial, r);
    }
    grid->count = PM__LAW_OUTER;
}

bool pm__law_grid_init(pm__law_grid *grid, const pm__law_rule *rule, bool with_inner, const pm__radial *radial,
                       size_t k, size_t photons, double radius)
{
    grid->k = k; /* fields of what does not happen stay as they are */
    grid->photons = photons;
    grid->dimensions = radial->dimensions;
    grid->count = 0;
    grid->cut = false;
    const bool limited = !isinf(radius);
    if (!k) {
        set_cut(grid, rule, radial, radius);
        return true;
    }
    const double from = edge_of_density(k, photons, -1.0), far = edge_of_density(k, photons, 1.0);
    const double log_total = radial->total > 0.0 ? log(radial->total) : -INFINITY;
    const double log_cut = limited ? log(pm__radial_at(radial, fmin(radius, radial->reach))) : log_total;
    if (log_cut < far) {
        if (!limited)
            return false;
        set_cut(grid, rule, radial, radius);
    }
    const double to = fmin(far, log_cut);
    if (to > from)
        set_radii(grid, rule, with_inner, radial, from, to);
    return true;
}

/* Integral of w over a region of constant density, against a plain midpoint sum. */
static bool smooth_enough(const pm__kernel_law *law, const pm__law_rule *rule, const pm__variant *variant,
                          int dimensions)
{
    enum { CELLS = 4000 };
    double coarse = law->rim, fine = 0.0;
    for (int j = 0; j < PM__LAW_INNER; j++)
        coarse += law->first[j] * to_power(rule->inner[j], dimensions);
    for (int i = 0; i < CELLS; i++) {
        const double t = (i + 0.5) / CELLS;
        fine += variant->estimator->weight(variant->spec->values, t * t) * dimensions * pow(t, dimensions - 1) / CELLS;
    }
    return fabs(coarse - fine) < 1e-6 * fabs(fine);
}

bool pm__kernel_law_init(pm__kernel_law *law, const pm__law_rule *rule, const pm__variant *variant, int dimensions)
{
    const pm__estimator *const e = variant->estimator;
    const double *const values = variant->spec->values;
    if (!e->weight || !e->weight_slope || !e->norm || !e->last)
        return false;
    law->rim = e->weight(values, 1.0);
    law->norm = e->norm(values, dimensions);
    law->last = e->last(values);
    for (int j = 0; j < PM__LAW_INNER; j++) {
        const double slope = e->weight_slope(values, rule->inner[j]) * rule->inner_weight[j];
        law->first[j] = -slope;
        law->second[j] = -2.0 * e->weight(values, rule->inner[j] * rule->inner[j]) * slope;
    }
    return smooth_enough(law, rule, variant, dimensions);
}

/* Mean and variance of the weight of one photon inside a region. */
static pm__moments weight_moments(const pm__kernel_law *law, double p, const double inner_p[PM__LAW_INNER])
{
    if (!(p > 0.0))
        return (pm__moments){0.0, 0.0};
    double first = law->rim * p, second = law->rim * law->rim * p;
    for (int j = 0; j < PM__LAW_INNER; j++) {
        first += law->first[j] * inner_p[j];
        second += law->second[j] * inner_p[j];
    }
    const double mean = first / p;
    return (pm__moments){mean, fmax(0.0, second / p - mean * mean)};
}

static double scale_of(double norm, const pm__law_grid *grid, double flux, double radius)
{
    const double pi = 3.14159265358979323846;
    const double measure = (grid->dimensions == 3 ? 4.0 / 3.0 * pi : pi) * to_power(radius, grid->dimensions);
    return flux / (norm * measure);
}

pm__moments pm__disc_moments(const pm__law_grid *grid, double flux, double last)
{
    double mean = 0.0, square = 0.0;
    for (size_t i = 0; i < grid->count; i++) {
        const double at = scale_of(1.0, grid, flux, grid->radius[i]) * ((double)grid->k - 1.0 + last);
        mean += grid->probability[i] * at;
        square += grid->probability[i] * at * at;
    }
    if (grid->cut) {
        const double scale = scale_of(1.0, grid, flux, grid->cut_radius);
        mean += scale * grid->cut_mean;
        square += scale * scale * grid->cut_square;
    }
    return (pm__moments){mean, fmax(0.0, square - mean * mean)};
}

pm__moments pm__kernel_moments(const pm__kernel_law *law, const pm__law_grid *grid, double flux)
{
    double mean = 0.0, square = 0.0;
    const double inside = (double)grid->k - 1.0;
    for (size_t i = 0; i < grid->count; i++) {
        const pm__moments w = weight_moments(law, grid->p[i], grid->inner_p[i]);
        const double scale = scale_of(law->norm, grid, flux, grid->radius[i]);
        const double at = scale * (inside * w.mean + law->last * law->rim);
        mean += grid->probability[i] * at;
        square += grid->probability[i] * (at * at + scale * scale * inside * w.variance);
    }
    if (grid->cut) {
        const pm__moments w = weight_moments(law, grid->cut_p, grid->cut_inner_p);
        const double scale = scale_of(law->norm, grid, flux, grid->cut_radius);
        mean += scale * w.mean * grid->cut_mean;
        square += scale * scale * (w.variance * grid->cut_mean + w.mean * w.mean * grid->cut_square);
    }
    return (pm__moments){mean, fmax(0.0, square - mean * mean)};
}
