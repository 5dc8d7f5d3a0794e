/* Sending by importance: trial photons say which strata of emission lead to where it matters.
 * [C02] 5.7.4 (Christensen), 3.5.3 (Peter and Pietrek 1998). */
#ifndef PM_TRANSPORT_SEND_STRATA_H
#define PM_TRANSPORT_SEND_STRATA_H

#include "policies/policy.h"
#include "strata.h"

/* Put aside: see strays.h. */
typedef struct pm__stray {
    pm_photon photon; /* power: in units of the storage */
    float normal[3];
    bool important;
    size_t parts;     /* so many are as even as others */
    size_t place;     /* in the stock, if it is there */
} pm__stray;

typedef struct pm__sender {
    pm__strata strata;
    double heaviest; /* of the strata's loads */
    pm__stray *strays; /* put aside, and those in the stock by their places */
    size_t stray_count, stray_room;
    size_t *places;    /* in the stock's order */
    size_t place_count, place_room;
    uint64_t *paths;   /* of each photon of the stock behind the settled ones, if so many stored are wanted */
    size_t path_room;
} pm__sender;

/* Parameters `strata`, `tests`: a light's strata and trial photons of each at least. First whole lights are tried;
 * those of which photons find importance are cut into strata, others are one. Strata send, of what even sending of
 * config->emitted photons would, the share that is best by what their trial photons found, up to all of it, but no
 * less than 1/`ratio`, and no less than one photon or what even sending would: so photons carry up to `ratio` times
 * the power. Photons are fresh, so that nothing is biased. With `form=printed` all lights are cut; strata of which a
 * trial photon comes to an important place send as even sending would, those in vain none: what their trial photons
 * stored is stored, each for its share of the stratum (erratum 38). */
extern const pm__sending pm__send_sets;

/* Parameters `strata`, `tests`, `least`: tried in the same way, strata send by their power times what their trial
 * photons found of importance, and a share `least` of all photons evenly. */
extern const pm__sending pm__send_by_importance;

/* Power of arrival i's path when it left, over that of a photon sent evenly. */
static inline double pm__load_of(const pm__storage *storage, const pm__arrivals *arrivals, size_t i)
{
    const pm__sender *const sender = storage->sender;
    if (!sender)
        return 1.0;
    return sender->strata.items[pm__strata_find(&sender->strata, arrivals->first + arrivals->numbers[i])].load;
}

#define PM__STRATA_PARAMS_OF(strata, tests)                                                                        \
    {"strata", PM__INTEGER, strata, 1.0, 65536.0, "", NULL, "of each light's emission; a power of two of them"},   \
        {"tests", PM__INTEGER, tests, 1.0, 4096.0, "", NULL, "trial photons of each stratum"}
#define PM__SETS_PARAMS_OF(strata, tests, ratio)                                                                    \
    PM__STRATA_PARAMS_OF(strata, tests),                                                                            \
        {"ratio", PM__REAL, ratio, 1.0, 1e4, "", NULL, "of photons of strata that matter to those of others"},      \
        {"strays", PM__CHOICE, 0, 0, 1, "", "share|keep", "powerful photons where it matters: shared out, or stored"}
#define PM__STRATA_PARAMS PM__STRATA_PARAMS_OF(64.0, 8.0)
#define PM__SETS_PARAMS PM__SETS_PARAMS_OF(64.0, 8.0, 16.0)
enum { PM__STRATA_PARAM_COUNT = 2, PM__SETS_PARAM_COUNT = 4 };

#endif
