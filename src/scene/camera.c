#include "camera.h"

#include "../base/vec3.h"

#include <math.h>

static bool is_finite(const double v[3])
{
    return isfinite(v[0]) && isfinite(v[1]) && isfinite(v[2]);
}

pm_status pm__camera_init(const pm__view *view, size_t width, size_t height, pm__camera *camera, pm_error *error)
{
    static const double pi = 3.14159265358979323846;
    double ahead[3], right[3], down[3], up[3] = {view->up[0], view->up[1], view->up[2]};
    if (!is_finite(view->eye) || !is_finite(view->at) || !is_finite(view->up))
        return pm__fail(error, PM_EINVAL, "the camera's eye, at and up must be finite");
    if (!(view->angle > 0.0 && view->angle < pi))
        return pm__fail(error, PM_EINVAL, "the camera's angle is %g radian, not above 0 and below pi", view->angle);
    if (!width || !height)
        return pm__fail(error, PM_EINVAL, "an image of %zu x %zu pixels", width, height);
    for (int i = 0; i < 3; i++)
        ahead[i] = view->at[i] - view->eye[i];
    if (!(pm__normalize(ahead) > 0.0))
        return pm__fail(error, PM_EINVAL, "the camera looks at the point where it stands");
    (void)pm__normalize(up); /* any length will do, also one whose square is none */
    pm__cross(ahead, up, right);
    if (!(pm__normalize(right) > 1e-9))
        return pm__fail(error, PM_EINVAL, "the camera's up is along its view");
    pm__cross(ahead, right, down);
    const double pixel = 2.0 * tan(0.5 * view->angle) / (double)height;
    for (int i = 0; i < 3; i++) {
        camera->eye[i] = view->eye[i];
        camera->right[i] = pixel * right[i];
        camera->down[i] = pixel * down[i];
        camera->corner[i] = ahead[i] - 0.5 * ((double)width * camera->right[i] + (double)height * camera->down[i]);
    }
    return PM_OK;
}

void pm__camera_direction(const pm__camera *camera, double x, double y, double direction[3])
{
    for (int i = 0; i < 3; i++)
        direction[i] = camera->corner[i] + x * camera->right[i] + y * camera->down[i];
    pm__normalize(direction);
}

/* The plane at distance 1 has a point (x, y, 1) in the direction v / depth; about it a solid angle is the area there
 * times cosine^3 of the angle to the axis: cosine for its tilt, cosine^2 for the distance. */
bool pm__camera_project(const pm__camera *camera, const double point[3], double at[2], double *density)
{
    double ahead[3], off[3];
    pm__cross(camera->right, camera->down, ahead);
    const double area = pm__normalize(ahead); /* of a pixel on that plane */
    for (int i = 0; i < 3; i++)
        off[i] = point[i] - camera->eye[i];
    const double depth = pm__dot(off, ahead);
    if (!(depth > 0.0))
        return false;
    const double cosine = depth / sqrt(pm__dot(off, off));
    for (int i = 0; i < 3; i++)
        off[i] = off[i] / depth - camera->corner[i];
    at[0] = pm__dot(off, camera->right) / area; /* pixels are square */
    at[1] = pm__dot(off, camera->down) / area;
    *density = 1.0 / (area * cosine * cosine * cosine);
    return true;
}
