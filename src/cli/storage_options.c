#include "storage_options.h"

#include "../storage/storage.h"
#include "option_values.h"
#include "render_options.h"

#include <string.h>

enum { MOST_TRIALS = 100000, MOST_PATHS = 1 << 28, MOST_SAMPLES = 1 << 16, PIECE = 32 };

static pm_status set_policy(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__policies, text, &s->storage.policies, error);
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->photons, error);
}

static pm_status set_stored(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->storage.stored, error);
}

static pm_status add_map(pm__storage_options *o, const char *name, size_t length, pm_error *error)
{
    const bool all = length == 3 && strncmp(name, "all", 3) == 0;
    bool any = all;
    for (int kind = 0; kind < PM__MAP_KINDS; kind++)
        if (all || (strlen(pm__map_names[kind]) == length && strncmp(pm__map_names[kind], name, length) == 0))
            any = o->maps[kind] = true;
    return any ? PM_OK
               : pm__fail(error, PM_EINVAL, "'%.*s': expected caustic or global", (int)(length < 60 ? length : 60),
                          name);
}

static pm_status set_map(pm__settings *s, const char *text, pm_error *error)
{
    for (;; text++) {
        const size_t length = strcspn(text, ",");
        const pm_status status = add_map(&s->storage, text, length, error);
        text += length;
        if (status != PM_OK || !*text)
            return status;
    }
}

static pm_status set_k(pm__settings *s, const char *text, pm_error *error)
{
    size_t k;
    const pm_status status = pm__parse_count(text, 2, PM_MAX_PHOTONS, &k, error);
    return status ? status : pm__render_option_k.set(s, text, error);
}

static pm_status set_trials(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 2, MOST_TRIALS, &s->trials, error);
}

static pm_status set_paths(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MOST_PATHS, &s->storage.paths, error);
}

static pm_status set_importance(pm__settings *s, const char *text, pm_error *error)
{
    static const char *const names[] = {[PM__OF_SCREEN] = "screen", [PM__OF_PIXELS] = "pixels", [PM__OF_BOTH] = "both"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(text, names[i]) == 0) {
            s->storage.importance = names[i];
            s->storage.measure = (int)i;
            return PM_OK;
        }
    return pm__fail(error, PM_EINVAL, "'%.60s': expected screen, pixels or both", text);
}

static pm_status set_share(pm__settings *s, const char *text, pm_error *error)
{
    double share;
    if (pm__parse_double(text, &share) || !(share > 0.0 && share <= 1.0))
        return pm__fail(error, PM_EINVAL, "'%.60s' is not a number above 0, at most 1", text);
    s->storage.share = share;
    return PM_OK;
}

static pm_status set_size(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_size.set(s, text, error);
}

/* Groups have as many each. */
static pm_status set_spp(pm__settings *s, const char *text, pm_error *error)
{
    size_t spp;
    const pm_status status = pm__parse_count(text, PM__GROUPS, MOST_SAMPLES, &spp, error);
    if (status == PM_OK && spp % PM__GROUPS)
        return pm__fail(error, PM_EINVAL, "'%.60s' is not a multiple of %d", text, (int)PM__GROUPS);
    if (status == PM_OK)
        s->render.spp = spp;
    return status;
}

static pm_status set_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->seconds, error);
}

static pm_status set_output(pm__settings *s, const char *text, pm_error *error)
{
    if (strcmp(text, "-") == 0)
        return pm__fail(error, PM_EINVAL, "'-': expected what the names of image files start with");
    return pm__parse_path(text, &s->output, error);
}

const pm__option pm__storage_option_policy = {
    "policy", 0, "POLICY,...", "which photons are kept, and where they are sent (every policy)", set_policy};
const pm__option pm__storage_option_photons = {
    "photons", 0, "N,...", "photons sent, a row each (50000,200000,800000; full: 3200000 too)", set_photons};
const pm__option pm__storage_option_stored = {
    "stored", 0, "N,...", "send until so many are stored, a row each, instead of or beside --photons", set_stored};
const pm__option pm__storage_option_map = {
    "map", 0, "MAP,...", "caustic, global (those that the scene has)", set_map};
const pm__option pm__storage_option_k = {"k", 0, "K", "photons in a lookup (50)", set_k};
const pm__option pm__storage_option_trials = {
    "trials", 0, "T", "independent maps of each row (quick: 8; full: 32)", set_trials};
const pm__option pm__storage_option_paths = {
    "paths", 0, "N", "eye paths by which importance is found (100000)", set_paths};
const pm__option pm__storage_option_importance = {
    "importance", 0, "KIND", "screen, pixels or both: to whom it is important (both)", set_importance};
const pm__option pm__storage_option_share = {
    "share", 0, "S", "of importons that carry an estimate of importance (0.25)", set_share};
const pm__option pm__storage_option_size = {
    "size", 0, "WxH", "pixels of the image: those of the scene's reference, or a whole multiple", set_size};
const pm__option pm__storage_option_spp = {
    "spp", 0, "N", "eye paths a pixel that look at each map, a multiple of 4 (65536 in all; full: 262144)", set_spp};
const pm__option pm__storage_option_seconds = {
    "seconds", 0, "S", "no further trial of a scene once S seconds are over, but two (none)", set_seconds};
const pm__option pm__storage_option_output = {
    "output", 'o', "FILE", "images of densities: what their names start with (none)", set_output};
