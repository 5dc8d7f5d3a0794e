/* What a storage policy is: how photons are sent, and which of those that arrive are kept, with what power. Strategies
 * that several policies share stand beside the driver (storing.c). */
#ifndef PM_TRANSPORT_POLICIES_POLICY_H
#define PM_TRANSPORT_POLICIES_POLICY_H

#include "../emission.h"
#include "../stock.h"
#include "../storing.h"

struct pm__policy;

/* Photons that have come to where they can be stored, path by path. power: in units of the storage, as if the number of
 * photons emitted were 1. */
typedef struct pm__arrivals {
    const pm_photon *photons;
    const float (*normals)[3];
    const uint32_t *numbers;    /* of their paths, from `first` on */
    const float *importance;    /* 1/m2; NULL: nobody knows it */
    const unsigned char *part;  /* 1: in a place that is important */
    const unsigned char *aside; /* 1: it is taken care of, and not to be kept; NULL: none is */
    size_t count;
    uint64_t first;
} pm__arrivals;

/* What the stock stands for, without trial sets. */
typedef struct pm__account {
    uint64_t sent;          /* paths */
    uint64_t emitted;       /* photons: that of the path before which storing ended, too */
    size_t arrived;
    double came[PM__PARTS]; /* in units, as if one were emitted */
} pm__account;

/* Storing ended before this path, or with the first, which is enough. */
static inline void pm__account_end(pm__account *account, uint64_t path, bool one_is_enough)
{
    account->sent = one_is_enough ? 1 : path;
    account->emitted = one_is_enough ? 1 : path + 1;
}

/* A map in the making. */
typedef struct pm__storage {
    const pm__storing_config *config;
    const struct pm__policy *policy;
    const double *values;      /* of the policy's parameters */
    uint32_t trial;            /* of the numbers that are drawn: another for each kind of map */
    const pm__paths *paths;
    pm__emission emission;     /* what is sent */
    uint64_t planned;          /* photons to be sent at most, without those of trial sets */
    uint64_t tried;            /* photons of trial sets */
    double unit;               /* W: the powers of arrivals and of the stock are in it */
    double threshold;          /* 1/m2: from here on a place is important */
    pm__stock stock;
    pm__account account;
    size_t settled;            /* the first so many of the stock have their power already, in units */
    double settled_came[PM__PARTS]; /* what came of them, in units, and how many */
    size_t settled_arrived;
    struct pm__sender *sender; /* how photons are sent: the policy's `send` */
    void *own;                 /* the policy's `keep` */
    pm_error *error;
} pm__storage;

/* Each part may be NULL. Errors are told in storage->error. */
typedef struct pm__sending {
    /* Says how photons are sent: emission and planned. */
    pm_status (*plan)(pm__storage *storage);
    void (*release)(pm__storage *storage);
} pm__sending;

typedef struct pm__keeping {
    pm_status (*begin)(pm__storage *storage);
    /* Takes arrivals in their order, up to the end of the path before that by which config->stored are stored, and says
     * how many it took: all of them, or storing has ended. See pm__path_is_first for the one path that is never left
     * out. */
    pm_status (*keep)(pm__storage *storage, const pm__arrivals *arrivals, size_t *taken);
    /* All have arrived: what is owed is put into the stock. Of so many that are wanted it may take back the last paths,
     * by the same rule. unmet: see storing.h. */
    pm_status (*end)(pm__storage *storage, bool *unmet);
    void (*release)(pm__storage *storage);
} pm__keeping;

typedef struct pm__policy {
    pm__entry entry;
    const pm__sending *send; /* NULL: evenly, caustic photons to where mirrors and glass are */
    const pm__keeping *keep; /* all that are sent evenly or by importance */
    bool by_importance;      /* it asks for importance */
    /* As pm__policy_required. NULL: 0. */
    double (*required)(const pm__spec *policy, pm__map_kind kind, const pm__importance *importance, double there);
    bool (*needs)(const pm__spec *policy); /* NULL: by_importance says it */
} pm__policy;

static inline const pm__policy *pm__policy_of(const pm__spec *spec)
{
    return (const pm__policy *)spec->entry;
}

/* By name, of the policy in hand; `absent` where it has none of that name. */
static inline double pm__policy_value(const pm__storage *storage, const char *name, double absent)
{
    return pm__spec_value(storage->config->policy, name, absent);
}

/* The first arrival of the path that arrival i is of. */
static inline size_t pm__path_begin(const pm__arrivals *arrivals, size_t i)
{
    while (i > 0 && arrivals->numbers[i - 1] == arrivals->numbers[i])
        i--;
    return i;
}

/* What is stored of all paths but the last, over the number of these, is what a path stores (errata 37: all orders of
 * the paths by which there are just enough are equally likely). Where one path is enough it stands for itself. */
static inline bool pm__path_is_first(const pm__arrivals *arrivals, size_t i)
{
    return arrivals->first + arrivals->numbers[i] == 0;
}

#endif
