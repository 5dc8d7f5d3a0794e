/* A pinhole camera: where a scene is looked at from. Lengths in m. */
#ifndef PM_SCENE_CAMERA_H
#define PM_SCENE_CAMERA_H

#include "../base/status.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct pm__view {
    double eye[3], at[3], up[3]; /* up: any length, not along the view */
    double angle;                /* radian, of the whole height of the image, > 0 and < pi */
} pm__view;

typedef struct pm__camera {
    double eye[3];
    double corner[3], right[3], down[3]; /* of the image plane at distance 1; a pixel's steps */
} pm__camera;

/* EINVAL: not finite, eye and at are one point, up along the view, an angle out of range, no pixels. */
pm_status pm__camera_init(const pm__view *view, size_t width, size_t height, pm__camera *camera, pm_error *error);

/* The unit direction through the point (x, y) of the image, in pixels from its upper left corner. */
void pm__camera_direction(const pm__camera *camera, double x, double y, double direction[3]);

/* Where in the image a point is seen, if nothing stands before it: at, in pixels as above, be it outside the image.
 * density: pixels to the steradian there. false: it is not before the camera; then neither is set. */
bool pm__camera_project(const pm__camera *camera, const double point[3], double at[2], double *density);

#endif
