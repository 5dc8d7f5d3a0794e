/* Scenes and calls for tests of storage policies. */
#ifndef PM_TESTS_POLICIES_H
#define PM_TESTS_POLICIES_H

#include "../src/transport/policies/policy.h"
#include "lit.h"

#include <string.h>

/* A scene, and how much its places mean to a camera. */
typedef struct policed {
    pm__scene *scene;
    pm__importance *importance;
} policed;

static inline pm__importance *policed_importance(const pm__scene *scene, const pm__view *view)
{
    pm_error error;
    pm__camera camera;
    pm__importance *importance;
    PM_CHECK_OK(pm__camera_init(view, 64, 64, &camera, &error), error);
    const pm__importance_config config = {.scene = scene, .camera = &camera, .width = 64, .height = 64, .paths = 8192,
                                          .bounces = 1, .measure = PM__OF_SCREEN, .nearest = 50, .share = 0.5,
                                          .outlier = 100.0, .seed = 17};
    PM_CHECK_OK(pm__importance_create(&config, &importance, &error), error);
    return importance;
}

/* A coloured sphere with a ball of glass and two lamps, of which a camera sees a part of the bottom. */
static inline policed policed_room(void)
{
    static const pm__light left = {.kind = PM__POINT, .position = {-0.6, 0.0, 0.3}, .power = {1.0, 2.0, 3.0}};
    static const pm__light right = {.kind = PM__POINT, .position = {0.1, 0.5, 0.6}, .power = {1.5, 1.5, 1.5}};
    static const pm__view view = {{0.0, 0.0, 0.4}, {0.3, 0.0, -0.9}, {0.0, 1.0, 0.0}, 0.5};
    policed p = {.scene = lit_create()};
    lit_sphere(p.scene, lit_wall(p.scene, 0.7, 0.5, 0.3), 0.0, 0.0, 0.0, 1.0, true);
    lit_sphere(p.scene, lit_glass(p.scene), 0.3, 0.0, -0.3, 0.2, false);
    lit_lamp(p.scene, &left);
    lit_lamp(p.scene, &right);
    lit_commit(p.scene);
    p.importance = policed_importance(p.scene, &view);
    return p;
}

/* The floor |x|, |y| <= 1.5 at z = 0, black, under parallel light of `irradiance` W/m2 in each band, which leaves below
 * a small white ceiling at z = 0.25, and a camera that sees nothing but that: so all of the floor's importance is that
 * of the global map, most about the middle. */
static inline policed policed_floor(double irradiance)
{
    static const double pi = 3.14159265358979323846, radius = 2.2;
    static const double corner[3] = {-0.05, -0.05, 0.25}, u[3] = {0.0, 0.1, 0.0}, v[3] = {0.1, 0.0, 0.0};
    const double power = irradiance * pi * radius * radius;
    const pm__light sun = {.kind = PM__DIRECTIONAL, .position = {0.0, 0.0, 0.2}, .direction = {0.0, 0.0, -1.0},
                           .radius = radius, .power = {power, power, power}};
    static const pm__view view = {{0.0, 0.0, 0.1}, {0.0, 0.0, 0.25}, {0.0, 1.0, 0.0}, 0.4};
    policed p = {.scene = lit_create()};
    pm_error error;
    lit_floor(p.scene, lit_wall(p.scene, 0.0, 0.0, 0.0), 1.5, 0.0);
    PM_CHECK_OK(pm__scene_rectangle(p.scene, lit_wall(p.scene, 0.9, 0.9, 0.9), corner, u, v, &error), error);
    lit_lamp(p.scene, &sun);
    lit_commit(p.scene);
    p.importance = policed_importance(p.scene, &view);
    return p;
}

static inline void policed_free(policed *p)
{
    pm__importance_destroy(p->importance);
    pm__scene_destroy(p->scene);
}

static inline pm__spec policed_spec(const char *text)
{
    pm_error error;
    pm__spec spec;
    PM_CHECK_OK(pm__spec_parse(&pm__policies, text, &spec, &error), error);
    return spec;
}

static inline pm__stored_photons policed_run(const pm__storing_config *config)
{
    pm_error error;
    pm__stored_photons set;
    PM_CHECK_OK(pm__store_photons(config, &set, &error), error);
    return set;
}

static inline pm__stored_photons policed_store(const policed *p, const char *policy, pm__map_kind kind,
                                               uint64_t emitted, uint32_t trial)
{
    const pm__spec spec = policed_spec(policy);
    const pm__storing_config config = {.scene = p->scene, .kind = kind, .policy = &spec, .importance = p->importance,
                                       .seed = 5, .trial = trial, .emitted = emitted, .stored = SIZE_MAX};
    return policed_run(&config);
}

#endif
