/* One row for each option, and how its value is read. */
#include "option_values.h"

#include "../../estimators/estimator.h"
#include "../search/search.h"

#include <stdlib.h>
#include <string.h>

enum { MAX_TRIALS = 10000000, MAX_PROBES = 10000000, MAX_THREADS = 4096 };

static pm_status set_case(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__all_cases, text, &s->cases, error);
}

static pm_status set_estimator(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__estimators, text, &s->estimators, error);
}

static pm_status set_one_estimator(pm__settings *s, const char *text, pm_error *error)
{
    s->estimators.count = 0;
    const pm_status status = pm__parse_specs(&pm__estimators, text, &s->estimators, error);
    if (status == PM_OK && s->estimators.count != 1)
        return pm__fail(error, PM_EINVAL, "one estimator at a time, not '%.80s'", text);
    return status;
}

static pm_status set_sampler(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__samplers, text, &s->samplers, error);
}

static pm_status set_search(pm__settings *s, const char *text, pm_error *error)
{
    pm__spec spec;
    const pm_status status = pm__spec_parse(&pm__searches, text, &spec, error);
    if (status == PM_OK)
        s->search = spec.entry->name;
    return status;
}

static pm_status set_k(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->ks, error);
}

static pm_status set_one_k(pm__settings *s, const char *text, pm_error *error)
{
    s->ks.count = 0;
    size_t value;
    const pm_status status = pm__parse_count(text, 1, PM_MAX_PHOTONS, &value, error);
    return status ? status : set_k(s, text, error);
}

static pm_status set_radius(pm__settings *s, const char *text, pm_error *error)
{
    double threshold = 0.05;
    if (strncmp(text, "auto", 4) == 0 && (!text[4] || text[4] == ':')) {
        const pm_status status = text[4] ? pm__parse_positive(text + 5, &threshold, error) : PM_OK;
        s->auto_threshold = threshold;
        s->radius = 0.0;
        return status;
    }
    s->auto_threshold = 0.0;
    return pm__parse_positive(text, &s->radius, error) == PM_OK
               ? PM_OK
               : pm__fail(error, PM_EINVAL, "'%.60s' is neither a radius above 0 (m) nor auto[:L]", text);
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->photons, error);
}

static pm_status set_photon_file(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->photon_file, error);
}

static pm_status set_query_file(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->query_file, error);
}

static pm_status set_trials(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 2, MAX_TRIALS, &s->trials, error);
}

static pm_status set_probes(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MAX_PROBES, &s->probes, error);
}

static pm_status set_lookup(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_lookup(text, &s->lookup, error);
}

/* One of two words. */
static pm_status parse_word(const char *text, const char *yes, const char *no, bool *value, pm_error *error)
{
    *value = strcmp(text, yes) == 0;
    if (!*value && strcmp(text, no) != 0)
        return pm__fail(error, PM_EINVAL, "'%.60s': expected %s or %s", text, yes, no);
    return PM_OK;
}

static pm_status set_front(pm__settings *s, const char *text, pm_error *error)
{
    return parse_word(text, "on", "off", &s->lookup.front_only, error);
}

static pm_status set_profile(pm__settings *s, const char *text, pm_error *error)
{
    return parse_word(text, "full", "quick", &s->full, error);
}

static pm_status set_seed(pm__settings *s, const char *text, pm_error *error)
{
    const size_t digits = strspn(text, "0123456789");
    const unsigned long long value = strtoull(text, NULL, 10);
    if (!digits || text[digits] || value > INT64_MAX) /* JSON holds 63 bits */
        return pm__fail(error, PM_EINVAL, "'%.60s' is not an integer from 0 to %lld", text, (long long)INT64_MAX);
    s->seed = value;
    return PM_OK;
}

static pm_status set_threads(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MAX_THREADS, &s->threads, error);
}

static pm_status set_json(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->json, error);
}

static pm_status set_csv(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->csv, error);
}

static pm_status set_markdown(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->markdown, error);
}

static pm_status set_output(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->output, error);
}

static pm_status set_quiet(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->quiet = true;
    return PM_OK;
}

static pm_status set_help(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->help = true;
    return PM_OK;
}

const pm__option pm__option_case = {"case", 0, "CASE,...", "cases, scene:NAME, or all (all but scenes)", set_case};
const pm__option pm__option_estimator = {"estimator", 0, "EST,...", "estimators, or all (all)", set_estimator};
const pm__option pm__option_one_estimator = {"estimator", 0, "EST", "the estimator (disc)", set_one_estimator};
const pm__option pm__option_sampler = {"sampler", 0, "SAMPLER,...", "how photons are drawn (poisson)", set_sampler};
const pm__option pm__option_k = {
    "k", 0, "K,...", "photons in an estimate (quick: 15,50,200; full: 5,10,15,25,50,100,200,500)", set_k};
const pm__option pm__option_one_k = {"k", 0, "K", "photons in an estimate (50)", set_one_k};
const pm__option pm__option_radius = {
    "radius", 0, "R|auto[:L]",
    "maximum radius of a lookup, m; without --k every photon within it. auto: beyond it k photons cannot reach the "
    "radiance L, 0.05 W/(m2 sr) (none)",
    set_radius};
const pm__option pm__option_photons = {"photons", 0, "N,...", "photons in a map (40000)", set_photons};
const pm__option pm__option_photon_file = {
    "photons", 0, "FILE", "PLY file: x y z, dx dy dz (direction of travel), r g b (power, W)", set_photon_file};
const pm__option pm__option_query_file = {"queries", 0, "FILE", "PLY file: x y z, nx ny nz (surface normal)",
                                          set_query_file};
const pm__option pm__option_trials = {"trials", 0, "T", "independent photon maps (quick: 32; full: 400)", set_trials};
const pm__option pm__option_probes = {
    "probes", 0, "Q", "points asked in region all; a region of its own has at most 512 (2048)", set_probes};
const pm__option pm__option_search = {"search", 0, "SEARCH", "the search algorithm (the fastest)", set_search};
const pm__option pm__option_lookup = {
    "lookup", 0, "SHAPE", "sphere; ellipsoid:S, squashed S times along the normal; disc:H, |height| <= H m (sphere)",
    set_lookup};
const pm__option pm__option_front = {"front", 0, "on|off", "leave out photons that arrive from behind (on)", set_front};
const pm__option pm__option_profile = {"profile", 0, "quick|full", "the defaults marked so (quick)", set_profile};
const pm__option pm__option_seed = {"seed", 0, "N", "the random numbers (1)", set_seed};
const pm__option pm__option_threads = {"threads", 0, "N", "threads (all that the process may use)", set_threads};
const pm__option pm__option_json = {"json", 0, "FILE|-", "write the rows as JSON; - is standard output", set_json};
const pm__option pm__option_csv = {"csv", 0, "FILE|-", "write the rows as comma-separated values", set_csv};
const pm__option pm__option_markdown = {"markdown", 0, "FILE|-", "write the rows as a Markdown table", set_markdown};
const pm__option pm__option_output = {"output", 'o', "FILE", "write there what would go to the screen", set_output};
const pm__option pm__option_quiet = {"quiet", 'q', NULL, "no messages and no progress bar, errors only", set_quiet};
const pm__option pm__option_help = {"help", 'h', NULL, "show this and stop", set_help};
