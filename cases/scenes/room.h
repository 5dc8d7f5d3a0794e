/* What the scenes that are only rendered share: rooms, blocks, square lights. z is up; a room stands on the floor z = 0
 * about x = y = 0, its front at the least y. Lengths in m. Adding fails as the scene's own calls do. */
#ifndef PM_SCENES_ROOM_H
#define PM_SCENES_ROOM_H

#include "../case.h"

/* What a Cornell box is in all scenes: a cube of 1 m, open in front. */
#define PM__CORNELL_HALF 0.5
#define PM__CORNELL_HEIGHT 1.0

/* Lambertian walls whose normals point inward. */
typedef struct pm__room {
    double half[2], height;
    double white[3]; /* albedo of floor, ceiling, back and front */
    double left[3], right[3];
    bool open;       /* no front */
    double skylight; /* half the side of a square hole in the ceiling's middle; 0: none */
    bool no_floor;   /* for a room that stands on another's floor */
} pm__room;

/* The Cornell box: red on the left, blue on the right, white elsewhere. albedo: of white; colours have it in one band
 * and a fifth of it in the others. */
pm__room pm__cornell_room(double albedo);
/* Looks through the open front, whose rim is that of a square image. */
void pm__cornell_view(const double *values, pm__view *view);
/* The square lamp in its ceiling: half its side, W in each band. */
pm_status pm__cornell_lamp(pm__scene *scene, double half, double watts, pm_error *error);

/* Its spheres: a mirror on the left, glass on the right, moved so far toward the back. */
pm_status pm__cornell_spheres(pm__scene *scene, double ior, double moved, pm_error *error);

pm_status pm__room_walls(pm__scene *scene, const pm__room *room, pm_error *error);

pm_status pm__diffuse_material(pm__scene *scene, const double albedo[3], uint32_t *index, pm_error *error);
pm_status pm__mirror_material(pm__scene *scene, uint32_t *index, pm_error *error); /* loses nothing */
/* Of one index for all bands, absorbing nothing. */
pm_status pm__glass_material(pm__scene *scene, double ior, uint32_t *index, pm_error *error);

/* A square block that stands on the floor; turn: radian about z. */
pm_status pm__room_block(pm__scene *scene, uint32_t material, const double centre[2], double half, double height,
                         double turn, pm_error *error);

/* A box about its centre: leant back (its top toward +y) about x, then turned about z, both in radian. */
typedef struct pm__brick {
    double centre[3], half[3], lean, turn;
} pm__brick;

/* Closed boxes, all in one mesh. */
pm_status pm__room_bricks(pm__scene *scene, uint32_t material, const pm__brick *bricks, size_t count, pm_error *error);

/* A square that shines downward. */
pm_status pm__room_lamp(pm__scene *scene, const double centre[3], double half, const double power[3], pm_error *error);

#endif
