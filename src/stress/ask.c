/* The library is asked for estimates, and what it says is held against the judge. */
#include "test.h"

#include "../lookup/lookup.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_MAPS = 64 };

const char *const pm__form_names[PM__FORMS] = {"by number", "by radius", "by both"};

static const char *const status_names[] = {
#define X(name, code, text) #name,
    PM_STATUS_LIST(X)
#undef X
};

/* ---- Rows -------------------------------------------------------------------------------------- */

double pm__ulps(long double got, long double want, long double magnitude, int bits)
{
    int exponent = 0;
    if (got == want)
        return 0.0;
    if (!(magnitude > 0))
        return INFINITY;
    (void)frexpl(magnitude, &exponent);
    return (double)(fabsl(got - want) / ldexpl(1, exponent - bits));
}

void pm__worst_take(pm__worst *worst, double measured, double bound, const char *unit, const char *what)
{
    const double ratio = bound > 0.0 ? measured / bound : measured > 0.0 ? INFINITY : 0.0;
    if (worst->unit && !(ratio > worst->ratio))
        return;
    worst->ratio = ratio;
    worst->measured = measured;
    worst->bound = bound;
    worst->unit = unit;
    if (!worst->failed)
        (void)snprintf(worst->detail, sizeof worst->detail, "%s", what);
}

/* The first failure stays. */
void pm__worst_fail(pm__worst *worst, const char *format, ...)
{
    va_list arguments;
    if (worst->failed)
        return;
    worst->failed = true;
    va_start(arguments, format);
    (void)vsnprintf(worst->detail, sizeof worst->detail, format, arguments);
    va_end(arguments);
}

/* ---- Forms and twins --------------------------------------------------------------------------- */

pm_query pm__form_query(const pm__hood *hood, int form)
{
    pm_query query = hood->query;
    if (form == PM__BY_NUMBER)
        query.max_radius = INFINITY;
    if (form == PM__BY_RADIUS)
        query.k = 0;
    return query;
}

bool pm__form_fits(const pm_search *search, int form)
{
    return !search->radius_only || form == PM__BY_RADIUS;
}

void pm__twin_of(const pm__hood *hood, pm_photon *photons, pm__hood *twin)
{
    *twin = *hood;
    twin->photons = photons;
    for (size_t i = 0; i < hood->count; i++) {
        photons[i] = hood->photons[i];
        for (int c = 0; c < 3; c++)
            photons[i].power[c] = ldexpf(photons[i].power[c], hood->twin_power);
    }
    const int half = hood->twin_length / 2; /* in two steps, for 2^length may be no float */
    pm__hood_stretch(twin, ldexpf(1.0f, half));
    pm__hood_stretch(twin, ldexpf(1.0f, hood->twin_length - half));
}

/* ---- One lookup -------------------------------------------------------------------------------- */

/* A subject's maps of a set. */
typedef struct subject {
    const pm__spec *spec;
    pm_estimator *estimator;
    pm_workspace *workspace;
    pm_map *maps[MOST_MAPS];
    size_t map_count;
} subject;

static pm_status build_maps(subject *s, const pm__hood *hood, const pm_search *search, pm_simd simd)
{
    const pm_map_options options = {.search = search, .simd = simd};
    pm_photon *const part = calloc(hood->count + 1, sizeof *part);
    pm_status status = part ? PM_OK : PM_ENOMEM;
    for (size_t m = 0; m < s->map_count && status == PM_OK; m++) {
        size_t count = 0;
        for (size_t i = m; i < hood->count; i += s->map_count)
            part[count++] = hood->photons[i];
        status = pm_map_create(part, count, &options, &s->maps[m], NULL);
    }
    free(part);
    return status;
}

static void destroy_maps(subject *s)
{
    for (size_t m = 0; m < s->map_count; m++) {
        pm_map_destroy(s->maps[m]);
        s->maps[m] = NULL;
    }
}

/* A k chosen with knowledge of the truth is for a bench to supply: the public interface has no word for it. */
static pm_status ask_oracle(const subject *s, const pm_query *query, int dimensions, size_t k, pm_estimation *found)
{
    const pm__gathering gathering = {NULL, s->maps[0]->unit, true, false};
    pm_status status = pm__gather(s->maps[0], query, &gathering, s->workspace, 0);
    if (status != PM_OK)
        return status;
    pm__point_sets(s->workspace, 1, false);
    const pm__lookup lookup = {.sets = s->workspace->sets, .set_count = 1, .dimensions = dimensions,
                               .normal = {0.0f, 0.0f, 1.0f}, .unit = s->maps[0]->unit, .oracle_k = k};
    status = pm__evaluate(s->spec, &lookup, s->workspace, found->value);
    found->count = lookup.sets[0].count;
    found->radius = sqrt(lookup.sets[0].radius2) * lookup.unit;
    return status;
}

static pm_status ask(const subject *s, const pm_query *query, int dimensions, size_t oracle_k, pm_estimation *found)
{
    const unsigned needs = pm__estimator_of(s->spec)->needs;
    pm_precomputed *stored = NULL;
    pm_status status = PM_OK;
    *found = (pm_estimation){.count = 0};
    if (needs & PM__TRUTH)
        return ask_oracle(s, query, dimensions, oracle_k, found);
    if (needs & PM__AT_PHOTON) {
        const pm_precomputed_options options = {.lookup = *query, .dimensions = dimensions};
        status = pm_precomputed_create(s->estimator, s->maps[0], &options, &stored, NULL);
    }
    const pm_source source = {.maps = (const pm_map *const *)s->maps, .map_count = s->map_count,
                              .precomputed = stored, .dimensions = dimensions};
    if (status == PM_OK)
        status = pm_estimate(s->estimator, &source, query, s->workspace, found);
    pm_precomputed_destroy(stored);
    return status;
}

/* ---- The comparison ---------------------------------------------------------------------------- */

typedef struct expected {
    pm__judge_request request;
    pm__judged judged;
    pm_query query;
    bool coarse; /* of the set */
    char what[120];
} expected;

static bool is_finite(const pm_estimation *found)
{
    return isfinite(found->value[0]) && isfinite(found->value[1]) && isfinite(found->value[2]) &&
           isfinite(found->radius);
}

/* Above the 2.5 * 2^-24 that its root leaves of r squared's error. */
static const double radius_slack = 1e-6;

/* A map's unit is about its largest coordinate. What lies far within, or far without, single precision may refuse. */
static bool may_refuse(const expected *due)
{
    long double largest = 0;
    for (size_t i = 0; i < due->request.count; i++)
        for (int a = 0; a < 3; a++)
            largest = fmaxl(largest, fabsl((long double)due->request.photons[i].position[a]));
    return due->judged.radius < largest * 0x1p-58L || due->judged.radius > largest * 4e17L;
}

static void compare(const expected *due, pm_status status, const pm_estimation *found, pm__worst *worst)
{
    const pm__judged *const j = &due->judged;
    worst->lookups++;
    if (!is_finite(found)) {
        pm__worst_fail(worst, "not finite: %s", due->what);
        return;
    }
    if (!j->clear) {
        worst->unclear++;
        if (status != PM_OK && status != PM_EDEGENERATE)
            pm__worst_fail(worst, "status %s: %s", status_names[status], due->what);
        return;
    }
    if (due->coarse && status == PM_EDEGENERATE && may_refuse(due)) {
        pm__worst_take(worst, 0.0, 1.0, "ulp", due->what);
        return;
    }
    if (status != j->status) {
        pm__worst_fail(worst, "status %s where %s was due: %s", status_names[status], status_names[j->status],
                       due->what);
        return;
    }
    if (found->count != j->count)
        pm__worst_fail(worst, "%zu photons where %zu were due: %s", found->count, j->count, due->what);
    if (status == PM_OK && fabs(found->radius - (double)j->radius) > radius_slack * (double)j->radius)
        pm__worst_fail(worst, "radius %g m where %g was due: %s", found->radius, (double)j->radius, due->what);
    const bool rounds = due->request.rounds;
    for (int c = 0; c < 3; c++)
        pm__worst_take(worst, pm__ulps(found->value[c], j->value[c], j->magnitude[c], rounds ? 24 : 53),
                       pm__judge_bound(&due->request, j), rounds ? "float ulp" : "ulp", due->what);
}

/* The twin's result over the powers of two is the first one's, bit by bit. */
static void compare_twin(const expected *due, pm_status status, const pm_estimation *found, pm_status twin_status,
                         const pm_estimation *twin, const pm__hood *hood, pm__worst *worst)
{
    const int shift = hood->twin_power - due->request.dimensions * hood->twin_length;
    worst->lookups++;
    if (status != twin_status || found->count != twin->count)
        pm__worst_fail(worst, "the scaled set: status %s, %zu photons, not %s, %zu: %s", status_names[twin_status],
                       twin->count, status_names[status], found->count, due->what);
    for (int c = 0; c < 3; c++) {
        const long double want = ldexpl(found->value[c], shift);
        pm__worst_take(worst, pm__ulps(twin->value[c], want, fabsl(want), 53), 0.0, "ulp", due->what);
    }
}

/* ---- All of a set ------------------------------------------------------------------------------ */

enum { DUES = PM__FORMS * 2 };

/* What is due of each form in the plane and in space. */
static pm_status judge_all(const pm__asking *asking, expected *dues)
{
    const pm__hood *const hood = asking->hood;
    for (int form = 0; form < PM__FORMS; form++)
        for (int d = 2; d <= 3; d++) {
            expected *const u = &dues[form * 2 + d - 2];
            u->query = pm__form_query(hood, form);
            u->request = (pm__judge_request){.photons = hood->photons, .count = hood->count, .query = &u->query,
                                             .spec = asking->spec, .dimensions = d, .rounds = hood->rounds,
                                             .oracle_k = hood->query.k / 2};
            pm__judge(&u->request, &u->judged);
            if (u->judged.status == PM_ENOMEM)
                return PM_ENOMEM;
            if (!(pm__estimator_of(asking->spec)->dimensions >> d & 1U))
                u->judged = (pm__judged){.status = PM_EINVAL, .clear = true, .maps = 1};
            u->coarse = hood->coarse;
            (void)snprintf(u->what, sizeof u->what, "%s, %s, %d-D", hood->what, pm__form_names[form], d);
        }
    return PM_OK;
}

/* ENOMEM, of whatever was asked, says nothing of the numbers. */
static pm_status ask_forms(const subject *s, const subject *twin, const pm_search *search, const pm__asking *asking,
                      const pm__hood *twin_hood, const expected *dues, pm__worst *worst)
{
    for (int i = 0; i < DUES; i++) {
        pm_estimation found, scaled;
        const expected *const u = &dues[i];
        if (!pm__form_fits(search, i / 2))
            continue;
        const pm_status status = ask(s, &u->query, u->request.dimensions, u->request.oracle_k, &found);
        if (status == PM_ENOMEM)
            return status;
        if (!asking->hood->twin_length && !asking->hood->twin_power) {
            compare(u, status, &found, worst);
            continue;
        }
        const pm_query query = pm__form_query(twin_hood, i / 2);
        const pm_status other = ask(twin, &query, u->request.dimensions, u->request.oracle_k, &scaled);
        if (other == PM_ENOMEM)
            return other;
        compare_twin(u, status, &found, other, &scaled, asking->hood, worst);
    }
    return PM_OK;
}

static pm_status ask_subject(subject *s, subject *twin, const pm__asking *asking, const pm__hood *twin_hood,
                             const expected *dues, size_t search, size_t width)
{
    const pm_search *const by = asking->searches[search];
    const pm_simd simd = asking->widths->width[width];
    pm_status status = build_maps(s, asking->hood, by, simd);
    if (status == PM_OK)
        status = build_maps(twin, twin_hood, by, simd);
    if (status == PM_OK)
        status = ask_forms(s, twin, by, asking, twin_hood, dues,
                           &asking->worst[search * asking->widths->count + width]);
    destroy_maps(s);
    destroy_maps(twin);
    return status;
}

pm_status pm__stress_ask(const pm__asking *asking)
{
    char name[PM__MAX_SPEC];
    expected dues[DUES];
    pm__hood twin_hood = {.count = 0};
    subject s = {.spec = asking->spec, .map_count = pm__map_count_of(asking->spec)};
    pm_photon *const photons = calloc(asking->hood->count + 1, sizeof *photons);
    pm__spec_format(asking->spec, name, sizeof name);
    pm_status status = photons ? pm_estimator_create(name, &s.estimator, NULL) : PM_ENOMEM;
    if (status == PM_OK)
        status = pm_workspace_create(64, &s.workspace);
    subject twin = s;
    if (status == PM_OK && (asking->hood->twin_length || asking->hood->twin_power))
        pm__twin_of(asking->hood, photons, &twin_hood);
    if (status == PM_OK)
        status = judge_all(asking, dues);
    for (size_t i = 0; i < asking->search_count; i++)
        for (size_t w = 0; w < asking->widths->count && status == PM_OK; w++)
            status = ask_subject(&s, &twin, asking, &twin_hood, dues, i, w);
    pm_estimator_destroy(s.estimator);
    pm_workspace_destroy(s.workspace);
    free(photons);
    return status;
}
