/* Sums of 1e8 small terms, as a lookup with that many photons has them.
 *
 * A megaphoton is laid out 96 times over in address space, each time from the same memory, and handed to the estimator
 * as one set that its radius cuts. What is due is 96 times the judge's sum over the megaphoton (whose own error, 2^20
 * 2^-64 at most, does not matter here). The bound is the one of all sums, n + ..., 1e8 ulps or a relative 1e-8. hull is
 * left out: it wants 40 bytes of working memory for each photon. */
#include "test.h"

#include "../../estimators/estimator.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { PATTERN = 1 << 20, TIMES = 96 };

/* Sets cut by a radius of 1, for which these are the disc, each over its own detours. */
static const struct {
    const char *name, *due;
} subjects_here[] = {{"disc", "disc"},
                     {"cone", "cone"},
                     {"gaussian", "gaussian"},
                     {"gaussian:form=pavicic", "gaussian:form=pavicic"},
                     {"epanechnikov", "epanechnikov"},
                     {"biweight", "biweight"},
                     {"differential:start=2,trend=1000000000", "disc"},
                     {"combined", "disc"},
                     {"combined:rule=mean", "disc"},
                     {"precomputed", "disc"},
                     {"oracle", "disc"}};
enum { SUBJECTS = sizeof subjects_here / sizeof *subjects_here };

static size_t subjects(bool full)
{
    (void)full;
    return SUBJECTS;
}

/* `bytes` of memory, a whole number of pages, that appear `times` times in a row. NULL: refused. */
static void *repeat(const void *content, size_t bytes, size_t times)
{
    const int file = memfd_create("terms", MFD_CLOEXEC);
    char *place = NULL;
    if (file < 0)
        return NULL;
    if (ftruncate(file, (off_t)bytes) == 0) {
        place = mmap(NULL, bytes * times, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        place = place == MAP_FAILED ? NULL : place;
    }
    for (size_t i = 0; i < times && place; i++)
        if (mmap(place + i * bytes, bytes, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_FIXED, file, 0) == MAP_FAILED) {
            (void)munmap(place, bytes * times);
            place = NULL;
        }
    (void)close(file);
    if (place)
        memcpy(place, content, bytes);
    return place;
}

typedef struct terms {
    pm_photon *photons;
    float *distance2, *flux; /* once */
    float *all_distance2;    /* TIMES times over */
    float (*all_flux)[3];
} terms;

/* Small powers, over six orders of magnitude; distances on the lattice, so that squares are exact. */
static void draw(const pm__stress_config *config, bool sorted, terms *t)
{
    pm__dice dice = {.seed = config->seed, .test = 2000};
    for (size_t i = 0; i < PATTERN; i++) {
        const float x = (float)(sorted ? 1024 : pm__roll_between(&dice, 1, 1024)) * 0x1p-10f;
        t->photons[i] = (pm_photon){.position = {x, 0.0f, 0.0f}};
        t->distance2[i] = x * x;
        const float power = (float)(1e-8 * exp2(20.0 * pm__roll(&dice)));
        for (int c = 0; c < 3; c++)
            t->photons[i].power[c] = t->flux[3 * i + (size_t)c] = power * (float)(1 + c);
    }
}

static pm_status open_terms(const pm__stress_config *config, bool sorted, terms *t)
{
    *t = (terms){.photons = calloc(PATTERN, sizeof *t->photons),
                 .distance2 = calloc(PATTERN, sizeof *t->distance2),
                 .flux = calloc(PATTERN, 3 * sizeof *t->flux)};
    if (!t->photons || !t->distance2 || !t->flux)
        return PM_ENOMEM;
    draw(config, sorted, t);
    t->all_distance2 = repeat(t->distance2, PATTERN * sizeof *t->distance2, TIMES);
    t->all_flux = repeat(t->flux, PATTERN * 3 * sizeof *t->flux, TIMES);
    return t->all_distance2 && t->all_flux ? PM_OK : PM_ENOMEM;
}

static void close_terms(terms *t)
{
    if (t->all_distance2)
        (void)munmap(t->all_distance2, TIMES * PATTERN * sizeof *t->distance2);
    if (t->all_flux)
        (void)munmap(t->all_flux, TIMES * PATTERN * 3 * sizeof *t->flux);
    free(t->photons);
    free(t->distance2);
    free(t->flux);
}

static const pm__estimator *estimator_of(const pm__spec *spec)
{
    return (const pm__estimator *)(const void *)spec->entry;
}

/* As one set, or as many as the estimator has maps. */
static pm_status estimate(const pm__spec *spec, const terms *t, double result[3])
{
    enum { MOST = 64 };
    pm__neighbors sets[MOST];
    const size_t count = (size_t)TIMES * PATTERN, maps = (size_t)pm__spec_value(spec, "maps", 1.0);
    for (size_t m = 0; m < maps; m++)
        sets[m] = (pm__neighbors){.count = count / maps,
                                  .cut = true,
                                  .distance2 = t->all_distance2 + m * (count / maps),
                                  .flux = (const float(*)[3])(t->all_flux + m * (count / maps)),
                                  .radius2 = 1.0};
    const pm__lookup lookup = {.sets = sets, .set_count = maps, .dimensions = 2, .normal = {0.0f, 0.0f, 1.0f},
                               .unit = 1.0};
    return estimator_of(spec)->estimate(spec->values, &lookup, result);
}

static void compare(const pm__spec *due, const terms *t, const double result[3], pm__stress_row *row)
{
    pm_query query;
    pm__judged judged;
    pm_query_init(&query);
    query.k = 0;
    query.max_radius = 1.0f;
    const pm__judge_request request = {.photons = t->photons, .count = PATTERN, .query = &query, .spec = due,
                                       .dimensions = 2};
    pm__judge(&request, &judged);
    row->measured = 0.0;
    for (int c = 0; c < 3; c++)
        row->measured =
            fmax(row->measured, pm__ulps(result[c], TIMES * judged.value[c], TIMES * judged.magnitude[c], 53));
    judged.count *= TIMES;
    row->bound = pm__judge_bound(&request, &judged);
    (void)snprintf(row->detail, sizeof row->detail, "%zu photons, %d of them different", judged.count, PATTERN);
}

static pm_status measure(size_t subject, const pm__stress_config *config, pm__stress_row *row)
{
    pm__spec spec, due;
    terms t = {.photons = NULL};
    double result[3] = {NAN, NAN, NAN};
    pm_status status = pm__spec_parse(&pm__estimators, subjects_here[subject].name, &spec, NULL);
    if (status == PM_OK)
        status = pm__spec_parse(&pm__estimators, subjects_here[subject].due, &due, NULL);
    if (status == PM_OK)
        status = open_terms(config, (estimator_of(&spec)->needs & PM__SORTED) != 0, &t);
    if (status == PM_OK)
        status = estimate(&spec, &t, result);
    row->unit = "ulp";
    if (status == PM_OK)
        compare(&due, &t, result, row);
    pm__spec_format(&spec, row->subject, sizeof row->subject);
    close_terms(&t);
    return status;
}

const pm__stress_test pm__stress_test_sums = {
    .name = "sums", .summary = "sums of 1e8 small terms", .subjects = subjects, .measure = measure};
