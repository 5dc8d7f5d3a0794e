/* The camera: directions worked out by hand, what is refused, and where it may stand. */
#include "../../src/base/vec3.h"
#include "../picture.h"

static const double right_angle = 1.5707963267948966;

static void check_direction(const pm__camera *camera, double x, double y, double a, double b, double c)
{
    double got[3], want[3] = {a, b, c};
    pm__normalize(want);
    pm__camera_direction(camera, x, y, got);
    for (int i = 0; i < 3; i++)
        PM_CHECK_NEAR(got[i], want[i], 1e-15);
}

static pm__camera camera_of(const pm__view *view, size_t width, size_t height)
{
    pm_error error = {""};
    pm__camera camera;
    PM_CHECK_OK(pm__camera_init(view, width, height, &camera, &error), error);
    return camera;
}

/* Along y with z up, x is on the right; a half angle of 45 degrees is as high as far. */
START_TEST(directions_by_hand)
{
    const pm__view view = {.eye = {5, 6, 7}, .at = {5, 16, 7}, .up = {0, 0, 1}, .angle = right_angle};
    const pm__camera camera = camera_of(&view, 4, 2);
    check_direction(&camera, 2, 1, 0, 1, 0);
    check_direction(&camera, 0, 0, -2, 1, 1);
    check_direction(&camera, 4, 0, 2, 1, 1);
    check_direction(&camera, 0, 2, -2, 1, -1);
    check_direction(&camera, 4, 2, 2, 1, -1);
    check_direction(&camera, 2.5, 0.5, 0.5, 1, 0.5);
    for (int i = 0; i < 3; i++)
        PM_CHECK_NEAR(camera.eye[i], view.eye[i], 0.0);
}
END_TEST

/* The angle is of the height; pixels are square whatever the width. */
START_TEST(the_angle_is_of_the_height)
{
    const double half = 0.3, top = tan(half);
    const pm__view view = {.eye = {0, 0, 0}, .at = {-3, 0, 0}, .up = {0, 0, 2}, .angle = 2.0 * half};
    static const size_t sizes[][2] = {{1, 1}, {7, 7}, {300, 20}, {20, 300}};
    for (size_t i = 0; i < sizeof sizes / sizeof *sizes; i++) {
        const double w = (double)sizes[i][0], h = (double)sizes[i][1];
        const pm__camera camera = camera_of(&view, sizes[i][0], sizes[i][1]);
        check_direction(&camera, 0.5 * w, 0.0, -1, 0, top);
        check_direction(&camera, 0.5 * w, h, -1, 0, -top);
        check_direction(&camera, w, 0.5 * h, -1, top * w / h, 0);
    }
}
END_TEST

/* Only the part of `up` across the view counts, and neither its length nor the distance of what is looked at. */
START_TEST(up_need_be_neither_unit_nor_across)
{
    const pm__view plain = {.eye = {0, 0, 0}, .at = {1, 0, 0}, .up = {0, 0, 1}, .angle = 1};
    const pm__camera want = camera_of(&plain, 8, 6);
    static const double ups[][3] = {{0, 0, 1e-150}, {0, 0, 1e150}, {0, 0, 1e-300}, {0, 0, 1e300},
                                    {1e3, 0, 1},    {-50, 0, 0.5}};
    static const double ahead[] = {1e-150, 1e-6, 1e6, 1e150, 1, 1};
    for (size_t i = 0; i < sizeof ups / sizeof *ups; i++) {
        pm__view view = plain;
        memcpy(view.up, ups[i], sizeof view.up);
        view.at[0] = ahead[i];
        const pm__camera got = camera_of(&view, 8, 6);
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++) {
                double one[3], other[3];
                pm__camera_direction(&want, 4.0 * a, 3.0 * c, one);
                pm__camera_direction(&got, 4.0 * a, 3.0 * c, other);
                for (int axis = 0; axis < 3; axis++)
                    PM_CHECK_NEAR(other[axis], one[axis], 1e-12);
            }
    }
}
END_TEST

/* A point back to where its direction came from, however far it is; density by finite differences: the solid angle of
 * a small square about it is that of the triangles of its corners' directions (Van Oosterom and Strackee 1983). */
static double solid_angle(const double a[3], const double b[3], const double c[3])
{
    double bc[3];
    pm__cross(b, c, bc);
    return 2.0 * atan2(fabs(pm__dot(a, bc)), 1.0 + pm__dot(a, b) + pm__dot(b, c) + pm__dot(c, a));
}

static double pixels_to_the_steradian(const pm__camera *camera, double x, double y)
{
    const double half = 1e-3;
    double corner[4][3];
    for (int i = 0; i < 4; i++)
        pm__camera_direction(camera, i & 1 ? x + half : x - half, i & 2 ? y + half : y - half, corner[i]);
    const double angle = solid_angle(corner[0], corner[1], corner[2]) + solid_angle(corner[3], corner[1], corner[2]);
    return 4.0 * half * half / angle;
}

START_TEST(points_are_projected)
{
    const pm__view view = {.eye = {0.3, -1, 2}, .at = {2, 5, 1}, .up = {0.1, 0.2, 1}, .angle = 1.9};
    const pm__camera camera = camera_of(&view, 16, 9);
    static const double distances[] = {1e-3, 1.0, 1e4};
    for (int i = 0; i < 60; i++) {
        const double x = -2.0 + 0.35 * i, y = -1.0 + 0.17 * ((7 * i) % 60); /* and outside the image */
        const double distance = distances[i % 3];
        double direction[3], point[3], at[2], density;
        pm__camera_direction(&camera, x, y, direction);
        for (int a = 0; a < 3; a++)
            point[a] = camera.eye[a] + distance * direction[a];
        ck_assert(pm__camera_project(&camera, point, at, &density));
        PM_CHECK_NEAR(at[0], x, 1e-10);
        PM_CHECK_NEAR(at[1], y, 1e-10);
        PM_CHECK_NEAR(density / pixels_to_the_steradian(&camera, x, y), 1.0, 1e-6);
        for (int a = 0; a < 3; a++)
            point[a] = camera.eye[a] - distance * direction[a];
        ck_assert(!pm__camera_project(&camera, point, at, &density));
    }
}
END_TEST

/* All of a pixel's steradians, by hand: one pixel of half angle 45 degrees covers a sixth of all directions, and the
 * mean of 1 / density over it, by the midpoint rule, is that solid angle. */
START_TEST(a_pixel_is_a_face_of_a_cube)
{
    enum { N = 200 };
    const pm__view view = {.eye = {1, 2, 3}, .at = {1, 2, -7}, .up = {0, 1, 0}, .angle = right_angle};
    const pm__camera camera = camera_of(&view, 1, 1);
    double sum = 0.0;
    for (int i = 0; i < N * N; i++) {
        double point[3], at[2], density;
        pm__camera_direction(&camera, (i % N + 0.5) / N, (i / N + 0.5) / N, point);
        for (int a = 0; a < 3; a++)
            point[a] += view.eye[a];
        ck_assert(pm__camera_project(&camera, point, at, &density));
        sum += 1.0 / density / (N * N);
    }
    PM_CHECK_NEAR(sum, 4.0 / 3.0 * right_angle, 1e-4); /* 4 pi / 6 */
    const double eye[3] = {1, 2, 3};
    double at[2], density;
    ck_assert(!pm__camera_project(&camera, eye, at, &density));
}
END_TEST

static void refused(const pm__view *view, size_t width, size_t height, const char *part)
{
    pm_error error = {""};
    pm__camera camera;
    ck_assert_int_eq(pm__camera_init(view, width, height, &camera, &error), PM_EINVAL);
    ck_assert_msg(strstr(error.text, part), "\"%s\" does not say \"%s\"", error.text, part);
}

START_TEST(what_is_refused)
{
    const pm__view good = {.eye = {0, 0, 0}, .at = {1, 0, 0}, .up = {0, 0, 1}, .angle = 1};
    static const double angles[] = {0.0, -1.0, 3.14159265358979323846, 4.0, (double)INFINITY, (double)NAN};
    pm__view view = good;
    for (size_t i = 0; i < sizeof angles / sizeof *angles; i++) {
        view.angle = angles[i];
        refused(&view, 2, 2, "angle");
    }
    refused(&good, 0, 2, "0 x 2");
    refused(&good, 2, 0, "2 x 0");
    view = good;
    view.at[0] = 0.0;
    refused(&view, 2, 2, "where it stands");
    view = good;
    view.up[0] = 1.0;
    view.up[2] = 0.0;
    refused(&view, 2, 2, "along its view");
    view.up[2] = 1e-10;
    refused(&view, 2, 2, "along its view");
    view = good;
    view.up[2] = 0.0;
    refused(&view, 2, 2, "along its view");
    for (int i = 0; i < 9; i++) {
        view = good;
        double *const all[] = {view.eye, view.at, view.up};
        all[i / 3][i % 3] = i % 2 ? (double)NAN : (double)INFINITY;
        refused(&view, 2, 2, "finite");
    }
}
END_TEST

/* ---- Walls ------------------------------------------------------------------------------------- */

typedef enum solid { BALL, RECTANGLES, MESH } solid;

/* What the camera stands in, at the origin. */
static struct {
    solid form;
    bool inward;
    pm__material material;
} around;

static void add_side(pm__scene *scene, uint32_t material, int axis, double sign)
{
    double corner[3] = {-1, -1, -1}, u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    pm_error error = {""};
    corner[axis] = sign;
    const bool along = (sign > 0.0) != around.inward; /* the normal */
    u[(axis + (along ? 1 : 2)) % 3] = 2.0;
    v[(axis + (along ? 2 : 1)) % 3] = 2.0;
    PM_CHECK_OK(pm__scene_rectangle(scene, material, corner, u, v, &error), error);
}

static void add_mesh(pm__scene *scene, uint32_t material)
{
    float vertices[8][3];
    uint32_t triangles[12][3];
    size_t next = 0;
    pm_error error = {""};
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 3; a++)
            vertices[i][a] = i >> a & 1 ? 1.0f : -1.0f;
    for (unsigned axis = 0; axis < 3; axis++)
        for (unsigned side = 0; side < 2; side++) {
            const unsigned a = 1U << (axis + 1) % 3, b = 1U << (axis + 2) % 3, base = side << axis;
            const bool along = (side == 1) != around.inward;
            const unsigned u = along ? a : b, v = along ? b : a;
            const uint32_t both[2][3] = {{base, base | u, base | u | v}, {base, base | u | v, base | v}};
            memcpy(triangles[next], both, sizeof both);
            next += 2;
        }
    PM_CHECK_OK(pm__scene_mesh(scene, material, (const float(*)[3])vertices, 8, (const uint32_t(*)[3])triangles, 12,
                               &error), error);
}

static pm_status build_around(const double *values, pm__scene *scene, pm_error *error)
{
    (void)values;
    (void)error;
    const pm__light light = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0, 0, 5}};
    const uint32_t material = lit_material(scene, &around.material);
    if (around.form == BALL)
        lit_sphere(scene, material, 0, 0, 0, 1, around.inward);
    else if (around.form == MESH)
        add_mesh(scene, material);
    for (int i = 0; i < 6 && around.form == RECTANGLES; i++)
        add_side(scene, material, i / 2, i % 2 ? -1.0 : 1.0);
    lit_floor(scene, lit_wall(scene, 0.5, 0.5, 0.5), 20.0, -10.0);
    lit_lamp(scene, &light);
    return PM_OK;
}

static void view_around(const double *values, pm__view *view)
{
    (void)values;
    *view = (pm__view){.eye = {0.2, 0.1, -0.3}, .at = {1, 1, 1}, .up = {0, 0, 1}, .angle = 1};
}

static const pm__case around_case = {
    .entry = {.name = "scene:around"}, .dimensions = 2, .build = build_around, .view = view_around};

START_TEST(a_camera_inside_a_wall_is_refused)
{
    static const pm__material_kind opaque[] = {PM__DIFFUSE, PM__GLOSSY, PM__MIRROR, PM__BLACK};
    picture *const p = picture_of(&around_case, "visualize", "disc");
    const pm__view outside = {.eye = {1.5, 0, 0}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 1};
    for (int form = BALL; form <= MESH; form++) {
        around.form = (solid)form;
        for (size_t i = 0; i < sizeof opaque / sizeof *opaque; i++) {
            around.material = (pm__material){.kind = opaque[i]};
            around.inward = false;
            p->config.view = NULL;
            picture_refused(p, "stands inside a wall");
            p->config.view = &outside;
            (void)picture_plan(p);
            p->config.view = NULL;
            around.inward = true; /* a room */
            (void)picture_plan(p);
        }
        for (int inward = 0; inward < 2; inward++) { /* glass, and a bubble in it */
            around.inward = inward;
            around.material = (pm__material){.kind = PM__GLASS, .ior = {1.5, 1.5, 1.5}};
            (void)picture_plan(p);
        }
    }
    picture_free(p);
}
END_TEST

/* In what stands in a room there is nothing to see: whoever looks from there is told. */
START_TEST(nobody_stands_in_a_block)
{
    static const struct {
        const char *scene;
        double eye[3];
        bool inside;
    } places[] = {{"scene:cornell-diffuse", {-0.17, 0.14, 0.3}, true},
                  {"scene:cornell-diffuse", {0.17, -0.2, 0.01}, true},
                  {"scene:cornell-diffuse", {0.17, -0.2, 0.31}, false},
                  {"scene:cornell-diffuse", {0, -0.4, 0.1}, false},
                  {"scene:four-lights", {-0.45, 0.55, 0.2}, true}};
    for (size_t i = 0; i < sizeof places / sizeof *places; i++) {
        picture *const p = picture_create(places[i].scene, "visualize", "disc");
        pm__view view = {.at = {0, 0, 0.9}, .up = {0, 0, 1}, .angle = 1};
        memcpy(view.eye, places[i].eye, sizeof view.eye);
        p->config.view = &view;
        if (places[i].inside)
            picture_refused(p, "stands inside a wall");
        else
            (void)picture_plan(p);
        picture_free(p);
    }
}
END_TEST

PM_TEST_MAIN("camera", directions_by_hand, the_angle_is_of_the_height, up_need_be_neither_unit_nor_across,
             points_are_projected, a_pixel_is_a_face_of_a_cube, what_is_refused, a_camera_inside_a_wall_is_refused,
             nobody_stands_in_a_block)
