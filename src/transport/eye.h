/* Paths from the camera: through mirrors and glass to rough surfaces, and the light that reaches those. */
#ifndef PM_METHODS_EYE_H
#define PM_METHODS_EYE_H

#include "../base/random.h"
#include "../scene/camera.h"
#include "../scene/scene.h"

/* The numbers of one eye path: a function of seed, pass, trial and pixel, and of how many were taken. */
typedef struct pm__eye_numbers {
    uint64_t seed, number;
    uint32_t pass, block;
} pm__eye_numbers;
pm__eye_numbers pm__eye_numbers_of(uint64_t seed, uint32_t trial, uint32_t pass, uint64_t pixel);
void pm__eye_uniform(pm__eye_numbers *numbers, double u[3]);

typedef struct pm__eye {
    const pm__scene *scene;
    pm__eye_numbers numbers;
    double origin[3], direction[3]; /* of the ray to follow; direction unit */
    uint32_t shape;                 /* that it starts on, or PM__NO_SHAPE */
    const double *absorption;       /* 1/m by band, of what it passes; NULL: nothing */
    double weight[3];               /* of what arrives along it, by band */
    bool sees_lights;               /* lights that it passes count: not where they were sampled already */
    bool sees_caustics;             /* they count again once it has met a mirror or glass */
    double emitted[3];              /* what was seen of them, W/(m2 sr), weighted */
    double travelled;               /* m, along the last straight way */
    int bounces;
    pm__hit hit;                    /* the rough surface reached */
    double facing[3], outgoing[3];  /* its normal on our side; unit, back along the ray */
} pm__eye;

/* A ray with weight 1 from a point in air. */
void pm__eye_start(pm__eye *eye, const pm__scene *scene, const pm__eye_numbers *numbers, const double origin[3],
                   const double direction[3]);

/* The same through the point (x, y) of the camera's image. */
void pm__eye_through(pm__eye *eye, const pm__scene *scene, const pm__camera *camera, const pm__eye_numbers *numbers,
                     double x, double y);

/* Where in its pixel the pass-th sample lies, in [0, 1): points of a (0, 2)-sequence, scrambled by pixel, so every 2^n
 * samples are stratified in all the ways that there are. */
void pm__place_in_pixel(uint64_t seed, uint64_t pixel, uint32_t pass, double at[2]);

/* Goes on to the next surface, and off it where it is mirror or glass (PM__EYE_PASSES). */
typedef enum pm__eye_met { PM__EYE_ENDS, PM__EYE_PASSES, PM__EYE_STANDS } pm__eye_met;
pm__eye_met pm__eye_step(pm__eye *eye);

/* Goes on through mirrors and glass, by chance where they both reflect and refract, to the next rough surface. false:
 * there is none. Radiance changes with the square of the index of refraction where a surface is crossed. */
bool pm__eye_follow(pm__eye *eye);

/* The same with chance left out: every way through mirrors and glass that carries `least` or more of the light, each
 * weighted by its share. visit: `reached` as pm__eye_follow says it; the sum of weights and of `emitted` over all
 * visits is what one path has on average, but for ways that carry less. */
typedef void (*pm__eye_visit)(void *context, const pm__eye *eye, bool reached);
void pm__eye_follow_all(const pm__eye *eye, double least, pm__eye_visit visit, void *context);

/* Off the rough surface, by its BRDF, which goes into the weight. false: absorbed. The way then sees no lights, before
 * a mirror or glass at least. */
bool pm__eye_bounce(pm__eye *eye);

/* One sample of a light from the point reached. */
typedef struct pm__eye_lit {
    pm__light_sample sample; /* where `arrives` */
    bool arrives;            /* light comes to the place, be it from behind the surface */
    double radiance[3];      /* W/(m2 sr), sent back and weighted, if nothing stands between */
} pm__eye_lit;
/* false: nothing is sent back, whatever stands between. */
bool pm__eye_sample(pm__eye *eye, const pm__light *light, pm__eye_lit *lit);
/* Shadow ray: does anything stand between? Only where light arrives. */
bool pm__eye_blocked(const pm__eye *eye, const pm__eye_lit *lit);

/* Adds to radiance what the point reached sends back of the lights, one sample of each, weighted. all: asks for shadow
 * rays even where light comes from behind the surface. */
void pm__eye_direct(pm__eye *eye, bool all, double radiance[3]);

#endif
