/* Triangle meshes of surfaces of revolution about the z axis. Lengths in m. */
#ifndef PM_SCENE_REVOLVE_H
#define PM_SCENE_REVOLVE_H

#include "../base/status.h"

#include <stddef.h>
#include <stdint.h>

typedef struct pm__mesh {
    float (*vertices)[3];
    uint32_t (*triangles)[3]; /* counterclockwise from the side that the normal points to */
    size_t vertex_count, triangle_count;
} pm__mesh;

enum { PM__MOST_TURNS = 1 << 16, PM__MOST_PROFILE = 1 << 16 };

/* Turns a profile, points (r, z), about the axis: a ring of `turns` vertices for each point, one vertex where r is 0.
 * Normals lie to the right of the way along the profile, seen with r to the right and z up: outward where it climbs, so
 * a solid's profile runs from the bottom's middle around its outside to the top's middle. Rings of one radius, height
 * and number of turns agree to the last bit, whatever mesh they are in: surfaces that share a ring leave no gap. No
 * triangle is degenerate but where float cannot hold its corners apart (then pm__scene_mesh refuses it).
 *
 * EINVAL: fewer than 2 points or more than 65536, fewer than 3 turns or more than 65536, what would take more than
 * 2^31 triangles; a point (its number is in the error) that is not finite, beyond 1e12 m or of negative radius, is as
 * the one before it, or lies on the axis as that does. ENOMEM. On error the mesh is empty. Free by pm__mesh_free. */
pm_status pm__revolve(const double (*profile)[2], size_t count, size_t turns, pm__mesh *mesh, pm_error *error);

/* All 0 but for the counts. ENOMEM: the mesh is then empty. */
pm_status pm__mesh_create(size_t vertex_count, size_t triangle_count, pm__mesh *mesh, pm_error *error);
void pm__mesh_free(pm__mesh *mesh); /* an empty one is allowed */

#endif
