/* Stored, N of them, independent paths. Path i stores k_i photons; tracing ends with the path e by which there are N
 * or more, S = N + o in all. e depends on what was stored, so 1/e would be bright (errata 37). Unbiased of the light
 * F that a path carries is F_1, that of the first path; and so is its expectation given all e paths but not their order
 * (Rao and Blackwell). All orders in which tracing ends with the last path are equally likely: those whose last path
 * stores more than o, since S less it must be below N. With J the paths that store more than o, the first path is any
 * but the last, which is any of J:
 *     E[F_1 | paths] = (sum_i F_i - (1/|J|) sum_J F_i) / (e - 1)    (F_1 itself if e = 1).
 * Where a path stores one photon at most, this is (N - 1)/(e - 1)/N for each. The o that are too many are dropped at
 * random among all, so that each left stands for S/N.
 *
 * Where tracing ends with path m at the latest, and there are not N by then, each stands for 1/m: the orders of those
 * paths are equally likely too, and none ends sooner, so that the two cases together are unbiased. */
#include "shares.h"

#include "../base/memory.h"
#include "../base/parallel.h"
#include "emission.h"

#include <float.h>
#include <stdatomic.h>
#include <stdlib.h>
#include <string.h>

/* The number whose blocks say which photons are dropped. */
#define DROPPING (PM__OTHER_NUMBERS + 2)

/* Photons that are settled at once. */
enum { PIECE = 8192 };

typedef struct head {
    pm_photon photon;
    float normal[3];
} head;

/* Photons move to the place of those dropped before them, in pieces: by where they go, so that a piece takes its last
 * ones from the next, which may have been overwritten by then. Hence the first `over` of each are kept beside. */
typedef struct settling {
    pm__harvest *h;
    size_t over;            /* photons too many */
    const size_t *dropped;  /* their numbers, ascending */
    head *heads;
    double share;
    double last;            /* of paths of more than `over` photons: a factor */
    _Atomic size_t longer;  /* such paths */
    _Atomic bool too_large; /* a photon that no float holds */
} settling;

static void read_piece(void *argument, size_t piece)
{
    settling *const s = argument;
    const pm__harvest *const h = s->h;
    const size_t begin = piece * PIECE, end = pm__piece_end(piece, PIECE, h->count);
    size_t longer = 0;
    for (size_t i = begin; i < end; i++)
        longer += (h->marks[i] & PM__FIRST_OF_PATH) && (h->marks[i] & PM__PATH_LENGTH) > s->over;
    s->longer += longer;
    for (size_t i = begin; i < end && i < begin + s->over; i++) {
        head *const to = &s->heads[piece * s->over + i - begin];
        to->photon = h->photons[i];
        if (h->normals)
            memcpy(to->normal, h->normals[i], sizeof to->normal);
    }
}

/* Photon `from` to `to`, no longer in units of h->unit. false: no float holds its power. */
static bool settle(const settling *s, size_t from, size_t to)
{
    const pm__harvest *const h = s->h;
    const bool in_head = from / PIECE > to / PIECE;
    const head *const kept = in_head ? &s->heads[from / PIECE * s->over + from % PIECE] : NULL;
    const bool longer = h->marks && (h->marks[from] & PM__PATH_LENGTH) > s->over;
    const double share = longer ? s->share * s->last : s->share;
    pm_photon photon = kept ? kept->photon : h->photons[from];
    for (int b = 0; b < 3; b++) {
        const double power = (double)photon.power[b] * h->unit * share;
        if (!(power <= (double)FLT_MAX))
            return false;
        photon.power[b] = (float)power;
    }
    h->photons[to] = photon;
    if (h->normals && from != to)
        memmove(h->normals[to], kept ? kept->normal : h->normals[from], sizeof kept->normal);
    return true;
}

static void settle_piece(void *argument, size_t piece)
{
    settling *const s = argument;
    const size_t end = pm__piece_end(piece, PIECE, s->h->count - s->over);
    for (size_t to = piece * PIECE, skipped = 0; to < end; to++) {
        while (skipped < s->over && s->dropped[skipped] <= to + skipped)
            skipped++;
        if (!settle(s, to + skipped, to))
            s->too_large = true;
    }
}

static pm_status settle_all(const pm__shoot_config *config, settling *s, pm_error *error)
{
    pm__for(config->parallel, pm__pieces(s->h->count - s->over, PIECE), settle_piece, s);
    if (s->too_large)
        return pm__fail(error, PM_EINVAL, "a photon has more W than a float holds");
    s->h->count -= s->over;
    return PM_OK;
}

pm_status pm__check_smallness(double power, double share, pm_error *error)
{
    if (power * share >= (double)FLT_MIN)
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "photons of %g W are less than a float holds", power * share);
}

pm_status pm__share_alike(const pm__shoot_config *config, pm__harvest *harvest, double share, pm_error *error)
{
    settling s = {.h = harvest, .share = share, .last = 1.0};
    return settle_all(config, &s, error);
}

/* `over` different numbers below count, ascending (Floyd's algorithm); over is below PM__LONGEST_PATH. */
static void choose_dropped(const pm__shoot_config *config, size_t count, size_t over, size_t dropped[])
{
    for (size_t j = count - over, made = 0; j < count; j++, made++) {
        double u[3];
        pm__trace_uniform(config->seed, config->trial, DROPPING, (uint32_t)made, u);
        const size_t tried = (size_t)(u[0] * (double)(j + 1));
        size_t at = 0;
        while (at < made && dropped[at] < tried)
            at++;
        const bool taken = at < made && dropped[at] == tried;
        if (taken)
            at = made;
        memmove(&dropped[at + 1], &dropped[at], (made - at) * sizeof *dropped);
        dropped[at] = taken ? j : tried;
    }
}

pm_status pm__share_wanted(const pm__shoot_config *config, pm__harvest *harvest, double power, pm_error *error)
{
    const size_t pieces = pm__pieces(harvest->count, PIECE), over = harvest->count - config->count;
    const double each = (double)harvest->count / (double)config->count;
    const double share = harvest->emitted > 1 ? each / (double)(harvest->emitted - 1) : each;
    size_t dropped[PM__LONGEST_PATH];
    settling s = {.h = harvest, .over = over, .dropped = dropped, .share = share,
                  .heads = pm__alloc(pieces * over, sizeof *s.heads)};
    pm_status status = s.heads ? pm__check_smallness(power, share, error)
                               : pm__fail(error, PM_ENOMEM, "out of memory for %zu photons", harvest->count);
    if (status == PM_OK) {
        choose_dropped(config, harvest->count, over, dropped);
        pm__for(config->parallel, pieces, read_piece, &s);
        s.last = harvest->emitted > 1 ? 1.0 - 1.0 / (double)s.longer : 1.0;
        status = settle_all(config, &s, error);
    }
    free(s.heads);
    return status;
}
