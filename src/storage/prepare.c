/* All that the trials of a scene need: its reference, importance, the view, the rows that are to be. */
#include "job.h"

#include "../base/clock.h"
#include "../base/memory.h"
#include "../methods/film.h"
#include "../transport/eye.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* m over the diagonal of the box about what is seen: nearer gathering points would show what a map blurs. */
static const double near_share = 0.01;
/* The same for lookups: farther photons lie on other surfaces, and a search that finds none ends. */
static const double radius_share = 0.1;

/* PIXELS: along the shorter side of the image that importance is of. DEEPER: eye paths for the light that stays, for
 * each by which maps are looked at. SEEN: paths across and down. */
enum { IMPORTONS = 200, OUTLIER = 100, PIXELS = 256, DEEPER = 32, SEEN = 64 };
/* What lookups cost beside photons: for progress alone. */
static const double lookup_work = 0.5;

/* ---- Setting up -------------------------------------------------------------------------------- */

static const char *name_of(const pm__spec *scene)
{
    return scene->entry->name + strlen("scene:");
}

/* Of a scene's defaults. */
static bool has_reference(const pm__spec *scene)
{
    pm__spec plain;
    pm__spec_default(scene->entry, &plain);
    return pm__reference_exists(name_of(scene)) &&
           memcmp(plain.values, scene->values, scene->entry->param_count * sizeof *plain.values) == 0;
}

static pm_status load_reference(const pm__storage_wish *wish, pm__reference *reference, pm_error *error)
{
    char asked[PM__MAX_SPEC];
    pm__spec_format_short(wish->scene, asked, sizeof asked);
    *reference = (pm__reference){0};
    if (!pm__reference_exists(name_of(wish->scene)))
        return pm__fail(error, PM_EINVAL, "%.100s has no stored reference to compare its image with", asked);
    if (!has_reference(wish->scene))
        return pm__fail(error, PM_EINVAL, "%.100s has no stored reference: that of scene:%.30s is of its defaults "
                                          "alone", asked, name_of(wish->scene));
    pm_status status = pm__reference_load(name_of(wish->scene), reference, error);
    if (status == PM_OK && wish->width)
        status = pm__reference_fits(&reference->radiance, wish->width, wish->height, error);
    return status;
}

pm_status pm__storage_check(const pm__storage_wish *wish, pm_error *error)
{
    pm__reference reference;
    const pm_status status = load_reference(wish, &reference, error);
    pm__reference_free(&reference);
    return status;
}

/* The reference's error is stored relative to its mean, as ours is. */
static pm_status weigh_reference(pm__storage_job *job, pm_error *error)
{
    const pm__image *const radiance = &job->reference.radiance, *const own = &job->reference.error;
    const size_t values = 3 * radiance->width * radiance->height;
    for (size_t i = 0; i < values; i++) {
        job->result->truth_mean += (double)radiance->values[i] / (double)values;
        job->own_square += (double)own->values[i] * (double)own->values[i] / (double)values;
    }
    job->result->width = job->wish->width ? job->wish->width : radiance->width;
    job->result->height = job->wish->height ? job->wish->height : radiance->height;
    return job->result->truth_mean > 0.0
               ? PM_OK
               : pm__fail(error, PM_EINVAL, "the reference of %.40s is black: there is no relative error",
                          name_of(job->wish->scene));
}

/* The diagonal of the box about what the camera sees, m: in a large scene that is what lookups are about. 0: it sees
 * nothing. */
static double diagonal_of(const pm__storage_job *job)
{
    double low[3] = {(double)INFINITY, (double)INFINITY, (double)INFINITY}, square = 0.0;
    double high[3] = {-(double)INFINITY, -(double)INFINITY, -(double)INFINITY};
    const double step[2] = {(double)job->result->width / SEEN, (double)job->result->height / SEEN};
    for (uint64_t i = 0; i < (uint64_t)SEEN * SEEN; i++) {
        const pm__eye_numbers numbers = pm__eye_numbers_of(job->wish->seed, 0, 0, i);
        pm__eye eye;
        pm__eye_through(&eye, job->stage.scene, &job->stage.camera, &numbers, ((double)(i % SEEN) + 0.5) * step[0],
                        ((double)(i / SEEN) + 0.5) * step[1]);
        const bool reached = pm__eye_follow(&eye);
        for (int a = 0; reached && a < 3; a++) {
            low[a] = fmin(low[a], eye.hit.position[a]);
            high[a] = fmax(high[a], eye.hit.position[a]);
        }
    }
    for (int a = 0; a < 3; a++)
        square += high[a] > low[a] ? (high[a] - low[a]) * (high[a] - low[a]) : 0.0;
    return sqrt(square);
}

/* References are small images of what would be rendered larger, and policies count photons by its pixels. */
static pm__camera camera_of(const pm__storage_job *job, size_t *width, size_t *height)
{
    const size_t shorter = job->result->width < job->result->height ? job->result->width : job->result->height;
    const size_t finer = (PIXELS + shorter - 1) / shorter;
    pm__camera camera = job->stage.camera;
    *width = finer * job->result->width;
    *height = finer * job->result->height;
    for (int a = 0; a < 3; a++) {
        camera.right[a] /= (double)finer;
        camera.down[a] /= (double)finer;
    }
    return camera;
}

static pm_status make_importance(pm__storage_job *job, pm_error *error)
{
    const pm__storage_wish *const w = job->wish;
    size_t width, height;
    const pm__camera camera = camera_of(job, &width, &height);
    const pm__importance_config config = {.scene = job->stage.scene,
                                          .camera = &camera,
                                          .width = width,
                                          .height = height,
                                          .paths = w->paths,
                                          .bounces = w->gather,
                                          .near = job->result->near,
                                          .measure = w->measure,
                                          .nearest = IMPORTONS,
                                          .share = w->share,
                                          .outlier = OUTLIER,
                                          .seed = w->seed,
                                          .parallel = w->parallel,
                                          .canceled = w->canceled,
                                          .context = w->context};
    const double start = pm__seconds();
    const pm_status status = pm__importance_create(&config, &job->importance, error);
    job->importance_s = pm__seconds() - start;
    return status;
}

static void tell(void *context, double fraction)
{
    const pm__storage_job *const job = context;
    if (job->wish->progress)
        job->wish->progress(job->wish->context, (job->done + pm__view_work * job->work * fraction) /
                                                    ((1.0 + pm__view_work) * job->work), "the view");
}

/* Of a pixel and group. */
static size_t samples_of(const pm__storage_wish *w, size_t pixels)
{
    const size_t samples = (w->looks + PM__GROUPS * pixels / 2) / (PM__GROUPS * pixels);
    return w->spp ? w->spp / PM__GROUPS : samples ? samples : 1;
}

static pm__viewing_config viewing_of(pm__storage_job *job)
{
    const pm__storage_wish *const w = job->wish;
    const size_t pixels = job->result->width * job->result->height;
    job->result->spp = PM__GROUPS * samples_of(w, pixels);
    return (pm__viewing_config){.scene = job->stage.scene,
                                .camera = &job->stage.camera,
                                .reference = &job->reference.radiance,
                                .width = job->result->width,
                                .height = job->result->height,
                                .samples = samples_of(w, pixels),
                                .deep = DEEPER * samples_of(w, pixels),
                                .gather = w->gather,
                                .near = job->result->near,
                                .k = w->k,
                                .radius = job->radius,
                                .photons = w->large,
                                .seed = w->seed,
                                .parallel = w->parallel,
                                .progress = tell,
                                .canceled = pm__storage_canceled,
                                .context = job};
}

/* ---- Items ------------------------------------------------------------------------------------- */

static size_t size_of(const pm__storage_wish *w, size_t i)
{
    return i < w->photon_count ? w->photons[i] : w->stored[i - w->photon_count];
}

static size_t largest_sent(const pm__storage_wish *w)
{
    size_t most = 0;
    for (size_t i = 0; i < w->photon_count; i++)
        most = w->photons[i] > most ? w->photons[i] : most;
    return most ? most : w->large;
}

static pm_status allot(const pm__storage_job *job, pm__storage_item *item)
{
    const size_t trials = job->wish->trials;
    double **const lists[] = {&item->stored,  &item->trace_s, &item->policy_s, &item->build_s, &item->total_s,
                              &item->flux[0], &item->flux[1], &item->came[0],  &item->came[1]};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        if (!(*lists[i] = pm__alloc_zero(trials, sizeof **lists[i])))
            return PM_ENOMEM;
    return item->hidden ? PM_OK
                        : pm__tally_create(pm__viewing_values(job->viewing), trials, job->own_square,
                                           pm__viewing_base(job->viewing), &item->tally);
}

static pm__storage_row row_of(const pm__spec *policy, pm__map_kind kind, size_t photons, size_t wanted)
{
    return (pm__storage_row){.policy = policy, .map = kind, .photons = photons, .wanted = wanted,
                             .spread = (double)NAN};
}

double pm__storage_work(const pm__storage_job *job, const pm__storage_item *item)
{
    const pm__storage_row *const row = &item->row;
    const double looks = item->hidden ? 0.0 : lookup_work * (double)pm__viewing_points(job->viewing, row->map);
    return (double)(row->photons ? row->photons : 4 * row->wanted) + looks;
}

static pm_status add_item(pm__storage_job *job, const pm__storage_row *row, bool hidden, bool largest)
{
    pm__storage_item *const item = &job->items[job->item_count++];
    *item = (pm__storage_item){.row = *row, .hidden = hidden, .largest = largest};
    job->work += (double)job->wish->trials * pm__storage_work(job, item);
    return allot(job, item);
}

/* What `all` catches of the largest number is what is to be expected: of its own row if it has one, else of photons
 * that are sent for that alone. */
static pm_status expect(pm__storage_job *job, pm__map_kind kind)
{
    const size_t most = largest_sent(job->wish);
    for (size_t i = 0; i < job->item_count; i++) {
        const pm__storage_row *const row = &job->items[i].row;
        if (row->map == kind && pm__storage_is_all(row) && row->photons == most) {
            job->expecting[kind] = i;
            return PM_OK;
        }
    }
    const pm__entry *const entry = pm__find(&pm__policies, "all");
    if (!entry)
        return PM_OK;
    pm__spec_default(entry, &job->all);
    const pm__storage_row row = row_of(&job->all, kind, most, 0);
    job->expecting[kind] = job->item_count;
    return add_item(job, &row, true, false);
}

static pm_status make_items(pm__storage_job *job, pm_error *error)
{
    const pm__storage_wish *const w = job->wish;
    const size_t sizes = w->photon_count + w->stored_count;
    pm_status status = PM_OK;
    job->items = pm__alloc_zero(PM__MAP_KINDS * (w->policy_count * sizes + 1), sizeof *job->items);
    job->errors = pm__alloc(PM__GROUPS * pm__viewing_values(job->viewing), sizeof *job->errors);
    if (!job->items || !job->errors)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    for (int kind = 0; kind < PM__MAP_KINDS; kind++)
        for (size_t i = 0; i < w->policy_count * sizes && w->maps[kind] && job->result->has[kind]; i++) {
            const size_t size = i % sizes, number = size_of(w, size);
            const bool sent = size < w->photon_count, last = size + 1 == (w->photon_count ? w->photon_count : sizes);
            const pm__storage_row row = row_of(&w->policies[i / sizes], (pm__map_kind)kind, sent ? number : 0,
                                               sent ? 0 : number);
            if (status == PM_OK)
                status = add_item(job, &row, false, last);
        }
    for (int kind = 0; kind < PM__MAP_KINDS; kind++) {
        job->expecting[kind] = SIZE_MAX;
        if (status == PM_OK && w->maps[kind] && job->result->has[kind])
            status = expect(job, (pm__map_kind)kind);
    }
    return status ? pm__fail(error, status, "out of memory") : PM_OK;
}

/* ---- All of it --------------------------------------------------------------------------------- */

static pm_status check_maps(const pm__storage_job *job, pm_error *error)
{
    const bool *const asked = job->wish->maps, *const has = job->result->has;
    if ((asked[PM__CAUSTIC_MAP] && has[PM__CAUSTIC_MAP]) || (asked[PM__GLOBAL_MAP] && has[PM__GLOBAL_MAP]))
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "%.60s has no light that a %s map holds", name_of(job->wish->scene),
                    !asked[PM__GLOBAL_MAP] ? "caustic" : !asked[PM__CAUSTIC_MAP] ? "global" : "photon");
}

pm_status pm__storage_prepare(pm__storage_job *job, pm_error *error)
{
    pm__storage_result *const r = job->result;
    pm_status status = load_reference(job->wish, &job->reference, error);
    if (status == PM_OK)
        status = weigh_reference(job, error);
    if (status == PM_OK)
        status = pm__stage_open(job->wish->scene, NULL, r->width, r->height, &job->stage, error);
    if (status != PM_OK)
        return status;
    const double diagonal = diagonal_of(job);
    if (!(diagonal > 0.0))
        return pm__fail(error, PM_EINVAL, "the camera sees no surface of %.40s", name_of(job->wish->scene));
    r->near = near_share * diagonal;
    job->radius = radius_share * diagonal;
    job->work = 1.0; /* for the view's progress */
    status = make_importance(job, error);
    const pm__viewing_config viewing = viewing_of(job);
    if (status == PM_OK)
        status = pm__viewing_create(&viewing, &job->viewing, error);
    job->work = 0.0;
    for (int kind = 0; kind < PM__MAP_KINDS && status == PM_OK; kind++)
        r->has[kind] = pm__viewing_has(job->viewing, (pm__map_kind)kind);
    if (status == PM_OK)
        status = check_maps(job, error);
    return status ? status : make_items(job, error);
}

double pm__storage_bytes(const pm__storage_wish *wish)
{
    pm__reference reference;
    double bytes = 0.0;
    if (load_reference(wish, &reference, NULL) == PM_OK) {
        const double values = 3.0 * (double)(reference.radiance.width * reference.radiance.height);
        const double rows = (double)(wish->policy_count * (wish->photon_count + wish->stored_count) * PM__MAP_KINDS);
        const size_t width = wish->width ? wish->width : reference.radiance.width;
        const size_t height = wish->height ? wish->height : reference.radiance.height;
        const pm__viewing_config viewing = {.reference = &reference.radiance,
                                            .width = width,
                                            .height = height,
                                            .samples = samples_of(wish, width * height),
                                            .gather = wish->gather,
                                            .photons = wish->large};
        /* Photons of a path may be stored several times: of the largest map about twice as many as are sent. */
        bytes = pm__viewing_bytes(&viewing) + (rows + 1.0) * PM__GROUPS * values * (double)sizeof(float) +
                2.0 * (double)largest_sent(wish) * (2.0 * (double)sizeof(pm_photon) + 60.0);
    }
    pm__reference_free(&reference);
    return bytes;
}
