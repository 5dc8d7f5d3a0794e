/* Photons straight through a scene: the first surface is lit, all behind it lies in shadow. */
#include "emission.h"

#include <string.h>

static pm__stored stored_at(const pm__departure *ray, const pm__hit *hit, bool lit)
{
    const double sign = pm__dot(ray->direction, hit->normal) > 0.0 ? -1.0 : 1.0;
    pm__stored stored;
    for (int i = 0; i < 3; i++) {
        stored.position[i] = hit->position[i];
        stored.direction[i] = ray->direction[i];
        stored.normal[i] = sign * hit->normal[i];
        stored.power[i] = lit ? ray->power[i] : 0.0;
    }
    return stored;
}

static bool follow(const pm__scene *scene, const pm__departure *ray, uint64_t number, pm__store store, void *context)
{
    pm__hit hit = {.shape = PM__NO_SHAPE};
    double from[3];
    memcpy(from, ray->position, sizeof from);
    for (int met = 0; met < PM__LONGEST_PATH; met++) {
        if (!pm__scene_intersect(scene, from, ray->direction, INFINITY, hit.shape, &hit))
            break;
        const pm__stored stored = stored_at(ray, &hit, met == 0);
        if (pm__is_rough(hit.material) && !store(context, number, &stored))
            return false;
        memcpy(from, hit.position, sizeof from);
    }
    return true;
}

void pm__trace_straight(const pm__trace_config *config, uint64_t first, uint64_t count, pm__store store, void *context)
{
    pm__departure ray;
    for (uint64_t i = 0; i < count; i++)
        if (pm__depart(config->emission, first + i, &ray) &&
            !follow(config->scene, &ray, first + i, store, context))
            return;
}
