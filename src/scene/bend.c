/* How normals turn along shapes. */
#include "rays.h"

#include "../base/turn.h"
#include "../base/vec3.h"

#include <string.h>

/* The one that holds the shape: they are in the order of their numbers. */
static const pm__geometry *geometry_of(const pm__scene *scene, uint32_t shape)
{
    size_t low = 0, high = scene->geometry_count;
    while (high - low > 1) {
        const size_t middle = low + (high - low) / 2;
        if (scene->geometries[middle]->first <= shape)
            low = middle;
        else
            high = middle;
    }
    return scene->geometries[low];
}

/* Normals point from the centre or the axis: n = (p - c) / R. Along the normal nothing is asked. */
static void bend_round(const pm__shape *shape, const double normal[3], double bend[3][3])
{
    const double curvature = (shape->inward ? -1.0 : 1.0) / shape->radius;
    const int axes = shape->kind == PM__SHAPE_SPHERE ? 3 : 2;
    memset(bend, 0, 9 * sizeof(double));
    for (int i = 0; i < axes; i++)
        for (int j = 0; j < axes; j++)
            bend[i][j] = curvature * ((i == j ? 1.0 : 0.0) - normal[i] * normal[j]);
}

/* n = (s, 0, 1) / sqrt(1 + s^2), s = a k sin kx: dn = (1, 0, -s) ds / (1 + s^2)^(3/2). */
static void bend_wave(const pm__shape *shape, const double position[3], double bend[3][3])
{
    static const double per_radian = 0.15915494309189533577; /* turns */
    const double k = shape->wavenumber;
    double sine, cosine;
    pm__turns(k * per_radian * position[0], &sine, &cosine);
    const double steep = shape->amplitude * k * sine, square = 1.0 + steep * steep;
    const double turn = shape->amplitude * k * k * cosine / (square * sqrt(square));
    memset(bend, 0, 9 * sizeof(double));
    bend[0][0] = turn;
    bend[2][0] = -steep * turn;
}

static bool bend_at(const pm__scene *scene, uint32_t number, const double position[3], const double normal[3],
                    double bend[3][3]);

static bool bend_part(const pm__geometry *geometry, uint32_t number, const double position[3], const double normal[3],
                      double bend[3][3])
{
    const pm__placement *const placement = &geometry->placement;
    double within[3], facing[3], own[3][3];
    pm__part_point(placement, position, within);
    pm__part_direction(placement, normal, facing);
    if (!bend_at(geometry->part, number - geometry->first, within, facing, own))
        return false;
    for (int i = 0; i < 3; i++) {
        double row[3]; /* of rotation own */
        for (int j = 0; j < 3; j++)
            row[j] = placement->rotation[i][0] * own[0][j] + placement->rotation[i][1] * own[1][j] +
                     placement->rotation[i][2] * own[2][j];
        for (int j = 0; j < 3; j++)
            bend[i][j] = pm__dot(row, placement->rotation[j]) / placement->scale;
    }
    return true;
}

static bool bend_at(const pm__scene *scene, uint32_t number, const double position[3], const double normal[3],
                    double bend[3][3])
{
    const pm__geometry *const geometry = geometry_of(scene, number);
    if (geometry->part)
        return bend_part(geometry, number, position, normal, bend);
    if (geometry->planes || geometry->shape.kind == PM__SHAPE_RECTANGLE || geometry->shape.kind == PM__SHAPE_DISC)
        return false;
    if (geometry->shape.kind == PM__SHAPE_WAVE)
        bend_wave(&geometry->shape, position, bend);
    else
        bend_round(&geometry->shape, normal, bend);
    return true;
}

bool pm__scene_bend(const pm__scene *scene, const pm__hit *hit, double bend[3][3])
{
    return bend_at(scene, hit->shape, hit->position, hit->normal, bend);
}
