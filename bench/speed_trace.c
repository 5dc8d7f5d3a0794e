/* How fast photons are traced: beside Embree alone, and on several threads beside one. */
#include "speed.h"

#include "../src/transport/shoot.h"
#include "tracing.h"

#include <stdio.h>

/* Promised: of Embree's rate, end to end; of one thread's, on two (more are held to no more). */
static const double of_embree = 0.6, of_one_thread = 1.8;

/* Photons whose rays are kept: enough that they do not all lie in the cache. */
enum { MOST_TRACED = 20000 };

pm_status pm__speed_trace(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    pm__tracing_row traced;
    row->photons = config->photons < MOST_TRACED ? config->photons : MOST_TRACED;
    row->threads = 1;
    row->baseline = "embree";
    row->promise = of_embree;
    const pm_status status = pm__bench_tracing(&row->scene, row->photons, seconds, &traced, error);
    if (status != PM_OK)
        return status;
    const double rays = (double)traced.rays;
    row->seconds = 1e-9 * traced.ns_per_ray_traced * rays;
    row->baseline_seconds = 1e-9 * traced.ns_per_ray_embree * rays;
    row->ratio = traced.ratio;
    row->ratio_ci95 = traced.ratio_ci95;
    row->samples = traced.samples;
    row->aa_ratio = traced.aa_ratio;
    row->aa_ci95 = traced.aa_ci95;
    (void)snprintf(row->detail, sizeof row->detail,
                   "%.3g rays a photon; ns a ray: traced %.1f, scene %.1f, embree %.1f, robust %.1f",
                   rays / (double)row->photons, traced.ns_per_ray_traced, traced.ns_per_ray_scene,
                   traced.ns_per_ray_embree, traced.ns_per_ray_robust);
    return PM_OK;
}

/* ---- Threads ----------------------------------------------------------------------------------- */

typedef struct shooting {
    pm__shoot_config config;
    pm_status status;
    uint64_t emitted, stored;
} shooting;

/* A unit is a shot: its number is the trial's. */
static void shoot(void *context, size_t first, size_t repetitions)
{
    shooting *const s = context;
    for (size_t i = 0; i < repetitions && s->status == PM_OK; i++) {
        pm__photon_set set = {0};
        s->config.trial = (uint32_t)((first + i) & 0xffffff);
        s->status = pm__shoot(&s->config, &set, NULL);
        s->emitted += set.emitted;
        s->stored += set.count;
        pm__photon_set_free(&set);
    }
}

static pm_status compare_threads(const pm__speed_config *config, const pm__scene *scene, double seconds,
                                 pm__speed_row *row, pm_error *error)
{
    enum { ONE, ALL };
    shooting all[2];
    for (int i = ONE; i <= ALL; i++)
        all[i] = (shooting){.config = {.scene = scene,
                                       .seed = config->seed,
                                       .count = row->photons,
                                       .emitted = true,
                                       .parallel = i == ALL ? config->parallel : NULL}};
    const pm__bench_variant variants[] = {{"one thread", shoot, &all[ONE]}, {"all", shoot, &all[ALL]}};
    const pm__bench_config bench = {.seconds = seconds, .baseline = ONE, .seed = config->seed,
                                    .canceled = config->canceled, .context = config->context};
    pm__bench_report report;
    pm_status status = pm__bench_run(&bench, variants, 2, &report, error);
    if (status == PM_OK)
        status = all[ONE].status ? all[ONE].status : all[ALL].status;
    if (status == PM_OK) {
        pm__speed_take(&report, ALL, ONE, 1e-9, row);
        (void)snprintf(row->detail, sizeof row->detail, "%.3g million photons a second; %.3g stored of each",
                       1e-6 * (double)row->photons / row->seconds, (double)all[ONE].stored / (double)all[ONE].emitted);
    }
    pm__bench_free(&report);
    return status;
}

pm_status pm__speed_threads(const pm__speed_config *config, double seconds, pm__speed_row *row, pm_error *error)
{
    const pm__case *const subject = (const pm__case *)(const void *)row->scene.entry;
    pm__scene *scene = NULL;
    row->photons = config->photons;
    row->threads = config->threads;
    row->baseline = "one thread";
    row->promise = of_one_thread;
    pm_status status = pm__scene_create(&scene, error);
    if (status == PM_OK)
        status = subject->build(row->scene.values, scene, error);
    if (status == PM_OK)
        status = pm__scene_commit(scene, error);
    if (status == PM_OK)
        status = compare_threads(config, scene, seconds, row, error);
    pm__scene_destroy(scene);
    return status;
}
