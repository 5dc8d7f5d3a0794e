/* The objects of a scene. */
#include "rays.h"

#include <stdlib.h>
#include <string.h>

pm_status pm__scene_list_objects(pm__scene *scene, pm_error *error)
{
    free(scene->objects);
    scene->object_count = 0;
    scene->objects = calloc(scene->geometry_count, sizeof *scene->objects);
    if (!scene->objects)
        return pm__fail(error, PM_ENOMEM, "out of memory for the scene");
    for (size_t i = 0; i < scene->geometry_count; i++) {
        const pm__geometry *const geometry = scene->geometries[i];
        pm__object *const object = &scene->objects[scene->object_count++];
        memcpy(object->low, geometry->low, sizeof object->low);
        memcpy(object->high, geometry->high, sizeof object->high);
        object->material = &scene->materials[geometry->material];
    }
    return PM_OK;
}

size_t pm__scene_object_count(const pm__scene *scene)
{
    return scene->object_count;
}

pm__object pm__scene_object(const pm__scene *scene, size_t index)
{
    return scene->objects[index];
}
