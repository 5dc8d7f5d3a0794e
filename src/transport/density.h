/* Inside keep_density: a batch of arrivals, decided plot by plot. */
#ifndef PM_TRANSPORT_DENSITY_H
#define PM_TRANSPORT_DENSITY_H

#include "keep_density.h"
#include "plots.h"

/* The rule, its parameters resolved. */
typedef struct pm__density_rule {
    double neighbors;  /* M */
    float low, high;   /* 1/m2: required density is between, low > 0 */
    float per_pixel;   /* photons */
    bool cosine;
    int power;         /* of the convergence of caustics; 0: off */
} pm__density_rule;

/* An arrival on its way to its plot. */
typedef struct pm__seeker {
    uint64_t key, beside;
    float wanted;                         /* photons, of the plot */
    uint32_t arrival : 30; /* in the batch */
    uint32_t is_stored : 1, takes : 1; /* what is decided; it is given of what waits */
    float power[3], normal[3], direction[3];
    uint8_t at[2];                        /* in the plot's square */
} pm__seeker;

/* Arrivals that one thread prepares, or stores, at once; those of a batch, about. */
enum { PM__DENSITY_PIECE = 1024, PM__DENSITY_BATCH = 32 * PM__DENSITY_PIECE };

/* What became of a batch's arrivals in important places: how many, and how many found less than is required. */
typedef struct pm__density_tally {
    size_t arrived, lacking;
} pm__density_tally;

/* Of a piece, by shard: where its seekers begin in the piece's, then their end; and how many of them are stored. */
typedef struct pm__density_runs {
    uint16_t begin[PM__PLOT_SHARDS + 1], stored[PM__PLOT_SHARDS];
} pm__density_runs;

typedef struct pm__density {
    pm__storage *storage;
    pm__density_rule rule;
    pm__plots plots;
    uint64_t *keys;          /* of the plots that give to the stock's photons, from `before` on; 0: none does */
    size_t before, keys_room;
    pm__seeker *seekers;     /* of the batch: by piece, in it by shard, and then in their order */
    pm__density_runs *runs;  /* by piece */
    float *global;           /* W, all bands: all light on a plot there, by arrival; NULL: not asked for */
    size_t room;             /* arrivals that these hold */
    size_t *starts;          /* by piece: where in the stock its first stored photon goes */
    const pm__arrivals *all; /* the chunk in hand */
    size_t begin, count;     /* the batch in it */
    double emitted;          /* paths up to the batch */
    pm__density_tally tallies[PM__PLOT_SHARDS];
    _Atomic pm_status status;
} pm__density;

static inline size_t pm__density_pieces(size_t count)
{
    return (count + PM__DENSITY_PIECE - 1) / PM__DENSITY_PIECE;
}

static inline size_t pm__density_piece_end(const pm__density *d, size_t piece)
{
    return (piece + 1) * PM__DENSITY_PIECE < d->count ? (piece + 1) * PM__DENSITY_PIECE : d->count;
}

/* 1/m2, > 0. */
float pm__density_at(const pm__density_rule *rule, float importance);

/* Finds the plots of the batch's arrivals. */
void pm__density_prepare(pm__density *density);

/* Decides the batch, which is prepared; of those not stored the power waits from now on. What is stored is not in the
 * stock yet. ENOMEM. */
pm_status pm__density_decide(pm__density *density);

#endif
