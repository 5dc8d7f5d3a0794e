/* Where a search begins, and the squared radius that it tries first. Only its time depends on them. */
#ifndef PM_SEARCH_WIDE_GUESS_H
#define PM_SEARCH_WIDE_GUESS_H

#include "wide_measure.h"

/* How much wider than the density says, and how much for the scatter of k: the cost of too many against too few. */
#define GUESS_MARGIN 1.04f
#define GUESS_NOISE 1.4f

typedef struct start {
    int32_t block; /* somewhere near the query */
    float guess;
} start;

static inline float limited(const pm__query *query, float radius2)
{
    const float positive = radius2 > FLT_MIN ? radius2 : FLT_MIN;
    return positive < query->max_distance2 ? positive : query->max_distance2;
}

/* log2 and 2^x to 1 %, which a guess bears; x from -126 to 126. */
static inline float rough_log2(float x)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    const float exponent = (float)((int)(bits >> 23) - 128);
    bits = (bits & 0x7fffff) | 0x3f800000;
    float m;
    memcpy(&m, &bits, sizeof m);
    return exponent + m * (2.0f - m * (1.0f / 3.0f)) - 2.0f / 3.0f;
}

static inline float rough_exp2(float x)
{
    const float clamped = x < -126.0f ? -126.0f : x > 126.0f ? 126.0f : x;
    const int whole = (int)(clamped + 127.0f); /* positive, so this is the floor */
    const float part = clamped + 127.0f - (float)whole;
    const uint32_t bits = (uint32_t)whole << 23;
    float power;
    memcpy(&power, &bits, sizeof power);
    return power * (1.0f + part * (0.6565f + 0.3435f * part));
}

/* What a guess knows of k: log2(k / PM__HINT_NEAR), and how much wider than the mean it has to be. */
typedef struct scale {
    size_t k;
    float doublings, scatter;
} scale;

static inline scale scale_of(size_t k)
{
    const float count = (float)(k ? k : 1);
    return (scale){k, rough_log2(count * (1.0f / PM__HINT_NEAR)), GUESS_MARGIN + GUESS_NOISE / sqrtf(count)};
}

/* Squared radii grow like a power of the number of photons: 1 on surfaces, 2/3 in volumes, 2 along lines. Between the
 * two numbers of the hints the power is the local one; below them it is of the nearest of these kinds. */
static inline float hinted_radius2(const pm__hint *hint, const scale *k)
{
    const float near = (float)hint->log_near * (1.0f / PM__HINT_STEPS);
    float power = (float)(hint->log_far - hint->log_near) * (1.0f / (3.0f * PM__HINT_STEPS)); /* 3 doublings apart */
    if (k->doublings < 0.0f)
        power = power > 1.4f ? 2.0f : power > 0.8f ? 1.0f : 0.667f;
    return rough_exp2(near + power * k->doublings);
}

/* ---- a descent, where there is no hint -------------------------------------------------------- */

/* How far down a descent goes: to a box that holds about k photons or more, so that its density is the local one. */
static inline int guess_level(const pm__wide *wide, size_t k)
{
    int level = 0;
    for (size_t photons = PM__LANES; photons * 2 < k && level < wide->levels - 1; photons *= PM__LANES)
        level++;
    return level;
}

/* The squared radius that holds k photons at the density of a box with that many: of a surface where it is flat, of a
 * volume where it is not. */
static float radius2_of_box(const float extent[3], size_t photons, size_t k)
{
    float e0 = extent[0], e1 = extent[1], e2 = extent[2], t;
    if (e1 > e0) { t = e0; e0 = e1; e1 = t; }
    if (e2 > e0) { t = e0; e0 = e2; e2 = t; }
    if (e2 > e1) { t = e1; e1 = e2; e2 = t; }
    const float share = (float)k / (float)photons;
    float r2 = share * e0 * e1 * 0.31831f;
    if (e2 > 0.5f * e1) {
        const float r = cbrtf(share * e0 * e1 * e2 * 0.238732f);
        r2 = r * r;
    }
    const float line = 0.5f * share * e0;
    return r2 < 1e-3f * line * line ? line * line : r2; /* nearly a line, or all in one point */
}

static start descend(const walk *w, const scale *k)
{
    const pm__query *const query = w->query;
    const int stop = query->k ? guess_level(w->wide, query->k) : 0;
    float distance2 = 0.0f, extent[3] = {0.0f, 0.0f, 0.0f};
    size_t node = 0;
    for (int level = w->wide->levels - 1; level >= stop; level--) {
        const pm__boxes *const boxes = &w->wide->level[level][node];
        const unsigned lane = nearest_box(boxes, query, &distance2);
        node = node * PM__LANES + lane;
        if (level == stop)
            for (int a = 0; a < 3; a++)
                extent[a] = boxes->high[a][lane] - boxes->low[a][lane];
    }
    const size_t full = (size_t)PM__LANES << 4 * stop, first = node * full; /* all are full but the last */
    const size_t photons = first + full <= w->map->count ? full : w->map->count > first ? w->map->count - first : 1;
    float r2 = radius2_of_box(extent, photons, query->k);
    if (distance2 > 0.0f) {
        const float r = sqrtf(r2) + sqrtf(distance2);
        r2 = r * r;
    }
    return (start){(int32_t)(node << 4 * stop), query->k ? limited(query, r2 * k->scatter) : query->max_distance2};
}

static inline start begin(const walk *w, const scale *k)
{
    const pm__hints *const hints = &w->wide->hints;
    if (!hints->count)
        return descend(w, k);
    const pm__hint *const hint = pm__hint_at(hints, w->query->position);
    if (!w->query->k) /* without a hint any block will do */
        return (start){hint->block < 0 ? 0 : hint->block, w->query->max_distance2};
    if (hint->block < 0)
        return descend(w, k);
    return (start){hint->block, limited(w->query, hinted_radius2(hint, k) * k->scatter)};
}

#endif
