/* What a scene holds, and how Embree comes to ask its exact shapes. For the sources of this folder, and for
 * measuring what it costs beside Embree alone. */
#ifndef PM_SCENE_RAYS_H
#define PM_SCENE_RAYS_H

#include "flats.h"
#include "scene.h"
#include "shapes.h"

#include <embree3/rtcore.h>

/* In the terms of a part: the ray's end lies on a shape, but on none of this part. No shape has this number. */
#define PM__ELSEWHERE (PM__NO_SHAPE - 1)

typedef struct pm__plane {
    double normal[3], corner[3]; /* unit; m */
} pm__plane;

/* One exact shape, one mesh or one part where it is placed: what Embree calls a geometry. */
typedef struct pm__geometry {
    const pm__scene *scene;
    uint32_t first; /* the number of its first (or only) shape; shape i of a mesh or a part is first + i */
    uint32_t count;
    uint32_t material;
    unsigned slot; /* its number with Embree */
    const pm__scene *part; /* NULL: not a part */
    pm__placement placement;
    double low[3], high[3]; /* the box about it, m */
    pm__shape shape;
    pm__plane *planes; /* of the triangles of a mesh; NULL: it is none */
    const float (*vertices)[3]; /* Embree's */
    const uint32_t (*triangles)[3];
    size_t vertex_count;
} pm__geometry;

/* Exact shapes that Embree does not hold, at most. */
enum { PM__MOST_SINGLE = 8, PM__MOST_KEPT = PM__MOST_FLATS + PM__MOST_SINGLE };

/* Those shapes together, by ascending numbers, and behind them (PM__MOST_KEPT) none. Of shapes that are not flat the
 * normal is 0. */
typedef struct pm__few {
    double corner[3][PM__MOST_KEPT + 1], normal[3][PM__MOST_KEPT + 1];
    int64_t shape[PM__MOST_KEPT + 1];
    const pm__material *material[PM__MOST_KEPT + 1];
    const pm__geometry *kept[PM__MOST_KEPT];
    /* Of spheres (axes: 3) and cylinders (2); radius 0: it is neither. sign: -1 where the normal points inward. */
    double radius[PM__MOST_KEPT + 1], centre[3][PM__MOST_KEPT + 1], sign[PM__MOST_KEPT + 1];
    int64_t axes[PM__MOST_KEPT + 1];
    size_t round_count, wave_count;
} pm__few;

/* What Embree holds: the first few sheets each by itself, all else as one. */
enum { PM__MOST_HELD = 4 };

typedef struct pm__held {
    double low[3], high[3]; /* the box about it, m */
    int64_t first, end;     /* the numbers of its shapes: first <= number < end */
    int axis;
    double steep; /* sheets: a way from or to one of its shapes, of more than this along the axis, meets no other */
} pm__held;

struct pm__scene {
    RTCDevice device;
    RTCScene rays;
    pm__material *materials;
    pm__light *lights;
    pm__geometry **geometries; /* each stays where it is: Embree keeps its address */
    /* The exact shapes, unless they are many: Embree does not hold them. Flat ones (if not too few), and others. */
    pm__flats *flats; /* NULL: none */
    pm__few *few;
    const pm__geometry *flat[PM__MOST_FLATS], *single[PM__MOST_SINGLE];
    size_t single_count, kept_count; /* those and the flat ones */
    size_t material_count, material_capacity, light_count, light_capacity, geometry_count, geometry_capacity;
    uint32_t shape_count;
    pm__scene **parts;
    size_t part_count, part_capacity;
    const pm__scene *whole; /* of a part: the scene that it belongs to */
    double smallest;        /* of a part: the least scale that it is placed with; 0: it is not placed, and open */
    pm__object *objects;    /* known once committed */
    size_t object_count;
    double low[3], high[3]; /* the box of all shapes, m */
    pm__held held[PM__MOST_HELD]; /* known once committed */
    size_t held_count;
    double extent;          /* the largest coordinate of that box, m; known once committed */
    double rounding;        /* as extent, of the whole's box carried into this part: what positions are rounded to */
    bool committed;
};

/* For more shapes: the box grows. */
void pm__box_empty(double low[3], double high[3]);
void pm__box_enclose(double low[3], double high[3], const double point[3]);

/* Room for one more geometry of `count` shapes, checked; *made is not in the scene yet. */
pm_status pm__geometry_create(pm__scene *scene, size_t count, pm__geometry **made, pm_error *error);
/* The same for shapes that have a material; EINVAL also where the scene has none of that number. */
pm_status pm__geometry_of(pm__scene *scene, uint32_t material, size_t count, pm__geometry **made, pm_error *error);
/* Puts it, with its box, into the scene; takes `embree` over. */
void pm__geometry_attach(pm__scene *scene, pm__geometry *made, RTCGeometry embree);
/* Of one that is not in the scene. */
void pm__geometry_destroy(pm__geometry *geometry);
/* What went wrong in Embree since it was last asked, if anything: ENOMEM, EINVAL. */
pm_status pm__scene_embree_status(const pm__scene *scene, pm_error *error);

/* A scene on the device; the caller has filled nothing in. ENOMEM. */
pm_status pm__scene_on(RTCDevice device, pm__scene **scene, pm_error *error);
/* By a placement: points to the scene and back, directions (of length 1) likewise. */
void pm__placed_point(const pm__placement *placement, const double point[3], double placed[3]);
void pm__placed_direction(const pm__placement *placement, const double direction[3], double placed[3]);
void pm__part_point(const pm__placement *placement, const double placed[3], double point[3]);
void pm__part_direction(const pm__placement *placement, const double placed[3], double direction[3]);

/* Lists the objects. ENOMEM. */
pm_status pm__scene_list_objects(pm__scene *scene, pm_error *error);

/* The plane of a triangle, through its first corner; false where its corners lie in line. */
bool pm__triangle_plane(const float (*vertices)[3], const uint32_t triangle[3], pm__plane *plane);

/* How steeply a mesh rises or falls at most along the axis, on any straight way from one of its points to another: the
 * sine, with some to spare. 2: it is not known to be a function's graph over a rectangle. Cost: about 50 ns a triangle
 * where it is one, and until memory runs out. */
double pm__sheet_steepness(const pm__geometry *mesh, int axis);

/* Install what Embree calls for a mesh, or for an exact shape or a placed part, whose user data is a pm__geometry. */
void pm__rays_triangles(RTCGeometry embree);
void pm__rays_shape(RTCGeometry embree);

#endif
