#include "light.h"

#include "light_emit.h"

static const double pi = 3.14159265358979323846;

void pm__emit(const pm__light *light, const double u[4], double position[3], double direction[3])
{
    const pm__lamp lamp = pm__lamp_of(light);
    pm__lamp_emit(&lamp, light->kind, u, position, direction);
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static pm_status check_finite(const char *name, const double v[3], pm_error *error)
{
    for (int i = 0; i < 3; i++)
        if (!isfinite(v[i]))
            return pm__fail(error, PM_EINVAL, "a light's %s[%d] is not finite", name, i);
    return PM_OK;
}

static pm_status check_power(const double power[3], pm_error *error)
{
    double sum = 0.0;
    for (int b = 0; b < 3; b++) {
        if (!(power[b] >= 0.0 && isfinite(power[b])))
            return pm__fail(error, PM_EINVAL, "a light's power[%d] is %g, not finite and at least 0", b, power[b]);
        sum += power[b];
    }
    return sum > 0.0 && isfinite(sum) ? PM_OK
                                      : pm__fail(error, PM_EINVAL, "a light's power adds up to %g, not above 0", sum);
}

static pm_status check_direction(const pm__light *light, pm_error *error)
{
    const pm_status status = check_finite("direction", light->direction, error);
    const double length2 = pm__dot(light->direction, light->direction);
    if (status || fabs(length2 - 1.0) <= 1e-9)
        return status;
    return pm__fail(error, PM_EINVAL, "a light's direction has length %g, not 1", sqrt(length2));
}

static pm_status check_radius(double radius, pm_error *error)
{
    if (radius > 0.0 && isfinite(radius))
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "a light's radius is %g m, not above 0 and finite", radius);
}

static pm_status check_edges(const pm__light *light, pm_error *error)
{
    pm_status status = check_finite("edge[0]", light->edge[0], error);
    if (!status)
        status = check_finite("edge[1]", light->edge[1], error);
    if (status)
        return status;
    double normal[3];
    pm__cross(light->edge[0], light->edge[1], normal);
    const double area = pm__normalize(normal);
    return area > 0.0 && isfinite(area) ? PM_OK
                                        : pm__fail(error, PM_EINVAL, "a rectangle light's edges span %g m2", area);
}

pm_status pm__light_check(const pm__light *light, pm_error *error)
{
    pm_status status = check_power(light->power, error);
    if (!status)
        status = check_finite("position", light->position, error);
    if (status)
        return status;
    if (light->inward && light->kind != PM__BALL)
        return pm__fail(error, PM_EINVAL, "a light is inward, which only balls can be");
    switch (light->kind) {
    case PM__POINT:
        return PM_OK;
    case PM__SPOT:
        if (!(light->angle > 0.0 && light->angle <= pi))
            return pm__fail(error, PM_EINVAL, "a spot's angle is %g, not above 0 and up to pi", light->angle);
        return check_direction(light, error);
    case PM__DIRECTIONAL:
        status = check_radius(light->radius, error);
        return status ? status : check_direction(light, error);
    case PM__RECTANGLE:
        return check_edges(light, error);
    case PM__BALL:
        return check_radius(light->radius, error);
    case PM__SUN:
        if (!(light->angle > 0.0 && light->angle <= 0.5 * pi))
            return pm__fail(error, PM_EINVAL, "a sun's angle is %g, not above 0 and up to pi / 2", light->angle);
        status = check_radius(light->radius, error);
        return status ? status : check_direction(light, error);
    }
    return pm__fail(error, PM_EINVAL, "a light's kind is %d, which is none", (int)light->kind);
}
