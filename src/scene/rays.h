/* What a scene holds, and how Embree comes to ask its exact shapes. For the sources of this folder alone. */
#ifndef PM_SCENE_RAYS_H
#define PM_SCENE_RAYS_H

#include "scene.h"
#include "shapes.h"

#include <embree3/rtcore.h>

/* One exact shape or one mesh: what Embree calls a geometry. */
typedef struct pm__geometry {
    const pm__scene *scene;
    uint32_t first; /* the number of its first (or only) shape; triangle i of a mesh is first + i */
    uint32_t count;
    uint32_t material;
    double low[3], high[3]; /* the box about it, m */
    pm__shape shape;
    const float (*vertices)[3]; /* Embree's; NULL for an exact shape */
    const uint32_t (*triangles)[3];
} pm__geometry;

struct pm__scene {
    RTCDevice device;
    RTCScene rays;
    pm__material *materials;
    pm__light *lights;
    pm__geometry **geometries; /* each stays where it is: Embree keeps its address */
    size_t material_count, material_capacity, light_count, light_capacity, geometry_count, geometry_capacity;
    uint32_t shape_count;
    pm__object *objects; /* known once committed */
    size_t object_count;
    double low[3], high[3]; /* the box of all shapes, m */
    double extent;          /* the largest coordinate of that box, m; known once committed */
    bool committed;
};

/* Lists the objects. ENOMEM. */
pm_status pm__scene_list_objects(pm__scene *scene, pm_error *error);

/* The first corner and the unit normal of a triangle; false where its corners lie in line. */
bool pm__triangle_plane(const float (*vertices)[3], const uint32_t triangle[3], double corner[3], double normal[3]);

/* Install what Embree calls for a mesh, or for an exact shape, whose user data is a pm__geometry. */
void pm__rays_triangles(RTCGeometry embree);
void pm__rays_shape(RTCGeometry embree);

#endif
