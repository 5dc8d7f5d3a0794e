/* Scenes: shapes with materials, and lights. Built in code; fit for an importer, since everything goes in by these
 * calls. Rays are answered by Embree; exact shapes are solved in double, so that truths hold to rounding.
 *
 * create -> materials, shapes, lights -> commit -> rays, from any number of threads -> destroy.
 * Adding calls return EINVAL (error names the shape and what is wrong: not finite, degenerate, an unknown material) or
 * ENOMEM. Lengths in m. */
#ifndef PM_SCENE_SCENE_H
#define PM_SCENE_SCENE_H

#include "light.h"
#include "material.h"

#include <stddef.h>
#include <stdint.h>

typedef struct pm__scene pm__scene;

pm_status pm__scene_create(pm__scene **scene, pm_error *error);
void pm__scene_destroy(pm__scene *scene);

/* *index: what shapes name it by. The material is copied. */
pm_status pm__scene_material(pm__scene *scene, const pm__material *material, uint32_t *index, pm_error *error);
pm_status pm__scene_light(pm__scene *scene, const pm__light *light, pm_error *error);

/* Triangles: `indices` three a triangle, counterclockwise from the side that the normal points to. Copied. Degenerate
 * triangles are refused with their number. */
pm_status pm__scene_mesh(pm__scene *scene, uint32_t material, const float (*vertices)[3], size_t vertex_count,
                         const uint32_t (*triangles)[3], size_t triangle_count, pm_error *error);

/* Exact shapes. Normals of spheres and cylinders point outward unless `inward`. */
pm_status pm__scene_sphere(pm__scene *scene, uint32_t material, const double centre[3], double radius, bool inward,
                           pm_error *error);
/* Round about the axis x = centre[0], y = centre[1], between the heights; only where x - centre[0] >= from * radius
 * (from = -1: all of it). */
pm_status pm__scene_cylinder(pm__scene *scene, uint32_t material, const double centre[2], double radius, double low,
                             double high, double from, bool inward, pm_error *error);
/* Flat: a corner and two edges, or a centre, unit normal and radius. The rectangle's normal is along cross(u, v). */
pm_status pm__scene_rectangle(pm__scene *scene, uint32_t material, const double corner[3], const double u[3],
                              const double v[3], pm_error *error);
pm_status pm__scene_disc(pm__scene *scene, uint32_t material, const double centre[3], const double normal[3],
                         double radius, pm_error *error);
/* Water with a sinusoidal surface z = height + amplitude cos(wavenumber x), |x| <= extent[0], |y| <= extent[1], normal
 * upward. amplitude * wavenumber < 1, wavenumber * extent[0] <= 1e6. */
pm_status pm__scene_wave(pm__scene *scene, uint32_t material, double height, double amplitude, double wavenumber,
                         const double extent[2], pm_error *error);

/* A part: shapes that stand in the scene as often as they are placed. Filled by the calls above (materials of its own,
 * no lights), then placed; it belongs to the scene, and nothing can be added once it has been placed. No parts of
 * parts. */
pm_status pm__scene_part(pm__scene *scene, pm__scene **part, pm_error *error);
/* Placed by p -> scale rotation p + offset. rotation: rows, orthonormal; scale > 0. EINVAL: no such. */
typedef struct pm__placement {
    double rotation[3][3], scale, offset[3];
} pm__placement;
pm_status pm__scene_place(pm__scene *scene, pm__scene *part, const pm__placement *placement, pm_error *error);

/* No shape or light can be added afterwards. EINVAL: no shape, no light. */
pm_status pm__scene_commit(pm__scene *scene, pm_error *error);

/* Does any of its materials absorb within, those of parts included? */
bool pm__scene_absorbs(const pm__scene *scene);

size_t pm__scene_light_count(const pm__scene *scene);
const pm__light *pm__scene_light_at(const pm__scene *scene, size_t index);
/* The sum over lights, by band. */
void pm__scene_power(const pm__scene *scene, double power[3]);

/* The objects of a committed scene, those of placed parts included: a mesh is one. Boxes about them, m. */
typedef struct pm__object {
    double low[3], high[3];
    const pm__material *material;
} pm__object;
size_t pm__scene_object_count(const pm__scene *scene);
pm__object pm__scene_object(const pm__scene *scene, size_t index);

typedef struct pm__hit {
    double distance;      /* m */
    double position[3];   /* m, on the exact shape */
    double normal[3];     /* unit, of the shape as it was made (not turned to the ray) */
    uint32_t shape;       /* which: a ray that leaves from it names it */
    const pm__material *material;
} pm__hit;

#define PM__NO_SHAPE UINT32_MAX

/* The first surface that the ray meets within `reach`. direction: unit. from: the shape that it starts on, or
 * PM__NO_SHAPE: that shape is not met again within rounding of the origin, but may be met farther on (a sphere from
 * inside). */
bool pm__scene_intersect(const pm__scene *scene, const double origin[3], const double direction[3], double reach,
                         uint32_t from, pm__hit *hit);

/* How the unit normal changes where the point met moves within the surface by v: bend v, to first order (1/m). false:
 * not at all, and bend is not set: flat shapes, and meshes, whose triangles are flat. */
bool pm__scene_bend(const pm__scene *scene, const pm__hit *hit, double bend[3][3]);

/* Is the straight way from a to b (starting on shape `from`, ending on shape `to`) blocked? */
bool pm__scene_blocked(const pm__scene *scene, const double a[3], uint32_t from, const double b[3], uint32_t to);

#endif
