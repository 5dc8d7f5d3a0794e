#include "render_options.h"

#include "../../cases/scenes/list.h"
#include "../../estimators/estimator.h"
#include "../methods/render.h"
#include "option_values.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_SIDE = 16384, MOST_SAMPLES = 1 << 24, MOST_TRIALS = 100000, LONGEST_NAME = 80 };
static const char prefix[] = "scene:";
enum { PREFIX = sizeof prefix - 1 };

static pm_status set_method(pm__settings *s, const char *text, pm_error *error)
{
    return pm__spec_parse(&pm__methods, text, &s->render.method, error);
}

/* All: but those that only a bench can supply with the truth. */
static pm_status set_estimator(pm__settings *s, const char *text, pm_error *error)
{
    const pm_status status = pm__parse_specs(&pm__estimators, text, &s->estimators, error);
    size_t kept = 0;
    if (status != PM_OK || strcmp(text, "all") != 0)
        return status;
    for (size_t i = 0; i < s->estimators.count; i++)
        if (!(((const pm__estimator *)(const void *)s->estimators.items[i].entry)->needs & PM__TRUTH))
            s->estimators.items[kept++] = s->estimators.items[i];
    s->estimators.count = kept;
    return PM_OK;
}

/* A list of one: the last that is given counts. */
static pm_status set_one_count(pm__counts *list, const char *text, pm_error *error)
{
    size_t value;
    const pm_status status = pm__parse_count(text, 1, PM_MAX_PHOTONS, &value, error);
    list->count = 0;
    return status ? status : pm__parse_counts(text, 1, PM_MAX_PHOTONS, list, error);
}

static pm_status set_k(pm__settings *s, const char *text, pm_error *error)
{
    return set_one_count(&s->ks, text, error);
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    return set_one_count(&s->photons, text, error);
}

static pm_status set_radius(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->radius, error);
}

static pm_status set_size(pm__settings *s, const char *text, pm_error *error)
{
    char width[16];
    const size_t length = strcspn(text, "xX");
    (void)snprintf(width, sizeof width, "%.*s", (int)(length < sizeof width ? length : sizeof width - 1), text);
    if (!text[length] || pm__parse_count(width, 1, MOST_SIDE, &s->render.width, NULL) ||
        pm__parse_count(text + length + 1, 1, MOST_SIDE, &s->render.height, NULL))
        return pm__fail(error, PM_EINVAL, "'%.60s': expected WIDTHxHEIGHT, each from 1 to %d pixels", text,
                        (int)MOST_SIDE);
    return PM_OK;
}

static pm_status set_spp(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MOST_SAMPLES, &s->render.spp, error);
}

static pm_status set_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->seconds, error);
}

static pm_status set_trials(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MOST_TRIALS, &s->trials, error);
}

static pm_status set_sampler(pm__settings *s, const char *text, pm_error *error)
{
    s->samplers.count = 0;
    const pm_status status = pm__parse_specs(&pm__samplers, text, &s->samplers, error);
    if (status == PM_OK && s->samplers.count != 1)
        return pm__fail(error, PM_EINVAL, "one sampler at a time, not '%.80s'", text);
    return status;
}

static pm_status set_aov(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->render.aov = true;
    return PM_OK;
}

static pm_status set_plan(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->render.plan = true;
    return PM_OK;
}

static pm_status set_half(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->render.half = true;
    return PM_OK;
}

static pm_status set_no_skip(pm__settings *s, const char *text, pm_error *error)
{
    (void)text;
    (void)error;
    s->render.no_skip = true;
    return PM_OK;
}

static pm_status parse_triple(const char *text, double triple[3], pm_error *error)
{
    const char *at = text;
    for (int i = 0; i < 3; i++) {
        char number[64];
        const size_t length = strcspn(at, ",");
        const bool ends = !at[length];
        (void)snprintf(number, sizeof number, "%.*s", (int)(length < sizeof number ? length : 0), at);
        if (pm__parse_double(number, &triple[i]) || ends != (i == 2))
            return pm__fail(error, PM_EINVAL, "'%.60s': expected three numbers X,Y,Z", text);
        at += length + !ends;
    }
    return PM_OK;
}

static pm_status set_eye(pm__settings *s, const char *text, pm_error *error)
{
    s->render.eye = true;
    return parse_triple(text, s->render.view.eye, error);
}

static pm_status set_look(pm__settings *s, const char *text, pm_error *error)
{
    s->render.at = true;
    return parse_triple(text, s->render.view.at, error);
}

static pm_status set_up(pm__settings *s, const char *text, pm_error *error)
{
    s->render.up = true;
    return parse_triple(text, s->render.view.up, error);
}

static pm_status set_angle(pm__settings *s, const char *text, pm_error *error)
{
    static const double pi = 3.14159265358979323846;
    double degrees;
    if (pm__parse_double(text, &degrees) || !(degrees > 0.0 && degrees < 180.0))
        return pm__fail(error, PM_EINVAL, "'%.60s' is not a number of degrees above 0 and below 180", text);
    s->render.angle = true;
    s->render.view.angle = degrees / 180.0 * pi;
    return PM_OK;
}

static pm_status set_output(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->output, error);
}

/* The scene that a list's piece names must be there; told in the words that were typed. */
static pm_status check_name(const char *piece, pm_error *error)
{
    const char *names[64];
    char name[LONGEST_NAME];
    size_t count = 0;
    (void)snprintf(name, sizeof name, "%.*s", (int)strcspn(piece, ":,"), piece);
    for (; count < pm__scene_cases.count && count < sizeof names / sizeof *names; count++) {
        names[count] = pm__scene_cases.entries[count]->name + PREFIX;
        if (strcmp(names[count], name) == 0)
            return PM_OK;
    }
    const char *const nearest = pm__nearest_name(name, names, count);
    if (!*name)
        return pm__fail(error, PM_EINVAL, "an empty name among the scenes");
    if (nearest)
        return pm__fail(error, PM_ENAME, "unknown scene '%s'; did you mean '%s'?", name, nearest);
    return pm__fail(error, PM_ENAME, "unknown scene '%s'; 'photonbench list scenes' shows them", name);
}

/* Writes the operand with `scene:` before every name that lacks it. */
static pm_status write_full(FILE *file, const char *text, pm_error *error)
{
    for (bool first = true;; text++, first = false) {
        const size_t length = strcspn(text, ",");
        const bool names = first || text[strcspn(text, ",:=")] != '='; /* else a parameter of the one before */
        const bool all = length == 3 && strncmp(text, "all", 3) == 0, full = strncmp(text, prefix, PREFIX) == 0;
        const pm_status status = names && !all ? check_name(text + (full ? PREFIX : 0), error) : PM_OK;
        if (status != PM_OK)
            return status;
        (void)fprintf(file, "%s%s%.*s", first ? "" : ",", names && !all && !full ? prefix : "", (int)length, text);
        text += length;
        if (!*text)
            return PM_OK;
    }
}

static pm_status take_operand(pm__settings *s, const char *text, pm_error *error)
{
    char *list = NULL;
    size_t size = 0;
    FILE *const file = open_memstream(&list, &size);
    if (!file)
        return pm__fail(error, PM_ENOMEM, "out of memory");
    pm_status status = write_full(file, text, error);
    if (fclose(file) != 0 && status == PM_OK)
        status = pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK)
        status = pm__parse_specs(&pm__scene_cases, list, &s->cases, error);
    free(list);
    return status;
}

pm_status pm__render_take_scenes(pm__settings *settings, pm_error *error)
{
    pm_status status = PM_OK;
    if (!settings->operand_count)
        return pm__fail(error, PM_EINVAL, "a scene is needed: 'photonbench list scenes' shows them");
    for (size_t i = 0; status == PM_OK && i < settings->operand_count; i++)
        status = take_operand(settings, settings->operands[i], error);
    return status;
}

const pm__option pm__render_option_method = {"method", 0, "METHOD", "how images are made (visualize)", set_method};
const pm__option pm__render_option_estimator = {
    "estimator", 0, "EST,...", "estimators, an image each, or all (disc)", set_estimator};
const pm__option pm__render_option_k = {
    "k", 0, "K", "photons in an estimate (100, or all within --radius where that is given)", set_k};
const pm__option pm__render_option_radius = {
    "radius", 0, "R", "maximum radius of a lookup, m; without --k every photon within it (none)", set_radius};
const pm__option pm__render_option_photons = {"photons", 0, "N", "photons stored in a map (200000)", set_photons};
const pm__option pm__render_option_size = {"size", 0, "WxH", "width and height in pixels (256x256)", set_size};
const pm__option pm__render_option_spp = {
    "spp", 0, "N", "samples of a pixel (16; with --seconds as many as fit)", set_spp};
const pm__option pm__render_option_seconds = {
    "seconds", 0, "S", "stop after the pass in which S seconds are over (none)", set_seconds};
const pm__option pm__render_option_trials = {
    "trials", 0, "T", "independent photon maps, for bias and noise (1; with --aov 8)", set_trials};
const pm__option pm__render_option_sampler = {
    "sampler", 0, "SAMPLER", "how photons leave the lights (poisson)", set_sampler};
const pm__option pm__render_option_aov = {
    "aov", 0, NULL, "images of truth, error, bias, noise, radius and count too", set_aov};
const pm__option pm__render_option_plan = {"plan", 0, NULL, "say what would be done and why, and stop", set_plan};
const pm__option pm__render_option_half = {
    "half", 0, NULL, "images of 16-bit numbers: half the size, three digits", set_half};

const pm__option pm__render_option_no_skip = {
    "no-skip", 0, NULL, "do also what the scene does not need", set_no_skip};
const pm__option pm__render_option_eye = {"eye", 0, "X,Y,Z", "where the camera stands, m (the scene's)", set_eye};
const pm__option pm__render_option_look = {"look", 0, "X,Y,Z", "the point it looks at, m (the scene's)", set_look};
const pm__option pm__render_option_up = {"up", 0, "X,Y,Z", "what is up in the image (the scene's)", set_up};
const pm__option pm__render_option_angle = {
    "angle", 0, "DEGREES", "what it sees from the image's bottom to its top (the scene's)", set_angle};
const pm__option pm__render_option_output = {
    "output", 'o', "FILE", "the image; of several, and with --aov, what their names start with (SCENE.exr)",
    set_output};
