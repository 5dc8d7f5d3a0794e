/* Path tracing (Kajiya 1986): the judge of the other methods where no formula is. At every rough surface each light is
 * sampled once, and the path goes on by the BRDF; lights that a path meets count where it comes straight from the
 * camera or a mirror or glass, so caustics are seen only of lights that have an area. */
#include "method.h"
#include "plan_steps.h"

static void plan(const pm__render_job *job, pm__plan *plan, pm__needs *needs)
{
    size_t hidden = 0;
    for (size_t i = 0; i < pm__scene_light_count(job->scene); i++)
        hidden += !pm__light_shows(pm__scene_light_at(job->scene, i));
    const size_t specular = pm__count_objects(job->scene, pm__is_specular);
    pm__plan_step(plan, false, "photon map", "paths from the camera need none");
    pm__plan_step(plan, false, "caustic pass",
                  !specular ? "no specular surface"
                  : hidden  ? "none: caustics of lights without an area are MISSING here"
                            : "paths find lights through mirrors and glass");
    needs->behind = job->config->no_skip;
    pm__plan_step(plan, true, "shadow rays", needs->behind ? "to every light"
                                                           : "to lights in front of the surface that shine that way");
    pm__plan_volume(job, plan);
}

static pm_status sample(const pm__render_job *job, const void *state, const pm__tile *tile, pm__sample *samples,
                        double (*truth)[3])
{
    (void)state;
    (void)truth;
    for (size_t p = 0; p < pm__tile_pixels(tile); p++) {
        pm__eye eye;
        double radiance[3] = {0.0, 0.0, 0.0};
        pm__tile_eye(job, tile, p, tile->trial, &eye);
        while (pm__eye_follow(&eye)) {
            pm__eye_direct(&eye, job->needs.behind, radiance);
            if (!pm__eye_bounce(&eye))
                break;
        }
        for (int b = 0; b < 3; b++)
            samples[p].radiance[b] = radiance[b] + eye.emitted[b];
    }
    return PM_OK;
}

const pm__method pm__method_path = {
    .entry = {.name = "path",
              .summary = "path tracing with a sample of each light at every bounce; no photons",
              .citation = "Kajiya 1986"},
    .plan = plan,
    .sample = sample,
};
