/* Rays by the hundred through a scene: the few shapes that Embree does not hold are met by all of them at once. */
#include "batch.h"

#include "query.h"

static void begin_query(pm__query *q, const pm__scene *scene, const pm__batch *b, size_t i)
{
    const bool met = b->place[i] < PM__MOST_KEPT;
    for (int axis = 0; axis < 3; axis++) {
        q->ray.origin[axis] = b->origin[axis][i];
        q->ray.direction[axis] = b->direction[axis][i];
    }
    q->ray.reach = b->distance[i];
    q->scene = scene;
    q->from = (uint32_t)b->from[i];
    q->to = PM__NO_SHAPE;
    q->met = met ? scene->few->kept[b->place[i]] : NULL;
    q->shape = met ? q->met->first : PM__NO_SHAPE;
    q->place = NULL;
}

/* Shapes come by ascending numbers, so the first of equally near ones stays. */
static void meet_one_by_one(const pm__scene *scene, pm__batch *b, size_t place)
{
    const pm__geometry *const geometry = scene->few->kept[place];
    for (size_t i = 0; i < b->count; i++) {
        pm__query q;
        begin_query(&q, scene, b, i);
        if (b->distance[i] > 0.0 && pm__query_take(&q, geometry, geometry->first)) {
            b->distance[i] = q.ray.reach;
            b->place[i] = (int64_t)place;
        }
    }
}

static void meet_few(const pm__scene *scene, const pm__batch_kernel *kernel, pm__batch *b)
{
    for (size_t place = 0; place < scene->kept_count; place++) {
        const pm__geometry *const geometry = scene->few->kept[place];
        const pm__shape *const shape = &geometry->shape;
        if (shape->kind == PM__SHAPE_RECTANGLE || shape->kind == PM__SHAPE_DISC)
            kernel->meet_flat(b, shape, geometry->first, (int64_t)place);
        else if (shape->kind == PM__SHAPE_SPHERE)
            kernel->meet_sphere(b, shape, geometry->first, (int64_t)place);
        else if (shape->kind == PM__SHAPE_WAVE)
            kernel->meet_wave(b, shape, geometry->first, (int64_t)place);
        else if (kernel->meet_cylinder(b, shape, geometry->first, (int64_t)place))
            meet_one_by_one(scene, b, place);
    }
}

static void settle_waves(const pm__scene *scene, const pm__batch_kernel *kernel, pm__batch *b)
{
    for (size_t place = 0; place < scene->kept_count; place++)
        if (scene->few->kept[place]->shape.kind == PM__SHAPE_WAVE)
            kernel->settle_wave(b, &scene->few->kept[place]->shape, (int64_t)place);
}

static void ask_embree(const pm__scene *scene, const pm__batch_kernel *kernel, pm__batch *b)
{
    kernel->cut(b, scene);
    for (size_t i = 0; i < b->count; i++) {
        pm__query q;
        pm__hit hit;
        if (!b->asks[i])
            continue;
        begin_query(&q, scene, b, i);
        if (!pm__query_ask_embree(&q, b->enter[i], b->leave[i]))
            continue;
        pm__query_hit(&q, &hit);
        for (int axis = 0; axis < 3; axis++) {
            b->position[axis][i] = hit.position[axis];
            b->normal[axis][i] = hit.normal[axis];
        }
        b->distance[i] = hit.distance;
        b->shape[i] = hit.shape;
        b->material[i] = hit.material;
    }
}

void pm__scene_intersect_batch(const pm__scene *scene, const pm__batch_kernel *kernel, pm__batch *b)
{
    kernel->begin(b);
    meet_few(scene, kernel, b);
    kernel->settle(b, scene->few);
    if (scene->few->round_count > 0)
        kernel->settle_round(b, scene->few);
    if (scene->few->wave_count > 0)
        settle_waves(scene, kernel, b);
    if (scene->kept_count < scene->geometry_count)
        ask_embree(scene, kernel, b);
}
