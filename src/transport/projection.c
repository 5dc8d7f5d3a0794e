/* A cell of a light's numbers is a set of rays: they start within `reach` of a point and run within `angle` of a
 * direction. Rays of the ball about o that go along d meet the ball (c, r) only if the line from o along d comes within
 * r + reach of c: only if c - o is within angle + asin((r + reach) / |c - o|) of the cell's direction. A box is in the
 * ball about its middle; where that ball may be met and its middle is not, the halves of the box are asked.
 *
 * The rays' bounds come from pm__emit at the middle and the corners of the cell. Cells of a disc, a rectangle or a
 * sphere's (angle, cosine) are farthest from their middle at a corner (below a half turn wide). A ball's rays run in
 * the frame of pm__basis about the normal, which turns by at most sqrt 2 of the way of the normal while that stays in
 * one half of the sphere (the frame is carried without turn from the pole: its spin is tan(theta / 2) of the way);
 * cells end at the halves' border. */
#include "projection.h"

#include "../base/memory.h"

#include <stdlib.h>

enum { DIMENSIONS = 4, MOST_HALVINGS = 15 };

/* Cells by dimension of the numbers that a photon is emitted by. Even in the second, so that none of a ball lies in
 * both halves. */
static const uint32_t grids[][DIMENSIONS] = {[PM__POINT] = {128, 64, 1, 1},
                                             [PM__SPOT] = {128, 64, 1, 1},
                                             [PM__DIRECTIONAL] = {128, 64, 1, 1},
                                             [PM__RECTANGLE] = {4, 4, 32, 16},
                                             [PM__BALL] = {16, 8, 16, 8},
                                             [PM__SUN] = {64, 32, 4, 2}};

typedef struct light_map {
    const uint32_t *grid;
    uint32_t *before; /* [i]: cells that are on among the first i, the last dimension fastest; cells + 1 of them */
    uint32_t cells;
} light_map;

struct pm__projection {
    light_map *lights;
    size_t light_count;
};

/* ---- Rays of a cell and boxes ---------------------------------------------------------------- */

typedef struct beam {
    double origin[3], direction[3];
    double reach; /* m */
    double angle; /* radian */
} beam;

/* Far beyond rounding, far below cells: relative, and of angles in radian. */
static const double MARGIN = 1e-9;

static double angle_between(const double a[3], const double b[3])
{
    double across[3];
    pm__cross(a, b, across);
    return atan2(sqrt(pm__dot(across, across)), pm__dot(a, b));
}

typedef enum verdict { MISSED, PERHAPS, MET } verdict;

/* MET: some ray of the beam goes through the ball's middle. */
static verdict try_ball(const beam *b, const double middle[3], double radius)
{
    double to[3];
    for (int i = 0; i < 3; i++)
        to[i] = middle[i] - b->origin[i];
    const double distance = sqrt(pm__dot(to, to));
    if (distance <= b->reach)
        return MET;
    const double off = angle_between(b->direction, to);
    if (off <= b->angle)
        return MET;
    const double size = radius + b->reach;
    return distance <= size || off <= b->angle + asin(size / distance) ? PERHAPS : MISSED;
}

static bool may_meet(const beam *b, const double low[3], const double high[3], int halvings)
{
    double middle[3], half[3];
    for (int i = 0; i < 3; i++) {
        middle[i] = 0.5 * (low[i] + high[i]);
        half[i] = 0.5 * (high[i] - low[i]);
    }
    const verdict answer = try_ball(b, middle, sqrt(pm__dot(half, half)));
    if (answer != PERHAPS || halvings == 0)
        return answer != MISSED;
    const int axis = half[0] >= half[1] && half[0] >= half[2] ? 0 : half[1] >= half[2] ? 1 : 2;
    double cut[3] = {high[0], high[1], high[2]};
    cut[axis] = middle[axis];
    if (may_meet(b, low, cut, halvings - 1))
        return true;
    for (int i = 0; i < 3; i++)
        cut[i] = i == axis ? middle[i] : low[i];
    return may_meet(b, cut, high, halvings - 1);
}

/* ---- Cells ----------------------------------------------------------------------------------- */

static void ray_at(const light_map *map, const pm__light *light, uint32_t cell, const double within[DIMENSIONS],
                   double position[3], double direction[3])
{
    double u[DIMENSIONS];
    for (int i = DIMENSIONS - 1; i >= 0; i--) {
        u[i] = ((double)(cell % map->grid[i]) + within[i]) / map->grid[i];
        cell /= map->grid[i];
    }
    pm__emit(light, u, position, direction);
}

/* How far corners are from the middle; those of the dimensions in `mask` alone. */
static void widen(const light_map *map, const pm__light *light, uint32_t cell, unsigned mask, beam *b)
{
    for (unsigned corner = 0; corner < 1U << DIMENSIONS; corner++) {
        double within[DIMENSIONS], position[3], direction[3], step[3];
        if (corner & ~mask)
            continue;
        for (unsigned i = 0; i < DIMENSIONS; i++)
            within[i] = mask >> i & 1 ? (double)(corner >> i & 1) : 0.5;
        ray_at(map, light, cell, within, position, direction);
        for (int i = 0; i < 3; i++)
            step[i] = position[i] - b->origin[i];
        b->reach = fmax(b->reach, sqrt(pm__dot(step, step)));
        b->angle = fmax(b->angle, angle_between(b->direction, direction));
    }
}

static beam beam_of(const light_map *map, const pm__light *light, uint32_t cell)
{
    enum { PLACES = 3, WAYS = 12 };
    static const double middle[DIMENSIONS] = {0.5, 0.5, 0.5, 0.5};
    beam b = {.reach = 0.0};
    ray_at(map, light, cell, middle, b.origin, b.direction);
    if (light->kind == PM__BALL) {
        beam place = b;
        widen(map, light, cell, PLACES, &place);
        widen(map, light, cell, WAYS, &b);
        b.reach = place.reach;
        b.angle += sqrt(2.0) * 2.0 * asin(fmin(1.0, 0.5 * place.reach / light->radius));
    } else {
        widen(map, light, cell, PLACES | WAYS, &b);
    }
    const double largest = fmax(fabs(b.origin[0]), fmax(fabs(b.origin[1]), fabs(b.origin[2])));
    b.reach += MARGIN * (b.reach + largest);
    b.angle += MARGIN;
    return b;
}

/* Surfaces may lie on their box but for rounding. */
static bool meets_object(const beam *b, const pm__object *object)
{
    beam padded = *b;
    for (int i = 0; i < 3; i++)
        padded.reach += MARGIN * (fabs(object->low[i]) + fabs(object->high[i]));
    return may_meet(&padded, object->low, object->high, MOST_HALVINGS);
}

typedef struct objects {
    pm__object *items;
    size_t count;
} objects;

static bool is_wanted(const pm__object *object, bool specular)
{
    return !specular || object->material->kind == PM__MIRROR || object->material->kind == PM__GLASS;
}

static pm_status collect(const pm__scene *scene, bool specular, objects *wanted)
{
    const size_t count = pm__scene_object_count(scene);
    wanted->count = 0;
    wanted->items = pm__alloc(count, sizeof *wanted->items);
    if (!wanted->items)
        return PM_ENOMEM;
    for (size_t i = 0; i < count; i++) {
        const pm__object object = pm__scene_object(scene, i);
        if (is_wanted(&object, specular))
            wanted->items[wanted->count++] = object;
    }
    return PM_OK;
}

static bool is_on(const objects *wanted, const beam *b)
{
    for (size_t i = 0; i < wanted->count; i++)
        if (meets_object(b, &wanted->items[i]))
            return true;
    return false;
}

/* ---- Maps ------------------------------------------------------------------------------------ */

static pm_status map_light(const objects *wanted, const pm__light *light, light_map *map)
{
    map->grid = grids[light->kind];
    map->cells = 1;
    for (int i = 0; i < DIMENSIONS; i++)
        map->cells *= map->grid[i];
    map->before = pm__alloc((size_t)map->cells + 1, sizeof *map->before);
    if (!map->before)
        return PM_ENOMEM;
    map->before[0] = 0;
    for (uint32_t cell = 0; cell < map->cells; cell++) {
        const beam b = beam_of(map, light, cell);
        map->before[cell + 1] = map->before[cell] + is_on(wanted, &b);
    }
    return PM_OK;
}

static pm_status map_lights(const pm__scene *scene, bool specular, pm__projection *made)
{
    objects wanted;
    made->light_count = pm__scene_light_count(scene);
    made->lights = pm__alloc_zero(made->light_count, sizeof *made->lights);
    if (!made->lights)
        return PM_ENOMEM;
    pm_status status = collect(scene, specular, &wanted);
    for (size_t i = 0; i < made->light_count && status == PM_OK; i++)
        status = map_light(&wanted, pm__scene_light_at(scene, i), &made->lights[i]);
    free(wanted.items);
    return status;
}

pm_status pm__projection_create(const pm__scene *scene, bool specular, pm__projection **projection, pm_error *error)
{
    *projection = calloc(1, sizeof **projection);
    const pm_status status = *projection ? map_lights(scene, specular, *projection) : PM_ENOMEM;
    if (status == PM_OK)
        return PM_OK;
    pm__projection_destroy(*projection);
    *projection = NULL;
    return pm__fail(error, status, "out of memory for the projection maps of %zu lights", pm__scene_light_count(scene));
}

void pm__projection_destroy(pm__projection *projection)
{
    if (!projection)
        return;
    for (size_t i = 0; projection->lights && i < projection->light_count; i++)
        free(projection->lights[i].before);
    free(projection->lights);
    free(projection);
}

double pm__projection_share(const pm__projection *projection, size_t light)
{
    const light_map *const map = &projection->lights[light];
    return (double)map->before[map->cells] / map->cells;
}

bool pm__projection_covers(const pm__projection *projection, size_t light, const double u[4])
{
    const light_map *const map = &projection->lights[light];
    uint32_t cell = 0;
    for (int i = 0; i < DIMENSIONS; i++)
        cell = cell * map->grid[i] + (uint32_t)(u[i] * map->grid[i]);
    return map->before[cell + 1] > map->before[cell];
}

/* The slab of `stride` cells, of those from *first on, in which the target-th cell that is on lies. */
static uint32_t find_slab(const light_map *map, uint32_t first, uint32_t slabs, uint32_t stride, double target)
{
    uint32_t low = 0, high = slabs;
    while (high - low > 1) {
        const uint32_t middle = low + (high - low) / 2;
        if ((double)(map->before[first + middle * stride] - map->before[first]) <= target)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/* One number after another, by the share of its slab: near numbers stay near, so what a sampler spreads evenly stays so
 * over the cells that are on. */
void pm__projection_aim(const pm__projection *projection, size_t light, double u[4])
{
    static const double below_one = 0x1.fffffffffffffp-1;
    const light_map *const map = &projection->lights[light];
    uint32_t first = 0, stride = map->cells;
    for (int i = 0; i < DIMENSIONS; i++) {
        const uint32_t on = map->before[first + stride] - map->before[first];
        const double target = fmin(u[i], below_one) * on;
        stride /= map->grid[i];
        const uint32_t slab = find_slab(map, first, map->grid[i], stride, target), start = first + slab * stride;
        const double ahead = map->before[start] - map->before[first];
        const double inside = map->before[start + stride] - map->before[start];
        u[i] = fmin((slab + fmin((target - ahead) / inside, below_one)) / map->grid[i], below_one);
        first = start;
    }
}
