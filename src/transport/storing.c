/* Photons are traced in chunks; each chunk's arrivals are handed to the policy in the order of their paths. How many
 * were emitted is known at the end, so powers are till then as if it were one, and everything that a policy does with
 * them is linear in power. */
#include "storing.h"

#include "../base/clock.h"
#include "../base/memory.h"
#include "../base/parallel.h"
#include "harvest.h"
#include "policies/policy.h"
#include "shares.h"

#include <float.h>
#include <stdlib.h>
#include <string.h>

/* Paths that are sent at a time: so few that their photons are still in the cache when what becomes of them is decided;
 * eight times as many cost a fifth more. */
enum { CHUNK = 8192 };

/* Photons that are looked at together. */
enum { PIECE = 2048 };

typedef struct run {
    pm__storage storage;
    pm__stored_photons *set;
    pm__projection *projection;
    pm__paths *paths;
    float *importance;  /* of the chunk's photons; NULL: nobody knows it */
    unsigned char *part;
    size_t room;        /* photons that these hold */
    bool full;          /* so many are stored as are wanted */
} run;

static pm_status out_of_memory(const run *r)
{
    return pm__fail(r->storage.error, PM_ENOMEM, "out of memory behind %zu stored photons", r->storage.stock.count);
}

/* ---- Where photons come to ---------------------------------------------------------------------- */

/* Room for what is known of so many photons. */
static pm_status reserve(run *r, size_t count)
{
    size_t rooms[2] = {r->room, r->room};
    if (pm__grow((void **)&r->part, &rooms[0], count, sizeof *r->part) ||
        (r->storage.config->importance &&
         pm__grow((void **)&r->importance, &rooms[1], count, sizeof *r->importance)))
        return PM_ENOMEM;
    r->room = rooms[0];
    return PM_OK;
}

typedef struct looking {
    const run *run;
    const pm__arrivals *arrivals;
} looking;

static void look_piece(void *argument, size_t piece)
{
    const looking *const l = argument;
    const run *const r = l->run;
    const pm__storing_config *const config = r->storage.config;
    const size_t begin = piece * PIECE, end = pm__piece_end(piece, PIECE, l->arrivals->count);
    const double threshold = r->storage.threshold;
    if (!config->importance) {
        memset(r->part + begin, 0, end - begin);
        return;
    }
    pm__importance_of_photons(config->importance, config->kind, NULL, l->arrivals->photons + begin,
                              l->arrivals->normals + begin, end - begin, r->importance + begin);
    for (size_t i = begin; i < end; i++)
        r->part[i] = (double)r->importance[i] >= threshold;
}

static pm_status look_up(run *r, pm__arrivals *arrivals)
{
    looking all = {r, arrivals};
    if (arrivals->count > r->room && reserve(r, arrivals->count))
        return PM_ENOMEM;
    pm__for(r->storage.config->parallel, pm__pieces(arrivals->count, PIECE), look_piece, &all);
    arrivals->importance = r->importance;
    arrivals->part = r->part;
    return PM_OK;
}

/* ---- Chunks ------------------------------------------------------------------------------------- */

/* Storing ended before arrival `taken`: by which path, and how many does what is stored stand for? */
static void end_at(run *r, const pm__arrivals *arrivals, size_t taken)
{
    const bool one_is_enough = r->storage.stock.count >= r->storage.config->stored;
    r->full = true;
    pm__account_end(&r->storage.account, one_is_enough ? 0 : arrivals->first + arrivals->numbers[taken],
                    one_is_enough);
}

static pm_status keep_chunk(run *r, const pm__harvest *h, uint64_t first)
{
    const pm__policy *const policy = r->storage.policy;
    pm__arrivals arrivals = {.photons = h->photons,
                             .normals = (const float(*)[3])h->normals,
                             .numbers = h->numbers,
                             .count = h->count,
                             .first = first};
    const double start = pm__seconds();
    size_t taken = 0;
    pm_status status = look_up(r, &arrivals);
    const double known = pm__seconds();
    if (status == PM_OK)
        status = policy->keep->keep(&r->storage, &arrivals, &taken);
    r->set->policy_s += pm__seconds() - (pm__policy_needs_importance(r->storage.config->policy) ? start : known);
    if (status != PM_OK)
        return status == PM_ENOMEM ? out_of_memory(r) : status;
    pm__add_powers(arrivals.photons, arrivals.part, taken, r->storage.account.came);
    r->storage.account.arrived += taken;
    if (taken < arrivals.count || r->storage.stock.count >= r->storage.config->stored)
        end_at(r, &arrivals, taken);
    return PM_OK;
}

static void trace_range(const void *tracing, uint64_t first, uint64_t count, pm__store store, void *context)
{
    (void)pm__trace(tracing, first, count, store, context);
}

/* Paths first .. first + count - 1. */
static pm_status run_chunk(run *r, uint64_t first, uint64_t count)
{
    const pm__storage *const s = &r->storage;
    const pm__trace_config tracing = {s->config->scene, s->paths, s->config->seed, s->trial, &s->emission};
    const pm__shoot_config shooting = {.scene = s->config->scene, .normals = true, .parallel = s->config->parallel,
                                       .canceled = s->config->canceled, .context = s->config->context};
    const pm__harvest_wish wish = {.tracer = trace_range, .tracing = &tracing, .power = s->emission.total,
                                   .first = first, .most = count, .wanted = SIZE_MAX, .numbers = true};
    pm__harvest h;
    const double start = pm__seconds();
    pm_status status = pm__harvest_paths(&shooting, &wish, &h, s->error);
    r->set->trace_s += pm__seconds() - start;
    if (status != PM_OK)
        return status;
    r->storage.unit = h.unit;
    r->storage.account.sent = r->storage.account.emitted = first + count;
    if (h.count > 0)
        status = keep_chunk(r, &h, first);
    pm__harvest_free(&h);
    return status;
}

static pm_status run_chunks(run *r)
{
    uint64_t first = 0;
    pm_status status = PM_OK;
    while (status == PM_OK && !r->full && first < r->storage.planned) {
        const uint64_t left = r->storage.planned - first, count = left < CHUNK ? left : CHUNK;
        status = run_chunk(r, first, count);
        first += count;
    }
    return status;
}

/* ---- The end ------------------------------------------------------------------------------------ */

typedef struct settling {
    pm__stock *stock;
    double factor;          /* of the powers: W */
    size_t settled;         /* the first photons have another */
    double settled_factor;
    _Atomic bool too_large;
} settling;

static void settle_piece(void *argument, size_t piece)
{
    settling *const s = argument;
    const size_t end = pm__piece_end(piece, PIECE, s->stock->count);
    for (size_t i = piece * PIECE; i < end; i++) {
        float *const power = s->stock->photons[i].power;
        const double factor = i < s->settled ? s->settled_factor : s->factor;
        for (int b = 0; b < 3; b++) {
            const double exact = (double)power[b] * factor;
            if (!(exact <= (double)FLT_MAX))
                s->too_large = true;
            else
                power[b] = (float)exact;
        }
    }
}

/* Powers in W. */
static pm_status settle(run *r)
{
    pm__storage *const s = &r->storage;
    const double share = s->account.sent > 0 ? 1.0 / (double)s->account.sent : 0.0;
    settling work = {.stock = &s->stock, .factor = s->unit * share, .settled = s->settled,
                     .settled_factor = s->unit};
    if (s->stock.count == 0)
        return PM_OK;
    pm__for(s->config->parallel, pm__pieces(s->stock.count, PIECE), settle_piece, &work);
    if (work.too_large)
        return pm__fail(s->error, PM_EINVAL, "a photon has more W than a float holds");
    return share > 0.0 ? pm__check_smallness(s->emission.total, share, s->error) : PM_OK;
}

static void hand_over(run *r)
{
    pm__stored_photons *const set = r->set;
    pm__stock *const stock = &r->storage.stock;
    const pm__account *const account = &r->storage.account;
    for (int part = 0; part < PM__PARTS; part++)
        set->came[part] = r->storage.unit * (r->storage.settled_came[part] +
                                             (account->sent > 0 ? account->came[part] / (double)account->sent : 0.0));
    set->arrived = account->arrived + r->storage.settled_arrived;
    set->emitted = r->storage.tried + account->emitted;
    pm__add_powers(stock->photons, stock->part, stock->count, set->flux);
    set->photons = stock->photons;
    set->normals = stock->normals;
    set->count = stock->count;
    free(stock->part);
    *stock = (pm__stock){0};
}

static pm_status finish(run *r)
{
    const pm__keeping *const keep = r->storage.policy->keep;
    const double start = pm__seconds();
    pm_status status = keep->end ? keep->end(&r->storage, &r->set->unmet) : PM_OK;
    if (status == PM_ENOMEM)
        status = out_of_memory(r);
    if (status == PM_OK)
        status = settle(r);
    r->set->policy_s += pm__seconds() - start;
    if (status == PM_OK)
        hand_over(r);
    return status;
}

/* ---- All of it ---------------------------------------------------------------------------------- */

bool pm__policy_needs_importance(const pm__spec *policy)
{
    const pm__policy *const of = pm__policy_of(policy);
    return of->needs ? of->needs(policy) : of->by_importance;
}

double pm__policy_required(const pm__spec *policy, pm__map_kind kind, const pm__importance *importance,
                           double importance_there)
{
    const pm__policy *const of = pm__policy_of(policy);
    return of->required ? of->required(policy, kind, importance, importance_there) : 0.0;
}

static pm_status check(const pm__storing_config *config, pm_error *error)
{
    if (pm__policy_needs_importance(config->policy) && !config->importance)
        return pm__fail(error, PM_EINVAL, "the policy %s needs importance", config->policy->entry->name);
    if (config->emitted > PM__MOST_TRACED)
        return pm__fail(error, PM_EINVAL, "%llu photons emitted: at most %llu can be",
                        (unsigned long long)config->emitted, (unsigned long long)PM__MOST_TRACED);
    return PM_OK;
}

/* Caustic photons go to where mirrors and glass are, be they sent evenly or by importance. */
static pm_status aim(run *r)
{
    pm__storage *const s = &r->storage;
    pm_status status = pm__paths_create(pm__map_paths[s->config->kind], &r->paths, s->error);
    if (status == PM_OK && s->config->kind == PM__CAUSTIC_MAP)
        status = pm__projection_create(s->config->scene, true, &r->projection, s->error);
    s->paths = r->paths;
    if (status != PM_OK)
        return status;
    pm__emission_init(s->config->scene, r->projection, PM__ALL_LIGHTS, s->config->seed, s->trial, &s->emission);
    return isfinite(s->emission.total) ? PM_OK
                                       : pm__fail(s->error, PM_EINVAL, "the lights' power adds up to %g W",
                                                  s->emission.total);
}

static pm_status prepare(run *r)
{
    pm__storage *const s = &r->storage;
    const double start = pm__seconds();
    pm_status status = aim(r);
    s->planned = s->emission.total > 0.0 && s->config->stored > 0 ? s->config->emitted : 0;
    s->threshold = s->config->importance ? pm__importance_threshold(s->config->importance, s->config->kind) : 0.0;
    if (status == PM_OK && s->planned > 0 && s->policy->send)
        status = s->policy->send->plan(s);
    const double planned = pm__seconds();
    r->set->trace_s += planned - start;
    if (status == PM_OK && s->policy->keep->begin)
        status = s->policy->keep->begin(s);
    r->set->policy_s += pm__seconds() - planned;
    return status == PM_ENOMEM ? out_of_memory(r) : status;
}

static void release(run *r)
{
    pm__storage *const s = &r->storage;
    if (s->policy->keep->release)
        s->policy->keep->release(s);
    if (s->policy->send)
        s->policy->send->release(s);
    pm__stock_free(&s->stock);
    pm__projection_destroy(r->projection);
    pm__paths_destroy(r->paths);
    free(r->importance);
    free(r->part);
}

pm_status pm__store_photons(const pm__storing_config *config, pm__stored_photons *set, pm_error *error)
{
    *set = (pm__stored_photons){0};
    run r = {.set = set,
             .storage = {.config = config,
                         .policy = pm__policy_of(config->policy),
                         .values = config->policy->values,
                         .trial = config->trial + ((uint32_t)config->kind << 24),
                         .unit = 1.0,
                         .error = error}};
    pm_status status = check(config, error);
    if (status != PM_OK)
        return status;
    status = prepare(&r);
    if (status == PM_OK)
        status = run_chunks(&r);
    if (status == PM_OK)
        status = finish(&r);
    release(&r);
    if (status != PM_OK)
        pm__stored_photons_free(set);
    return status;
}

void pm__stored_photons_free(pm__stored_photons *set)
{
    free(set->photons);
    free(set->normals);
    *set = (pm__stored_photons){0};
}
