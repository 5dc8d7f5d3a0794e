/* Inside keep_density: a batch of arrivals, decided against what is stored when it begins. */
#ifndef PM_TRANSPORT_DENSITY_H
#define PM_TRANSPORT_DENSITY_H

#include "crowd.h"
#include "keep_density.h"

/* The rule, its parameters resolved. */
typedef struct pm__density_rule {
    size_t neighbors;  /* M */
    double constant;   /* 1/m2, or 0 */
    double low, high;  /* 1/m2: importance is taken to be between */
    double per_pixel;  /* photons */
    double longest;    /* m: no reach is longer */
    bool wide;         /* D_cur / D_r is asked for below 1: twice the reach is searched */
    bool cosine;
    int power;         /* of the convergence of caustics; 0: off */
} pm__density_rule;

/* aside: it is not to be kept at all. */
typedef enum pm__verdict { PM__STORE, PM__SHARE_OUT, PM__ASIDE } pm__verdict;

typedef struct pm__arrival {
    uint64_t key;       /* of its cell */
    float reach;        /* m: within it M photons are enough */
    float global;       /* W/m2, all bands, of all light; 0: not asked for */
    uint16_t found;     /* neighbours */
    uint8_t verdict;
    bool lacks;         /* it found less than is required */
} pm__arrival;

/* An arrival as searches look at it, by cell. */
typedef struct pm__seeker {
    uint64_t key;
    float position[3], reach;
    uint32_t arrival, tag;
} pm__seeker;

typedef struct pm__order {
    uint32_t code, arrival;
} pm__order;

/* What a stored photon is given by the arrivals of one cell. */
typedef struct pm__gift {
    uint32_t id;
    double power[3];
} pm__gift;

typedef struct pm__gifts {
    pm__gift *items;
    size_t count, room;
} pm__gifts;

/* What a thread searches with. */
typedef struct pm__searcher {
    pm__crowd_hood hood;
    pm__crowd_found found;
    pm__crowd_sum *sums; /* of the hood's */
    size_t room;
} pm__searcher;

/* Arrivals that one thread decides at once. */
enum { PM__DENSITY_TASK = 1024 };

typedef struct pm__density {
    pm__storage *storage;
    pm__density_rule rule;
    pm__crowd crowd;
    const pm__crowd_kernel *kernel;
    double (*powers)[3];     /* of the stock, in its units */
    size_t powers_room;
    pm__arrival *arrivals;   /* of the batch */
    pm__order *sorted, *spare;
    size_t room;
    pm__gifts *gifts;        /* by task */
    size_t gift_lists;
    const pm__arrivals *all; /* the chunk in hand */
    size_t begin, count;     /* the batch in it */
    double emitted;          /* paths up to the batch */
    _Atomic pm_status status;
} pm__density;

double pm__density_reach(const pm__density_rule *rule, double required);
/* What is searched to decide about an arrival of this reach, m. */
static inline double pm__density_searched(const pm__density_rule *rule, double reach)
{
    return rule->wide ? 2.0 * reach : reach;
}

/* Photons that came to surfaces which lie alike, and matter alike, have the same tag. */
uint32_t pm__density_tag(const float normal[3], bool important);

/* Decides the batch, and makes the gifts of those that are not stored. ENOMEM. */
pm_status pm__density_decide(pm__density *density);

/* One arrival once more: others have been stored since. Its gifts go straight to those that they are for. ENOMEM. */
pm_status pm__density_again(pm__density *density, size_t arrival, pm__searcher *with);
void pm__searcher_free(pm__searcher *with);

#endif
