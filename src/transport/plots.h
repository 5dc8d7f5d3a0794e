/* Surface in plots, so large that about as many photons are required of one as power is shared out among: how many are
 * stored in each, and what power waits there for them.
 *
 * A plot is what of the surfaces whose normals are of one class (cone.h) lies in a cell: a square along the two axes
 * across that to which the class is nearest, and as deep as wide along the middle of the class. So a flat piece along
 * axes that crosses a cell has the area of the square, and one whose normal is n that over the largest |n|. Squares
 * come in sizes that double, four to the next: a place is of the one of which from a quarter to all of M are required.
 * A photon is also counted in the next size that it is nearer to: so it is in all that its neighbours look at, whose
 * required densities are about its own, unless that is in the middle of a size. Where these jump those on either side
 * do not see each other. Power is not shared across sizes, nor between important places and others. */
#ifndef PM_TRANSPORT_PLOTS_H
#define PM_TRANSPORT_PLOTS_H

#include "../photonmap.h"
#include "lanes.h"

#include <stdbool.h>

/* One line of the cache. */
typedef struct pm__plot {
    uint64_t key;            /* 0: there is none */
    double waiting[3];       /* power of photons that are not stored */
    float normal[3];         /* of the first that came: those of its own that face it are given what waits */
    float wanted;            /* photons required, added up over those that came */
    uint32_t came;
    uint32_t stored;         /* photons, those of other sizes too */
    uint32_t takers;         /* of its own that are stored, those that are given what waits */
    uint8_t box[4];          /* of those that came, 256ths of the square: least and most along either axis */
} pm__plot;

/* Plots of a share of all keys, to be worked on by one thread at a time: a table by key, open addressing. */
typedef struct pm__plot_shard {
    pm__plot *plots;
    size_t count, size; /* size: of the table, a power of two; 0: nothing came there yet */
    double *light;      /* power of all that came there, by plot; NULL: nobody asks for it */
} pm__plot_shard;

typedef struct pm__plots {
    pm__plot_frame frame;
    const pm__lanes *lanes;
    bool lit;                              /* light is asked for */
    size_t first_size;                     /* of a shard's table */
    pm__plot_shard shards[PM__PLOT_SHARDS];
} pm__plots;

/* Where a photon comes to. */
typedef struct pm__plot_place {
    uint64_t key;
    uint64_t beside; /* key of the plot there of another size, the next that the photon is to be counted in; 0: none */
    float wanted;  /* photons required of a plot like this */
    float area;    /* m2 of it */
    uint8_t at[2]; /* in the square, 256ths of its edge */
    uint8_t shard;
} pm__plot_place;

/* neighbors: M; usual: 1/m2, a density that is required, > 0: of its plots half of M are; least: the least that is;
 * low: of a box of `across` m about all places; photons: that will be sent, about. */
void pm__plots_init(pm__plots *plots, double neighbors, double usual, double least, const double low[3], double across,
                    uint64_t photons, bool lit);

/* The shard of a place that has the key. */
size_t pm__plot_shard_of(const pm__plots *plots, uint64_t key);
void pm__plots_free(pm__plots *plots);

/* Where photons come to. required: 1/m2, > 0; important: 0 or 1. Areas are those of plots of their normals that are
 * crossed all over. */
void pm__plots_place(const pm__plots *plots, const pm_photon *photons, const float (*normals)[3],
                     const float *required, const unsigned char *important, size_t count, pm__plot_place *places);

/* A photon came to the plot, which is not free. */
static inline void pm__plot_meet(pm__plot *plot, float wanted, const uint8_t at[2])
{
    plot->wanted += wanted;
    plot->came++;
    for (int i = 0; i < 2; i++) {
        plot->box[2 * i] = at[i] < plot->box[2 * i] ? at[i] : plot->box[2 * i];
        plot->box[2 * i + 1] = at[i] > plot->box[2 * i + 1] ? at[i] : plot->box[2 * i + 1];
    }
}

/* How much of the plot there is, where it is cut by the end of what it lies on: n photons that fall evenly on a length
 * span (n - 1) / (n + 1) of it on average. */
static inline float pm__plot_filled(const pm__plot *plot)
{
    const float n = (float)plot->came, part = (n + 1.0f) / (256.0f * (n - 1.0f));
    const float u = (float)(plot->box[1] - plot->box[0] + 1) * part;
    const float v = (float)(plot->box[3] - plot->box[2] + 1) * part;
    return plot->came > 1 ? (u < 1.0f ? u : 1.0f) * (v < 1.0f ? v : 1.0f) : 1.0f;
}

/* Photons required of it, on average over those that came. */
static inline float pm__plot_wanted(const pm__plot *plot)
{
    return plot->wanted / (float)plot->came * pm__plot_filled(plot);
}

/* Are there enough, whatever of it there is? */
static inline bool pm__plot_is_full(const pm__plot *plot)
{
    return (float)plot->stored * (float)plot->came >= plot->wanted;
}

static inline bool pm__plot_is_important(uint64_t key)
{
    return key >> PM__PLOT_IMPORTANT_AT & 1;
}

/* Fetches what the next two would look at. */
static inline void pm__plot_prefetch(const pm__plot_shard *shard, uint64_t key)
{
    __builtin_prefetch(&shard->plots[pm__plot_hash(key) & (shard->size - 1)], 1);
}

/* That of the key, or a free one. The shard has a table. */
static inline pm__plot *pm__plot_find(const pm__plot_shard *shard, uint64_t key)
{
    size_t i = pm__plot_hash(key) & (shard->size - 1);
    while (shard->plots[i].key && shard->plots[i].key != key)
        i = (i + 1) & (shard->size - 1);
    return &shard->plots[i];
}

/* Valid until the next is added. NULL: out of memory. */
pm__plot *pm__plot_add(pm__plots *plots, size_t shard, uint64_t key);

/* What the shard holds now, to be put back once; `to` is empty. ENOMEM. */
pm_status pm__plot_shard_copy(const pm__plot_shard *shard, pm__plot_shard *to);
void pm__plot_shard_free(pm__plot_shard *shard);

#endif
