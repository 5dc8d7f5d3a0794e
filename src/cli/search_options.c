#include "search_options.h"

#include "../../bench/contender.h"
#include "../../bench/workloads.h"
#include "option_values.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_SAMPLES = 100000, MOST_HITS = 1000000, PIECE = 64 };

/* Runs take on each piece of a comma list. */
static pm_status each_piece(pm__settings *s, const char *text,
                            pm_status (*take)(pm__settings *s, const char *piece, pm_error *error), pm_error *error)
{
    for (;; text++) {
        char piece[PIECE];
        const size_t length = strcspn(text, ",");
        (void)snprintf(piece, sizeof piece, "%.*s", (int)(length < PIECE - 1 ? length : PIECE - 1), text);
        const pm_status status = take(s, piece, error);
        text += length;
        if (status != PM_OK || !*text)
            return status;
    }
}

static pm_status set_case(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_specs(&pm__workloads, text, &s->cases, error);
}

static pm_status set_input(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_path(text, &s->photon_file, error);
}

static pm_status set_photons(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->photons, error);
}

static pm_status set_k(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_counts(text, 1, PM_MAX_PHOTONS, &s->ks, error);
}

static pm_status set_radius(pm__settings *s, const char *text, pm_error *error)
{
    s->radius = 0.0;
    s->radius_hits = 0;
    if (strncmp(text, "auto", 4) == 0 && (!text[4] || text[4] == ':')) {
        s->radius_hits = 50;
        return text[4] ? pm__parse_count(text + 5, 1, MOST_HITS, &s->radius_hits, error) : PM_OK;
    }
    return pm__parse_positive(text, &s->radius, NULL) == PM_OK
               ? PM_OK
               : pm__fail(error, PM_EINVAL, "'%.60s' is neither a radius above 0 (m) nor auto[:K]", text);
}

static pm_status take_order(pm__settings *s, const char *piece, pm_error *error)
{
    const bool all = strcmp(piece, "all") == 0;
    if (!all && strcmp(piece, "random") != 0 && strcmp(piece, "coherent") != 0)
        return pm__fail(error, PM_EINVAL, "'%s': expected random or coherent", piece);
    s->order_random |= all || *piece == 'r';
    s->order_coherent |= all || *piece == 'c';
    return PM_OK;
}

static pm_status set_order(pm__settings *s, const char *text, pm_error *error)
{
    return each_piece(s, text, take_order, error);
}

static pm_status refuse_search(const char *name, pm_error *error)
{
    const char *names[64], *nearest;
    char known[240] = "";
    size_t count = 0;
    for (; count < pm__contender_count() && count < 64; count++) {
        const pm__contender contender = pm__contender_at(count);
        names[count] = pm__contender_name(&contender);
        (void)snprintf(known + strlen(known), sizeof known - strlen(known), "%s%s", count ? ", " : "", names[count]);
    }
    nearest = pm__nearest_name(name, names, count);
    if (nearest)
        return pm__fail(error, PM_ENAME, "no search '%s'; did you mean '%s'?", name, nearest);
    return pm__fail(error, PM_ENAME, "no search '%s' built in; there are: %s", name, known);
}

static pm_status take_search(pm__settings *s, const char *piece, pm_error *error)
{
    const bool all = strcmp(piece, "all") == 0;
    bool known = false;
    for (size_t i = 0; i < pm__contender_count(); i++) {
        const pm__contender contender = pm__contender_at(i);
        char number[24];
        if (!all && strcmp(piece, pm__contender_name(&contender)) != 0)
            continue;
        known = true;
        (void)snprintf(number, sizeof number, "%zu", i);
        const pm_status status = pm__parse_counts(number, 0, SIZE_MAX / 2, &s->searches, error);
        if (status != PM_OK)
            return status;
    }
    return known ? PM_OK : refuse_search(piece, error);
}

static pm_status set_search(pm__settings *s, const char *text, pm_error *error)
{
    return each_piece(s, text, take_search, error);
}

static pm_status set_samples(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_count(text, 1, MOST_SAMPLES, &s->samples, error);
}

static pm_status set_seconds(pm__settings *s, const char *text, pm_error *error)
{
    return pm__parse_positive(text, &s->seconds, error);
}

static pm_status take_lookup(pm__settings *s, const char *piece, pm_error *error)
{
    pm__shape shape = {PM_LOOKUP_SPHERE, 0.0, false};
    const pm_status status = pm__parse_lookup(piece, &shape, error);
    if (status != PM_OK)
        return status;
    for (size_t i = 0; i < s->shape_count; i++)
        if (s->shapes[i].shape == shape.shape && !(s->shapes[i].parameter != shape.parameter))
            return PM_OK;
    if (s->shape_count == PM__MAX_SHAPES)
        return pm__fail(error, PM_EINVAL, "at most %d shapes", (int)PM__MAX_SHAPES);
    s->shapes[s->shape_count++] = shape;
    return PM_OK;
}

static pm_status set_lookup(pm__settings *s, const char *text, pm_error *error)
{
    return each_piece(s, text, take_lookup, error);
}

static pm_status take_front(pm__settings *s, const char *piece, pm_error *error)
{
    const bool all = strcmp(piece, "all") == 0;
    if (!all && strcmp(piece, "on") != 0 && strcmp(piece, "off") != 0)
        return pm__fail(error, PM_EINVAL, "'%s': expected on or off", piece);
    s->front_on |= all || strcmp(piece, "on") == 0;
    s->front_off |= all || strcmp(piece, "off") == 0;
    return PM_OK;
}

static pm_status set_front(pm__settings *s, const char *text, pm_error *error)
{
    return each_piece(s, text, take_front, error);
}

static pm_status set_threads(pm__settings *s, const char *text, pm_error *error)
{
    return pm__option_threads.set(s, text, error);
}

const pm__option pm__search_option_case = {
    "case", 0, "CASE,...", "point sets: square, box, caustic, volume, duplicates, or all (box)", set_case};
const pm__option pm__search_option_input = {"input", 0, "FILE", "a PLY file's photons instead of a case", set_input};
const pm__option pm__search_option_photons = {"photons", 0, "N,...", "photons in a map (1000000)", set_photons};
const pm__option pm__search_option_k = {
    "k", 0, "K,...", "nearest photons wanted (50, or none where --radius is given)", set_k};
const pm__option pm__search_option_radius = {
    "radius", 0, "R|auto[:K]",
    "all photons within R, m; auto: within what holds K photons (50) at the median query (none)", set_radius};
const pm__option pm__search_option_order = {
    "order", 0, "ORDER,...", "order of the queries: random, coherent (along Morton's curve) (coherent)", set_order};
const pm__option pm__search_option_search = {
    "search", 0, "SEARCH,...",
    "searches and the peer libraries built in, or all (all, but brute only up to 100000 photons)", set_search};
const pm__option pm__search_option_samples = {
    "samples", 0, "S", "samples of each, rather than as many as --seconds allows", set_samples};
const pm__option pm__search_option_seconds = {"seconds", 0, "S", "time for it all, more or less (50)", set_seconds};
const pm__option pm__search_option_threads = {
    "threads", 0, "N", "threads of builds; a query runs on one (all that the process may use)", set_threads};
const pm__option pm__search_option_lookup = {
    "lookup", 0, "SHAPE,...",
    "sphere; ellipsoid:S, squashed S times along the normal; disc:H, |height| <= H m (sphere)", set_lookup};
const pm__option pm__search_option_front = {
    "front", 0, "on|off,...", "leave out photons that arrive from behind; on,off measures both (off)", set_front};
