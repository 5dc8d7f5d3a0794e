#include "converge_options.h"

#include "../methods/progressive/progressive.h"
#include "option_values.h"
#include "render_options.h"

#include <string.h>

enum { MOST_TRIALS = 100000, MOST_PASSES = 1 << 30, PIECE = 64 };
#define MOST_PHOTONS ((size_t)1 << 50)

static pm_status set_method(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__progressives, text, &s->converge.methods, error);
}

static pm_status set_estimator(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_estimator.set(s, text, error);
}

static pm_status add_alpha(pm__converge_options *c, const char *text, pm_error *error)
{
    double alpha;
    if (pm__parse_double(text, &alpha) || !(alpha > 0.0 && alpha < 1.0))
        return pm__fail(error, PM_EINVAL, "'%.60s' is not a number above 0 and below 1", text);
    for (size_t i = 0; i < c->alpha_count; i++)
        if (c->alphas[i] == alpha)
            return PM_OK;
    if (c->alpha_count == PM__MAX_ALPHAS)
        return pm__fail(error, PM_EINVAL, "more than %d values", (int)PM__MAX_ALPHAS);
    c->alphas[c->alpha_count++] = alpha;
    return PM_OK;
}

static pm_status set_alpha(pm__settings *s, const char *text, pm_error *error)
{
    for (;; text++) {
        char piece[PIECE];
        const size_t length = strcspn(text, ",");
        (void)snprintf(piece, sizeof piece, "%.*s", (int)(length < PIECE ? length : PIECE - 1), text);
        const pm_status status = add_alpha(&s->converge, piece, error);
        text += length;
        if (status != PM_OK || !*text)
            return status;
    }
}

static pm_status set_trials(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 2, MOST_TRIALS, &s->trials, error);
}

static pm_status set_passes(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MOST_PASSES, &s->converge.passes, error);
}

static pm_status set_photons_per_pass(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, PM_MAX_PHOTONS, &s->converge.photons_per_pass, error);
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MOST_PHOTONS, &s->converge.photons, error);
}

static pm_status set_radius(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->radius, error);
}

static pm_status set_k(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_k.set(s, text, error);
}

static pm_status set_size(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_size.set(s, text, error);
}

static pm_status set_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->seconds, error);
}

static pm_status set_error(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_relative(text, &s->converge.error, error);
}

static pm_status set_sampler(pm__settings *s, const char *text, pm_error *error)
{
    return pm__render_option_sampler.set(s, text, error);
}

/* Whether the image holds the pixel is seen once its size is known. */
static pm_status set_at(pm__settings *s, const char *text, pm_error *error)
{
    pm__converge_options *const c = &s->converge;
    const size_t length = strcspn(text, ",");
    char x[PIECE];
    size_t at[2];
    (void)snprintf(x, sizeof x, "%.*s", (int)(length < PIECE ? length : PIECE - 1), text);
    if (!text[length] || pm__parse_count(x, 0, PM_MAX_PHOTONS, &at[0], NULL) ||
        pm__parse_count(text + length + 1, 0, PM_MAX_PHOTONS, &at[1], NULL))
        return pm__fail(error, PM_EINVAL, "'%.60s': expected a pixel X,Y, from 0,0 at the image's top left", text);
    for (size_t i = 0; i < c->at_count; i++)
        if (c->at[i][0] == at[0] && c->at[i][1] == at[1])
            return PM_OK;
    if (c->at_count == PM__MAX_WATCHED)
        return pm__fail(error, PM_EINVAL, "more than %d pixels", (int)PM__MAX_WATCHED);
    memcpy(c->at[c->at_count++], at, sizeof at);
    return PM_OK;
}

/* It is read again, and replaced: no stream. */
static pm_status set_file(const char *text, const char **path, pm_error *error)
{
    if (strcmp(text, "-") == 0)
        return pm__fail(error, PM_EINVAL, "'-': expected a file");
    return pm__parse_path(text, path, error);
}

static pm_status set_checkpoint(pm__settings *s, const char *text, pm_error *error)
{
    return set_file(text, &s->converge.checkpoint, error);
}

static pm_status set_checkpoint_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->converge.checkpoint_seconds, error);
}

static pm_status set_resume(pm__settings *s, const char *text, pm_error *error)
{
    return set_file(text, &s->converge.resume, error);
}

static pm_status set_search(pm__settings *s, const char *text, pm_error *error)
{
    return pm__option_search.set(s, text, error);
}

const pm__option pm__converge_option_method = {
    "method", 0, "METHOD,...", "how answers get better, or all (ppm)", set_method};
const pm__option pm__converge_option_estimator = {
    "estimator", 0, "EST,...", "the kernel of lookups, a series each (disc)", set_estimator};
const pm__option pm__converge_option_alpha = {
    "alpha", 0, "A,...", "how slowly radii shrink, between 0 and 1, a series each (0.667)", set_alpha};
const pm__option pm__converge_option_trials = {
    "trials", 0, "T", "independent runs of each series (quick: 8; full: 32)", set_trials};
const pm__option pm__converge_option_passes = {
    "passes", 0, "N", "passes of a run (quick: 256; full: 1024)", set_passes};
const pm__option pm__converge_option_photons_per_pass = {
    "photons-per-pass", 0, "N", "photons emitted in a pass (20000)", set_photons_per_pass};
const pm__option pm__converge_option_photons = {
    "photons", 0, "N", "no further pass once a run has emitted so many photons; path emits none (none)", set_photons};
const pm__option pm__converge_option_radius = {
    "radius", 0, "R", "of the first lookup, m (at each point that of its --k nearest photons)", set_radius};
const pm__option pm__converge_option_k = {
    "k", 0, "K", "photons in the first lookup, and in every one of methods that do not shrink (50)", set_k};
const pm__option pm__converge_option_size = {
    "size", 0, "WxH", "points, one in each pixel of the scene's image (32x32, or as a reference has)", set_size};
const pm__option pm__converge_option_seconds = {
    "seconds", 0, "S", "time for all runs of a series: fewer passes where they do not fit (none)", set_seconds};
const pm__option pm__converge_option_error = {
    "error", 0, "E", "no further pass once the first run estimates so small an error, as 2% or 0.02 (none)", set_error};
const pm__option pm__converge_option_at = {
    "at", 0, "X,Y", "a pixel whose photons, radius and estimate are wanted too; may be repeated", set_at};
const pm__option pm__converge_option_sampler = {
    "sampler", 0, "SAMPLER", "how photons leave the lights (poisson)", set_sampler};
const pm__option pm__converge_option_checkpoint = {
    "checkpoint", 0, "FILE", "where the state is saved now and then, at the end, and when interrupted", set_checkpoint};
const pm__option pm__converge_option_checkpoint_seconds = {
    "checkpoint-seconds", 0, "S", "time between two checkpoints (60)", set_checkpoint_seconds};
const pm__option pm__converge_option_resume = {
    "resume", 0, "FILE", "go on from this checkpoint of the same options, and keep it up to date", set_resume};
const pm__option pm__converge_option_search = {
    "search", 0, "SEARCH", "look all photons up by it (what is fastest, by method)", set_search};
