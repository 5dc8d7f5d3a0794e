/* Light through a flat layer. With theta the angle in air and sin theta' = sin theta / n in the layer, a ray lands at
 *     rho = air tan theta + layer tan theta' = sin theta (air / cos theta + layer / (n cos theta')),
 *     drho/dtheta = air / cos^2 theta + layer cos theta / (n cos^3 theta'),
 * and carries I sin theta dtheta dphi onto rho drho dphi:
 *     E = I T^crossings (sin theta / rho) / (drho/dtheta),
 * which the second form of rho keeps free of 0/0 at the foot. In q = tan theta, rho is increasing and at least
 * air q. */
#include "scene_case.h"

#include "../../src/base/gauss.h"
#include "../../src/base/geometry.h"

static const double pi = 3.14159265358979323846;

enum { NODES = 128, HALVINGS = 100 };

/* The root between ends of different sign. */
static double bisect(pm__function function, const void *context, double low, double high)
{
    const bool rising = function(context, low) < 0.0;
    for (int i = 0; i < HALVINGS; i++) {
        const double middle = 0.5 * (low + high);
        if (!(middle > low && middle < high))
            break;
        if ((function(context, middle) < 0.0) == rising)
            low = middle;
        else
            high = middle;
    }
    return 0.5 * (low + high);
}

/* Golden section for the least magnitude between low and high, where the ends have one sign: where the function first
 * takes the other sign, or NAN. */
static double crossing(pm__function function, const void *context, double low, double high)
{
    const double golden = 0.61803398874989484820, sign = function(context, low) < 0.0 ? -1.0 : 1.0;
    double a = high - golden * (high - low), b = low + golden * (high - low);
    double fa = sign * function(context, a), fb = sign * function(context, b);
    for (int i = 0; i < HALVINGS / 2; i++) {
        if (fa < 0.0)
            return a;
        if (fb < 0.0)
            return b;
        if (fa < fb) {
            high = b;
            b = a;
            fb = fa;
            a = high - golden * (high - low);
            fa = sign * function(context, a);
        } else {
            low = a;
            a = b;
            fa = fb;
            b = low + golden * (high - low);
            fb = sign * function(context, b);
        }
    }
    return NAN;
}

size_t pm__roots(pm__function function, const void *context, double low, double high, int cells,
                 double roots[PM__MOST_ROOTS])
{
    const double width = (high - low) / cells;
    double f0 = NAN, f1 = function(context, low); /* at the two nodes before */
    size_t count = 0;
    for (int i = 1; i <= cells && count + 2 <= PM__MOST_ROOTS; i++) {
        const double x1 = low + (i - 1) * width, x2 = i < cells ? low + i * width : high;
        const double f2 = function(context, x2);
        if ((f1 < 0.0) != (f2 < 0.0)) {
            roots[count++] = bisect(function, context, x1, x2);
        } else if ((f0 < 0.0) == (f1 < 0.0) && fabs(f1) <= fabs(f0) && fabs(f1) <= fabs(f2)) {
            const double x0 = x1 - width, middle = crossing(function, context, x0, x2);
            if (!isnan(middle)) {
                roots[count++] = bisect(function, context, x0, middle);
                roots[count++] = bisect(function, context, middle, x2);
            }
        }
        f0 = f1;
        f1 = f2;
    }
    return count;
}

double pm__integral(pm__function function, const void *context, double low, double high)
{
    double nodes[NODES], weights[NODES], sum = 0.0;
    pm__gauss_legendre(NODES, nodes, weights);
    for (int i = 0; i < NODES; i++)
        sum += weights[i] * function(context, low + nodes[i] * (high - low));
    return sum * (high - low);
}

/* ---- Power in discs ---- */

enum { SHEET_CELLS = 96, SHEET_NODES = 16 };

/* A stretch of t over which miss runs from one side of the disc to the other. */
typedef struct sheet {
    const pm__sheets *sheets;
    const void *context;
    double sign, target; /* sign: of the slope */
} sheet;

static double sheet_value(const void *context, double t, double *slope)
{
    const sheet *const s = context;
    const double value = s->sign * s->sheets->miss(s->context, t, slope) - s->target;
    *slope *= s->sign;
    return value;
}

/* With miss = r c, dt = r dc / |slope|: the integrand over c is sqrt(1 - c^2) times what is smooth, and the nodes and
 * weights of Chebyshev polynomials of the second kind apply. */
static double sheet_mass(sheet *s, double low, double high, double r)
{
    double sum = 0.0, t = 0.5 * (low + high), slope = 0.0, before = 0.0;
    for (int j = SHEET_NODES; j >= 1 && r > 0.0; j--) {
        const double angle = pi * j / (SHEET_NODES + 1), sine = sin(angle);
        s->target = r * cos(angle);
        const double guess = slope > 0.0 ? t + (s->target - before) / slope : t;
        t = pm__increasing_root(sheet_value, s, low, high, fmin(fmax(guess, low), high));
        (void)sheet_value(s, t, &slope);
        before = s->target;
        sum += sine * s->sheets->strip(s->context, t, r * sine) / slope;
    }
    return sum * r * pi / (SHEET_NODES + 1);
}

double pm__mass_sheets(const pm__sheets *sheets, const void *context, double r0, double r1)
{
    const double margin = 1.25 * r1 + 1e-3, width = (sheets->high - sheets->low) / SHEET_CELLS;
    double slope, sum = 0.0, entry = NAN, side = 0.0; /* of the last cell's end beyond the margin: its sign */
    for (int i = 0; i <= SHEET_CELLS; i++) {
        const double t = i < SHEET_CELLS ? sheets->low + i * width : sheets->high;
        const double miss = sheets->miss(context, t, &slope);
        if (fabs(miss) <= margin) {
            if (i == 0 || i == SHEET_CELLS || !(slope * side < 0.0))
                return NAN;
            continue;
        }
        if (side * miss < 0.0) {
            sheet s = {.sheets = sheets, .context = context, .sign = miss > 0.0 ? 1.0 : -1.0};
            sum += sheet_mass(&s, entry, t, r1) - sheet_mass(&s, entry, t, r0);
        } else if (i > 0 && t - entry > 1.5 * width) {
            return NAN; /* in and out by the same side: a fold */
        }
        entry = t;
        side = miss;
    }
    return sum > 0.0 ? sum : r1 > r0 ? NAN : 0.0;
}

typedef struct even_field {
    double (*irradiance)(const void *context, double r, double cosine);
    const void *context;
} even_field;

enum { MOST_RAYS = 64 };

/* The trapezoid rule, of geometric convergence, over half the circle. */
static double circle_mean(const even_field *f, double r, const double *cosines, int count)
{
    double sum = 0.0;
    for (int i = 0; i < count; i++)
        sum += f->irradiance(f->context, r, cosines[i]);
    return sum / count;
}

static void set_rays(double cosines[MOST_RAYS], int count)
{
    for (int i = 0; i < count; i++)
        cosines[i] = cos(pi * (i + 0.5) / count);
}

/* Twice as many rays square the error. 0: too few. */
static int choose_rays(const even_field *f, double r, double cosines[MOST_RAYS])
{
    set_rays(cosines, 4);
    double mean = circle_mean(f, r, cosines, 4);
    for (int count = 8; count <= MOST_RAYS; count *= 2) {
        const double before = mean;
        set_rays(cosines, count);
        mean = circle_mean(f, r, cosines, count);
        if (fabs(mean - before) <= 1e-4 * fabs(mean))
            return count;
    }
    return 0;
}

double pm__mass_even(double (*irradiance)(const void *context, double r, double cosine), const void *context, double r0,
                     double r1)
{
    /* Gauss-Legendre in r squared, in which means over circles are smooth: two nodes for thin rings, else four */
    static const double nodes[2][4] = {{-0.5773502691896258, 0.5773502691896258},
                                       {-0.8611363115940526, -0.3399810435848563, 0.3399810435848563,
                                        0.8611363115940526}};
    static const double weights[2][4] = {{1.0, 1.0}, {0.3478548451374538, 0.6521451548625461, 0.6521451548625461,
                                                      0.3478548451374538}};
    const even_field f = {irradiance, context};
    double cosines[MOST_RAYS], sum = 0.0;
    const int count = choose_rays(&f, r1, cosines);
    if (!count)
        return NAN;
    const int rule = r1 - r0 > 0.125 * r1;
    const double middle = 0.5 * (r0 * r0 + r1 * r1), half = 0.5 * (r1 - r0) * (r1 + r0);
    for (int i = 0; i < 2 + 2 * rule; i++)
        sum += weights[rule][i] * circle_mean(&f, sqrt(middle + half * nodes[rule][i]), cosines, count);
    return pi * half * sum;
}

/* ---- Light through layers ---- */

double pm__transmittance(double cosine, double n)
{
    const double far = n * sqrt(1.0 - (1.0 - cosine) * (1.0 + cosine) / (n * n)); /* n cos of the refracted ray */
    const double across = (cosine - far) / (cosine + far);
    const double within = (n * n * cosine - far) / (n * n * cosine + far);
    return 1.0 - 0.5 * (across * across + within * within);
}

/* rho - target over q = tan theta. */
typedef struct landing {
    const pm__layered *layered;
    double target;
} landing;

static double land(const void *context, double q, double *slope)
{
    const landing *const l = context;
    const double n2 = l->layered->n * l->layered->n;
    const double across2 = n2 + (n2 - 1.0) * q * q, across = sqrt(across2); /* n cos theta' / cos theta */
    *slope = l->layered->air + l->layered->layer * n2 / (across2 * across);
    return l->layered->air * q + l->layered->layer * q / across - l->target;
}

double pm__layered_extent(const pm__layered *layered)
{
    const landing l = {layered, 0.0};
    double slope;
    return land(&l, tan(layered->cone), &slope);
}

double pm__layered_irradiance(const pm__layered *layered, double rho)
{
    if (rho > pm__layered_extent(layered))
        return 0.0;
    const landing l = {layered, rho};
    const double h = layered->air, e = layered->layer, n = layered->n;
    const double q = pm__increasing_root(land, &l, 0.0, rho / h, rho / (h + e / n));
    const double cosine = 1.0 / sqrt(1.0 + q * q), sine = q * cosine;
    const double inner = sqrt(1.0 - sine * sine / (n * n));
    const double spread = h / (cosine * cosine) + e * cosine / (n * inner * inner * inner);
    return pow(pm__transmittance(cosine, n), layered->crossings) / ((h / cosine + e / (n * inner)) * spread);
}

typedef struct layered_field {
    const pm__layered *layered;
    double rho;
} layered_field;

static double layered_around(const void *context, double r, double cosine)
{
    const layered_field *const f = context;
    return pm__layered_irradiance(f->layered, sqrt(fmax(0.0, f->rho * f->rho + r * r + 2.0 * f->rho * r * cosine)));
}

double pm__layered_mass(const pm__layered *layered, double rho, double r0, double r1)
{
    const layered_field f = {layered, rho};
    return rho + r1 < 0.99 * pm__layered_extent(layered) ? pm__mass_even(layered_around, &f, r0, r1) : NAN;
}

static double passed(const void *context, double theta)
{
    const pm__layered *const layered = context;
    return 2.0 * pi * sin(theta) * pow(pm__transmittance(cos(theta), layered->n), layered->crossings);
}

double pm__layered_power(const pm__layered *layered)
{
    return pm__integral(passed, layered, 0.0, layered->cone);
}

/* Equal heights have equal areas. */
void pm__probe_sphere(const double *u, pm__probe *point)
{
    const double z = 2.0 * u[0] - 1.0, r = sqrt(fmax(0.0, 1.0 - z * z)), phi = 2.0 * pi * u[1];
    *point = (pm__probe){.position = {r * cos(phi), r * sin(phi), z}};
    for (int i = 0; i < 3; i++)
        point->normal[i] = -point->position[i];
}

pm_status pm__scene_floor(pm__scene *scene, double x0, double half, double z, pm_error *error)
{
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    const double corner[3] = {x0 - half, -half, z}, u[3] = {2.0 * half, 0, 0}, v[3] = {0, 2.0 * half, 0};
    uint32_t material;
    const pm_status status = pm__scene_material(scene, &white, &material, error);
    return status ? status : pm__scene_rectangle(scene, material, corner, u, v, error);
}

pm_status pm__scene_ball_room(pm__scene *scene, double albedo, const pm__light *light, pm_error *error)
{
    const double centre[3] = {0, 0, 0};
    const pm__material wall = {.kind = PM__DIFFUSE, .diffuse = {albedo, albedo, albedo}};
    uint32_t material = 0;
    pm_status status = pm__scene_material(scene, &wall, &material, error);
    if (!status)
        status = pm__scene_sphere(scene, material, centre, 1.0, true, error);
    return status ? status : pm__scene_light(scene, light, error);
}

void pm__ball_room_view(const double *values, pm__view *view)
{
    (void)values;
    *view = (pm__view){.eye = {-0.5, 0, 0}, .at = {1, 0, 0}, .up = {0, 0, 1}, .angle = 1.4};
}

pm_status pm__scene_lamp(pm__scene *scene, pm__light_kind kind, double z, double watts, double radius, double angle,
                         pm_error *error)
{
    const pm__light light = {.kind = kind, .power = {watts, watts, watts}, .position = {0, 0, z},
                             .direction = {0, 0, -1}, .radius = radius, .angle = angle};
    return pm__scene_light(scene, &light, error);
}

const pm__region pm__layered_regions[PM__LAYERED_REGIONS] = {
    {"all", "within 2 m of the foot of the light", false, false},
    {"foot", "within 0.25 m of the foot of the light", false, false},
    {"far", "1.5 to 2 m from the foot of the light", false, false},
};

void pm__layered_probe(const double *values, size_t region, const double *u, pm__probe *point)
{
    static const double probed[PM__LAYERED_REGIONS][2] = {{0.0, 2.0}, {0.0, 0.25}, {1.5, 2.0}};
    (void)values;
    pm__probe_ring(0.0, 0.0, probed[region][0], probed[region][1], u, point);
}

double pm__layered_truth(const pm__layered *layered, const pm__probe *point)
{
    if (!pm__is_upside(point))
        return 0.0;
    return pm__layered_irradiance(layered, hypot(point->position[0], point->position[1]));
}

double pm__layered_within(const pm__layered *layered, const pm__probe *point, const pm__shape *shape, double r0,
                          double r1)
{
    const double rho = hypot(point->position[0], point->position[1]);
    return pm__accepts_down(point, shape) ? pm__layered_mass(layered, rho, r0, r1) : 0.0;
}
