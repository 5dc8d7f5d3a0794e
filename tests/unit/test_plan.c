/* The plan: what is skipped makes no difference. Scenes built by hand, where the rules are near their limits; where the
 * front-side filter is left out the image must be the same, bit for bit, as with it. */
#include "../picture.h"

#include <string.h>

static void square(pm__scene *scene, uint32_t material, double half, double z, bool up)
{
    pm_error error;
    const double corner[3] = {-half, -half, z}, x[3] = {2.0 * half, 0, 0}, y[3] = {0, 2.0 * half, 0};
    PM_CHECK_OK(pm__scene_rectangle(scene, material, corner, up ? x : y, up ? y : x, &error), error);
}

static uint32_t paper(pm__scene *scene)
{
    const pm__material material = {.kind = PM__DIFFUSE, .diffuse = {0.8, 0.8, 0.8}, .two_sided = true,
                                   .back = {0.5, 0.5, 0.5}};
    return lit_material(scene, &material);
}

static uint32_t mirror(pm__scene *scene)
{
    const pm__material material = {.kind = PM__MIRROR, .specular = {0.9, 0.9, 0.9}};
    return lit_material(scene, &material);
}

static void lamp_at(pm__scene *scene, double z)
{
    const pm__light light = {.kind = PM__POINT, .power = {1, 1, 1}, .position = {0.1, 0.1, z}};
    lit_lamp(scene, &light);
}

static void beam(pm__scene *scene, double x, double z, double dx, double dz, double radius)
{
    const pm__light light = {.kind = PM__DIRECTIONAL, .power = {1, 1, 1}, .position = {x, 0, z},
                             .direction = {dx, 0, dz}, .radius = radius};
    lit_lamp(scene, &light);
}

static void spot(pm__scene *scene, double z, double dz, double angle)
{
    const pm__light light = {.kind = PM__SPOT, .power = {1, 1, 1}, .position = {0, 0, z}, .direction = {0, 0, dz},
                             .angle = angle};
    lit_lamp(scene, &light);
}

static void sun(pm__scene *scene, double x, double z, double dx, double dz, double angle)
{
    const pm__light light = {.kind = PM__SUN, .power = {1, 1, 1}, .position = {x, 0, z}, .direction = {dx, 0, dz},
                             .radius = 0.9, .angle = angle};
    lit_lamp(scene, &light);
}

static void panel(pm__scene *scene, double low, double high)
{
    const pm__light light = {.kind = PM__RECTANGLE, .power = {1, 1, 1}, .position = {-2, -0.3, low},
                             .edge = {{0, 0.6, 0}, {0, 0, high - low}}};
    lit_lamp(scene, &light);
}

static void ball(pm__scene *scene, double z, double radius)
{
    const pm__light light = {.kind = PM__BALL, .power = {1, 1, 1}, .position = {0, 0, z}, .radius = radius};
    lit_lamp(scene, &light);
}

/* ---- Scenes ------------------------------------------------------------------------------------ */

static void lit_from_above(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    lamp_at(s, 1);
}

static void lit_from_below(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    lamp_at(s, -1);
}

static void lit_from_both(pm__scene *s)
{
    lit_from_above(s);
    lamp_at(s, -1);
}

static void mirror_above(pm__scene *s)
{
    lit_from_above(s);
    square(s, mirror(s), 2, 3, false);
}

static void mirror_below(pm__scene *s)
{
    lit_from_above(s);
    square(s, mirror(s), 4, -3, true);
}

static void glass_above(pm__scene *s)
{
    lit_from_above(s);
    lit_sphere(s, lit_glass(s), 0, 0, 0.5, 0.3, false);
}

static void glass_across(pm__scene *s)
{
    lit_from_above(s);
    lit_sphere(s, lit_glass(s), 0.9, 0, 0.1, 0.3, false);
}

static void beam_down(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    beam(s, -1, 0.2, 0.98, -sqrt(1 - 0.9604), 1);
}

static void beam_up(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    beam(s, -2, 0.2, 0.98, sqrt(1 - 0.9604), 1);
}

static void beam_below(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    beam(s, -2, -0.4, 0.98, sqrt(1 - 0.9604), 0.1);
}

static void sun_down(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    sun(s, -1, 0.2, 0.98, -sqrt(1 - 0.9604), 0.1);
}

static void sun_that_spreads(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    sun(s, -1, 0.2, 0.98, -sqrt(1 - 0.9604), 0.3);
}

static void sun_from_below(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    sun(s, -1, -0.2, 0.98, sqrt(1 - 0.9604), 0.1);
}

static void panel_above(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    panel(s, 0.0, 1.0);
}

static void panel_across(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    panel(s, -1.0, 1.0);
}

static void ball_above(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    ball(s, 0.5, 0.4);
}

static void ball_across(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    ball(s, 0.1, 0.4);
}

static void two_in_one_plane(pm__scene *s)
{
    pm_error error;
    const double centre[3] = {2, 0, 0}, up[3] = {0, 0, 1};
    lit_from_above(s);
    PM_CHECK_OK(pm__scene_disc(s, lit_wall(s, 0.5, 0.5, 0.5), centre, up, 0.5, &error), error);
}

static void two_planes(pm__scene *s)
{
    lit_from_above(s);
    square(s, paper(s), 0.5, -0.01, true);
}


static void (*make)(pm__scene *scene);

static pm_status build(const double *values, pm__scene *scene, pm_error *error)
{
    (void)values;
    (void)error;
    make(scene);
    return PM_OK;
}

static void view(const double *values, pm__view *from)
{
    (void)values;
    *from = (pm__view){.eye = {0.3, -2, 2.5}, .at = {0, 0, 0}, .up = {0, 0, 1}, .angle = 0.9};
}

static const pm__case by_hand = {.entry = {.name = "scene:by-hand"}, .dimensions = 2, .build = build, .view = view};

/* From above, and from below. */
static const struct {
    void (*make)(pm__scene *scene);
    bool front[2];
} floors[] = {
    {lit_from_above, {false, true}}, {lit_from_below, {true, false}}, {lit_from_both, {true, true}},
    {mirror_above, {false, true}},   {mirror_below, {true, true}},    {glass_above, {false, true}},
    {glass_across, {true, true}},    {beam_down, {false, true}},      {beam_up, {true, false}},
    {beam_below, {true, false}},     {sun_down, {false, true}},       {sun_that_spreads, {true, true}},
    {sun_from_below, {true, false}}, {panel_above, {false, true}},    {panel_across, {true, true}},
    {ball_above, {false, true}},     {ball_across, {true, true}},     {two_in_one_plane, {false, true}},
    {two_planes, {true, true}},
};

START_TEST(the_front_is_asked_for_where_it_matters)
{
    picture *const p = picture_of(&by_hand, "visualize", "disc");
    pm__view below;
    view(NULL, &below);
    below.eye[2] = -2.5;
    p->config.photons = 3000;
    for (size_t i = 0; i < 2 * sizeof floors / sizeof *floors; i++) {
        make = floors[i / 2].make;
        p->config.view = i % 2 ? &below : NULL;
        p->config.no_skip = false;
        const pm__plan plan = picture_plan(p);
        ck_assert_msg(picture_step(&plan, "front-side filter") == floors[i / 2].front[i % 2], "scene %zu, from %s",
                      i / 2, i % 2 ? "below" : "above");
        pm__render_result some = picture_render(p);
        p->config.no_skip = true;
        pm__render_result all = picture_render(p);
        ck_assert_msg(picture_same(&some.images[0].radiance, &all.images[0].radiance), "scene %zu, from %s: the plan "
                      "changes the image", i / 2, i % 2 ? "below" : "above");
        pm__render_free(&some);
        pm__render_free(&all);
    }
    picture_free(p);
}
END_TEST

/* The same of the scenes that there are, but for those whose photons are aimed, and so are others. */
START_TEST(no_scene_is_changed_by_its_plan)
{
    size_t aimed = 0;
    for (size_t i = 0; i < pm__scene_cases.count; i++) {
        picture *const p = picture_create(pm__scene_cases.entries[i]->name, "visualize", "disc,cone,precomputed");
        p->config.photons = 1000;
        p->config.k = 20;
        p->config.width = p->config.height = 12;
        p->config.spp = 1;
        const pm__plan plan = picture_plan(p);
        const bool others = picture_step(&plan, "projection map");
        pm__render_result some = picture_render(p);
        p->config.no_skip = true;
        pm__render_result all = picture_render(p);
        ck_assert(!picture_step(&plan, "equal maps")); /* disc and cone have one, in `all` each its own */
        for (size_t j = 0; j < some.count; j++)
            ck_assert_msg(others || picture_same(&some.images[j].radiance, &all.images[j].radiance), "%s: image %zu",
                          pm__scene_cases.entries[i]->name, j);
        aimed += others;
        pm__render_free(&some);
        pm__render_free(&all);
        picture_free(p);
    }
    ck_assert_uint_lt(aimed, pm__scene_cases.count / 2);
}
END_TEST

/* The side without light is black, though photons lie on the other. */
START_TEST(the_dark_side_is_dark)
{
    picture *const p = picture_of(&by_hand, "visualize", "disc,precomputed");
    make = lit_from_below;
    pm__render_result result = picture_render(p);
    for (size_t i = 0; i < 2; i++)
        PM_CHECK_NEAR(picture_mean(&result.images[i].radiance, 0), 0.0, 0.0);
    pm__render_free(&result);
    picture_free(p);
}
END_TEST

/* ---- Caustics ---------------------------------------------------------------------------------- */

static void away_from_mirror(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    square(s, mirror(s), 1, 3, false);
    spot(s, 2, -1, 0.5);
}

static void at_mirror(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    square(s, mirror(s), 1, 3, false);
    spot(s, 2, 1, 0.5);
}

static void mirror_to_the_sky(pm__scene *s)
{
    square(s, paper(s), 1, 0, true);
    square(s, mirror(s), 3, -1, true);
    lamp_at(s, 1);
}


static const struct {
    const char *name;
    void (*make)(pm__scene *scene);
    bool caustic, global;
} lit[] = {
    {"away from the mirror", away_from_mirror, false, true}, {"at the mirror", at_mirror, true, true},
    {"one floor", lit_from_above, false, false},             {"two planes", two_planes, false, true},
    {"one plane", two_in_one_plane, false, false},           {"lit from below", lit_from_below, false, false},
};

START_TEST(what_full_skips)
{
    picture *const p = picture_of(&by_hand, "full", "disc");
    for (size_t i = 0; i < sizeof lit / sizeof *lit; i++) {
        make = lit[i].make;
        p->config.no_skip = false;
        pm__plan plan = picture_plan(p);
        ck_assert_msg(picture_step(&plan, "caustic pass") == lit[i].caustic, "%s", lit[i].name);
        ck_assert_msg(picture_step(&plan, "projection map") == lit[i].caustic, "%s", lit[i].name);
        ck_assert_msg(picture_step(&plan, "global map") == lit[i].global, "%s", lit[i].name);
        p->config.no_skip = true;
        const pm__plan skipping = plan;
        plan = picture_plan(p);
        ck_assert(picture_step(&plan, "caustic pass") && picture_step(&plan, "global map"));
        for (size_t j = 0; j < plan.count; j++) /* what is not as it would be says why */
            ck_assert_msg(plan.steps[j].done == skipping.steps[j].done || strstr(plan.steps[j].why, "--no-skip"),
                          "%s: %s: %s", lit[i].name, plan.steps[j].name, plan.steps[j].why);
        ck_assert(!picture_step(&plan, "projection map"));
        pm__render_result result = picture_render(p);
        pm__render_free(&result);
    }
    picture_free(p);
}
END_TEST

/* Estimators that can look into one map do, whatever those say that have maps of another kind. */
START_TEST(equal_maps_are_one)
{
    static const struct {
        const char *method, *estimators;
        bool several;
    } looks[] = {{"visualize", "disc", false},      {"visualize", "disc,combined,precomputed", false},
                 {"visualize", "disc,hull", true},  {"full", "cone,gaussian,combined", true}};
    for (size_t i = 0; i < sizeof looks / sizeof *looks; i++) {
        picture *const p = picture_of(&by_hand, looks[i].method, looks[i].estimators);
        make = at_mirror;
        const pm__plan plan = picture_plan(p);
        ck_assert(!picture_step(&plan, "equal maps"));
        p->config.no_skip = true;
        const pm__plan all = picture_plan(p);
        ck_assert_msg(picture_step(&all, "equal maps") == looks[i].several, "%s of %s", looks[i].method,
                      looks[i].estimators);
        picture_free(p);
    }
}
END_TEST

/* Light reaches the mirror, but from there no rough surface: there are no caustic photons, and none is missed. */
START_TEST(caustics_that_go_nowhere)
{
    picture *const p = picture_of(&by_hand, "full", "disc,precomputed,combined");
    make = mirror_to_the_sky;
    pm__render_result result = picture_render(p);
    ck_assert_uint_eq(result.count, 3);
    for (size_t i = 0; i < 3; i++)
        ck_assert_double_gt(picture_mean(&result.images[i].radiance, 0), 0.0);
    pm__render_free(&result);
    picture_free(p);
}
END_TEST

PM_TEST_MAIN("plan", the_front_is_asked_for_where_it_matters, no_scene_is_changed_by_its_plan, the_dark_side_is_dark,
             what_full_skips, equal_maps_are_one, caustics_that_go_nowhere)
