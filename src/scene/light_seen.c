/* Light as it arrives, and lights as they are seen. */
#include "light.h"

#include "../base/vec3.h"

static const double pi = 3.14159265358979323846;

static double toward(const double from[3], const double to[3], double direction[3])
{
    for (int i = 0; i < 3; i++)
        direction[i] = to[i] - from[i];
    return pm__normalize(direction);
}

static void fill(pm__light_sample *sample, const double power[3], double factor)
{
    for (int b = 0; b < 3; b++)
        sample->irradiance[b] = factor * power[b];
}

/* Of a Lambertian rectangle its unit normal; returns its area. */
static double rectangle_normal(const pm__light *light, double normal[3])
{
    pm__cross(light->edge[0], light->edge[1], normal);
    return pm__normalize(normal);
}

/* W/(m2 sr) for each W: a Lambertian surface of area A sends Phi / (pi A). */
static double ball_radiance(const pm__light *light)
{
    return 1.0 / (4.0 * pi * pi * light->radius * light->radius);
}

/* Likewise of a sun, its window's area by the projected solid angle of its cone. */
static double sun_radiance(const pm__light *light)
{
    const double side = pi * light->radius * sin(light->angle);
    return 1.0 / (side * side);
}

/* How far from `origin` against the light its window is met; 0: it is not. */
static double window_distance(const pm__light *light, const double origin[3], const double direction[3])
{
    double off[3];
    for (int i = 0; i < 3; i++)
        off[i] = light->position[i] - origin[i];
    const double distance = pm__dot(light->direction, off) / pm__dot(light->direction, direction);
    for (int i = 0; i < 3; i++)
        off[i] = distance * direction[i] - off[i];
    return distance > 0.0 && pm__dot(off, off) <= light->radius * light->radius ? distance : 0.0;
}

/* ---- Arriving ---------------------------------------------------------------------------------- */

static bool reach_point(const pm__light *light, const double point[3], pm__light_sample *sample)
{
    const double distance = toward(point, light->position, sample->direction);
    const bool spot = light->kind == PM__SPOT;
    const double half = spot ? sin(0.5 * light->angle) : 1.0; /* the cone's solid angle: 4 pi sin^2(angle / 2) */
    double chord2 = 0.0; /* between the cone's axis and the way to the point: cosines of narrow cones have few digits */
    for (int i = 0; i < 3; i++) {
        sample->position[i] = light->position[i];
        chord2 += pow(sample->direction[i] + light->direction[i], 2);
    }
    if (!(distance > 0.0) || (spot && chord2 > 4.0 * half * half))
        return false;
    fill(sample, light->power, 1.0 / (4.0 * pi * half * half * distance * distance));
    return true;
}

static bool reach_parallel(const pm__light *light, const double point[3], pm__light_sample *sample)
{
    double off[3];
    for (int i = 0; i < 3; i++)
        off[i] = point[i] - light->position[i];
    const double along = pm__dot(off, light->direction), r2 = light->radius * light->radius;
    double across2 = 0.0;
    for (int i = 0; i < 3; i++) {
        sample->direction[i] = -light->direction[i];
        sample->position[i] = point[i] - along * light->direction[i];
        across2 += pow(off[i] - along * light->direction[i], 2);
    }
    fill(sample, light->power, 1.0 / (pi * r2));
    return along > 0.0 && across2 <= r2;
}

/* A point uniform on the area, seen from `point` under the cosine of its own: L A cos / d^2. */
static bool reach_area(const double point[3], const double normal[3], double radiance_area, const double power[3],
                       pm__light_sample *sample)
{
    const double distance = toward(point, sample->position, sample->direction);
    const double cosine = -pm__dot(normal, sample->direction);
    if (!(distance > 0.0 && cosine > 0.0))
        return false;
    fill(sample, power, radiance_area * cosine / (distance * distance));
    return true;
}

static bool reach_rectangle(const pm__light *light, const double point[3], const double u[2], pm__light_sample *sample)
{
    double normal[3];
    (void)rectangle_normal(light, normal);
    for (int i = 0; i < 3; i++)
        sample->position[i] = light->position[i] + u[0] * light->edge[0][i] + u[1] * light->edge[1][i];
    return reach_area(point, normal, 1.0 / pi, light->power, sample);
}

/* The inside of a ball, from anywhere: by area. */
static bool reach_inside(const pm__light *light, const double point[3], const double u[2], pm__light_sample *sample)
{
    const double z = 1.0 - 2.0 * u[1], r = sqrt(fmax(0.0, 1.0 - z * z));
    const double inward[3] = {-r * cos(2.0 * pi * u[0]), -r * sin(2.0 * pi * u[0]), -z};
    for (int i = 0; i < 3; i++)
        sample->position[i] = light->position[i] - light->radius * inward[i];
    return reach_area(point, inward, 1.0 / pi, light->power, sample);
}

/* The outside of a ball: uniform over the solid angle that it fills. */
static bool reach_ball(const pm__light *light, const double point[3], const double u[2], pm__light_sample *sample)
{
    double axis[3], s[3], t[3];
    const double distance = toward(point, light->position, axis), ratio = light->radius / distance;
    if (!(ratio < 1.0))
        return false;
    const double below = ratio * ratio / (1.0 + sqrt(1.0 - ratio * ratio)); /* 1 - cosine of the cone's half */
    const double low = u[1] * below, r = sqrt(low * (2.0 - low)), cosine = 1.0 - low;
    pm__basis(axis, s, t);
    const double x = r * cos(2.0 * pi * u[0]), y = r * sin(2.0 * pi * u[0]);
    const double half = fmax(0.0, light->radius * light->radius - distance * distance * r * r);
    const double length = distance * cosine - sqrt(half);
    for (int i = 0; i < 3; i++) {
        sample->direction[i] = x * s[i] + y * t[i] + cosine * axis[i];
        sample->position[i] = point[i] + length * sample->direction[i];
    }
    fill(sample, light->power, 2.0 * pi * below * ball_radiance(light));
    return true;
}

/* Uniform over the solid angle of its cone; nothing where the window leaves it dark. */
static bool reach_sun(const pm__light *light, const double point[3], const double u[2], pm__light_sample *sample)
{
    double s[3], t[3];
    const double half = sin(0.5 * light->angle), below = 2.0 * half * half; /* 1 - cosine of the cone's half */
    const double low = u[1] * below, r = sqrt(low * (2.0 - low)), cosine = 1.0 - low;
    const double x = r * cos(2.0 * pi * u[0]), y = r * sin(2.0 * pi * u[0]);
    pm__basis(light->direction, s, t);
    for (int i = 0; i < 3; i++)
        sample->direction[i] = x * s[i] + y * t[i] - cosine * light->direction[i];
    const double distance = window_distance(light, point, sample->direction);
    for (int i = 0; i < 3; i++)
        sample->position[i] = point[i] + distance * sample->direction[i];
    fill(sample, light->power, 2.0 * pi * below * sun_radiance(light));
    return distance > 0.0;
}

bool pm__light_reach(const pm__light *light, const double point[3], const double u[2], pm__light_sample *sample)
{
    switch (light->kind) {
    case PM__POINT:
    case PM__SPOT:
        return reach_point(light, point, sample);
    case PM__DIRECTIONAL:
        return reach_parallel(light, point, sample);
    case PM__RECTANGLE:
        return reach_rectangle(light, point, u, sample);
    case PM__BALL:
        return light->inward ? reach_inside(light, point, u, sample) : reach_ball(light, point, u, sample);
    case PM__SUN:
        return reach_sun(light, point, u, sample);
    }
    return false;
}

/* ---- Seen -------------------------------------------------------------------------------------- */

/* W/(m2 sr) for each W; 0: not met. */
static double see_rectangle(const pm__light *light, const double origin[3], const double direction[3], double reach,
                            double *distance)
{
    double normal[3], off[3];
    const double area = rectangle_normal(light, normal), facing = pm__dot(normal, direction);
    if (!(facing < 0.0))
        return 0.0;
    for (int i = 0; i < 3; i++)
        off[i] = light->position[i] - origin[i];
    *distance = pm__dot(normal, off) / facing;
    if (!(*distance > 0.0 && *distance <= reach))
        return 0.0;
    for (int i = 0; i < 3; i++)
        off[i] = *distance * direction[i] - off[i];
    /* Coordinates along the edges, which need not be at right angles. */
    const double *const u = light->edge[0], *const v = light->edge[1];
    const double uu = pm__dot(u, u), uv = pm__dot(u, v), vv = pm__dot(v, v);
    const double a = pm__dot(off, u), b = pm__dot(off, v), determinant = uu * vv - uv * uv;
    const double x = (a * vv - b * uv) / determinant, y = (b * uu - a * uv) / determinant;
    return x >= 0.0 && x <= 1.0 && y >= 0.0 && y <= 1.0 ? 1.0 / (pi * area) : 0.0;
}

/* The ray enters a ball that shines outward, or leaves one that shines inward. */
static double see_ball(const pm__light *light, const double origin[3], const double direction[3], double reach,
                       double *distance)
{
    double off[3], across[3];
    for (int i = 0; i < 3; i++)
        off[i] = light->position[i] - origin[i];
    const double along = pm__dot(off, direction);
    for (int i = 0; i < 3; i++)
        across[i] = off[i] - along * direction[i];
    const double half2 = light->radius * light->radius - pm__dot(across, across);
    if (!(half2 > 0.0))
        return 0.0;
    *distance = along + (light->inward ? sqrt(half2) : -sqrt(half2));
    return *distance > 0.0 && *distance <= reach ? ball_radiance(light) : 0.0;
}

/* The ray runs out by the window, within the cone: by the chord, since cosines of narrow cones have few digits. */
static double see_sun(const pm__light *light, const double origin[3], const double direction[3], double reach,
                      double *distance)
{
    const double half = sin(0.5 * light->angle);
    double chord2 = 0.0;
    for (int i = 0; i < 3; i++)
        chord2 += pow(direction[i] + light->direction[i], 2);
    if (chord2 > 4.0 * half * half)
        return 0.0;
    *distance = window_distance(light, origin, direction);
    return *distance > 0.0 && *distance <= reach ? sun_radiance(light) : 0.0;
}

bool pm__light_seen(const pm__light *light, const double origin[3], const double direction[3], double reach,
                    double radiance[3], double *distance)
{
    const double each = light->kind == PM__RECTANGLE ? see_rectangle(light, origin, direction, reach, distance)
                        : light->kind == PM__BALL    ? see_ball(light, origin, direction, reach, distance)
                        : light->kind == PM__SUN     ? see_sun(light, origin, direction, reach, distance)
                                                     : 0.0;
    for (int b = 0; b < 3; b++)
        radiance[b] = each * light->power[b];
    return each > 0.0;
}
