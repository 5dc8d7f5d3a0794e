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

static double passed(const void *context, double theta)
{
    const pm__layered *const layered = context;
    return 2.0 * pi * sin(theta) * pow(pm__transmittance(cos(theta), layered->n), layered->crossings);
}

double pm__layered_power(const pm__layered *layered)
{
    return pm__integral(passed, layered, 0.0, layered->cone);
}

pm_status pm__scene_floor(pm__scene *scene, double x0, double half, double z, pm_error *error)
{
    const pm__material white = {.kind = PM__DIFFUSE, .diffuse = {1, 1, 1}};
    const double corner[3] = {x0 - half, -half, z}, u[3] = {2.0 * half, 0, 0}, v[3] = {0, 2.0 * half, 0};
    uint32_t material;
    const pm_status status = pm__scene_material(scene, &white, &material, error);
    return status ? status : pm__scene_rectangle(scene, material, corner, u, v, error);
}

pm_status pm__scene_lamp(pm__scene *scene, pm__light_kind kind, double z, double watts, double radius, double angle,
                         pm_error *error)
{
    const pm__light light = {.kind = kind, .power = {watts, watts, watts}, .position = {0, 0, z},
                             .direction = {0, 0, -1}, .radius = radius, .angle = angle};
    return pm__scene_light(scene, &light, error);
}
