/* A scene as Embree has it by itself: triangles, spheres, instances; no callbacks, float throughout. */
#ifndef PM_BENCH_PLAIN_SCENE_H
#define PM_BENCH_PLAIN_SCENE_H

#include "../src/scene/scene.h"

#include <embree3/rtcore.h>

typedef struct pm__plain_scene {
    RTCDevice device;
    RTCScene scene;
    RTCScene *parts;
    size_t part_count;
    bool robust;
} pm__plain_scene;

/* robust: no ray slips through between triangles of a mesh. ENOMEM. Destroy it also after an error. */
pm_status pm__plain_scene_create(const pm__scene *scene, bool robust, pm__plain_scene *plain, pm_error *error);
void pm__plain_scene_destroy(pm__plain_scene *plain);

#endif
