/* Every scene, one row each, in the order in which tables show them: first those with an exact answer, which are cases,
 * then those that are rendered only.
 * Beside the rows: list.c (this list as data), scene_case.c and room.c (what the ones and the others share). */
#ifndef PM_SCENES_LIST_H
#define PM_SCENES_LIST_H

#include "../case.h"

#define PM_SCENE_LIST(X) \
    X(furnace)            \
    X(integrating_sphere) \
    X(point_light)        \
    X(rect_light)         \
    X(corner)             \
    X(wall)               \
    X(glossy_plane)       \
    X(glass_sphere)       \
    X(nephroid)           \
    X(cardioid)           \
    X(plate)              \
    X(water)              \
    X(pool)               \
    X(prism)              \
    X(cornell)            \
    X(cornell_diffuse)    \
    X(cornell_water)      \
    X(four_lights)        \
    X(fractal_cornell)    \
    X(cognac)             \
    X(torus)              \
    X(lamp)               \
    X(egg)                \
    X(office)             \
    X(maze)               \
    X(wide_floor)

#define X(name) extern const pm__case pm__case_scene_##name;
PM_SCENE_LIST(X)
#undef X

/* Entries are the first members of pm__case; their names start with "scene:". */
extern const pm__catalogue pm__scene_cases;

#endif
