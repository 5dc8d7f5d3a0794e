#include "equal.h"

#include "tally.h"

#include "../base/memory.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

/* One size as a point of the graph: logarithms of its means, without trial `left` (SIZE_MAX: with all). */
typedef struct place {
    double cost, error;
    size_t size;
} place;

static double mean_without(const double *x, size_t count, size_t left)
{
    double sum = 0.0;
    for (size_t i = 0; i < count; i++)
        sum += i == left ? 0.0 : x[i];
    return sum / (double)(left < count ? count - 1 : count);
}

/* Where the square is not above 0 the error is -INFINITY. */
static place place_of(const pm__sizes *sizes, size_t size, size_t left)
{
    const double square = mean_without(sizes->square[size], sizes->trials, left);
    return (place){log(mean_without(sizes->cost[size], sizes->trials, left)),
                   square > 0.0 ? 0.5 * log(square) : (double)-INFINITY, size};
}

static int by_cost(const void *a, const void *b)
{
    const place *const p = a, *const q = b;
    return p->cost < q->cost ? -1 : p->cost > q->cost ? 1 : p->size < q->size ? -1 : 1;
}

static void list_places(const pm__sizes *sizes, size_t left, place *places)
{
    for (size_t i = 0; i < sizes->count; i++)
        places[i] = place_of(sizes, i, left);
    qsort(places, sizes->count, sizeof *places, by_cost);
}

/* Those alone that have logarithms: how many. A line goes on to the next of them. */
static size_t list_clear(const pm__sizes *sizes, size_t left, place *places)
{
    size_t count = 0;
    list_places(sizes, left, places);
    for (size_t i = 0; i < sizes->count; i++)
        if (isfinite(places[i].error) && isfinite(places[i].cost))
            places[count++] = places[i];
    return count;
}

static double along(const place *a, const place *b, double error)
{
    return a->cost + (error - a->error) / (b->error - a->error) * (b->cost - a->cost);
}

/* The cost at an error; NAN beyond the range, unless `beyond`: then along the line nearest to it. */
static double cost_at(const place *places, size_t count, double error, bool beyond)
{
    double nearest = (double)INFINITY, cost = (double)NAN;
    for (size_t i = 0; i + 1 < count; i++) {
        const place *const a = &places[i], *const b = &places[i + 1];
        if (a->error == b->error)
            continue;
        if (fmin(a->error, b->error) <= error && error <= fmax(a->error, b->error))
            return along(a, b, error);
        const double off = fmin(fabs(error - a->error), fabs(error - b->error));
        if (beyond && off < nearest) {
            nearest = off;
            cost = along(a, b, error);
        }
    }
    return cost;
}

/* That of the least error; NULL: there is none. */
static const place *least_of(const place *places, size_t count)
{
    const place *least = NULL;
    for (size_t i = 0; i < count; i++)
        if (!least || places[i].error < least->error)
            least = &places[i];
    return least;
}

static double most_of(const place *places, size_t count)
{
    double most = (double)-INFINITY;
    for (size_t i = 0; i < count; i++)
        most = fmax(most, places[i].error);
    return most;
}

/* Both, mine first, and room for the places of each. */
typedef struct pair {
    const pm__sizes *sizes[2];
    place *places[2];
    size_t count[2]; /* places that are clear, with all trials */
} pair;

static const char *why_none(const pair *p, const place *const least[2], int which)
{
    static const char *const apart[2] = {"its errors are smaller than all of those of all",
                                         "its errors are larger than all of those of all"};
    for (int i = 0; i < 2; i++)
        if (!least[i])
            return i ? "no error of all stands out of the reference's" : "no error stands out of the reference's";
    if (least[which]->error > most_of(p->places[!which], p->count[!which]))
        return apart[!which];
    return which ? "it takes two sizes of different errors" : "it takes two sizes of all of different errors";
}

/* The logarithm of the ratio at the error of this size of one of both, without a trial. */
static double log_ratio(const pair *p, int which, size_t size, size_t left)
{
    const place own = place_of(p->sizes[which], size, left);
    const size_t count = list_clear(p->sizes[!which], left, p->places[!which]);
    const double other = cost_at(p->places[!which], count, own.error, true);
    return which ? own.cost - other : other - own.cost;
}

/* One of both is compared at a size that it has: that of the least error, if the other reaches it. Intervals keep to
 * that size, whose error moves as a trial is left out: a ratio that went from one to the other would leap. */
static void fill(pair *p, double *without, pm__equal *equal)
{
    const place *least[2];
    for (int i = 0; i < 2; i++) {
        p->count[i] = list_clear(p->sizes[i], SIZE_MAX, p->places[i]);
        least[i] = least_of(p->places[i], p->count[i]);
    }
    const int which = least[0] && least[1] && least[1]->error > least[0]->error;
    const place own = least[which] ? *least[which] : (place){0.0, 0.0, 0};
    const double other = cost_at(p->places[!which], p->count[!which], own.error, false);
    if (!least[0] || !least[1] || !isfinite(other)) {
        equal->why = why_none(p, least, which);
        return;
    }
    const double found = which ? own.cost - other : other - own.cost;
    const size_t trials = p->sizes[0]->trials;
    equal->error = exp(own.error);
    equal->ratio = exp(found);
    for (size_t t = 0; t < trials; t++)
        without[t] = log_ratio(p, which, own.size, t);
    const double half = pm__jackknife_half(without, trials);
    equal->ci95 = (pm__interval){exp(found - half), exp(found + half)};
}

pm__equal pm__equal_error(const pm__sizes *mine, const pm__sizes *other)
{
    pm__equal equal = {(double)NAN, (double)NAN, {(double)NAN, (double)NAN}, NULL};
    pair p = {{mine, other}, {NULL, NULL}, {0, 0}};
    double *const without = pm__alloc(mine->trials, sizeof *without);
    for (int i = 0; i < 2; i++)
        p.places[i] = pm__alloc(p.sizes[i]->count, sizeof **p.places);
    if (p.places[0] && p.places[1] && without && mine->trials > 1)
        fill(&p, without, &equal);
    else
        equal.why = mine->trials > 1 ? "out of memory" : "it takes two trials";
    free(p.places[0]);
    free(p.places[1]);
    free(without);
    return equal;
}

size_t pm__undominated(const pm__sizes *sizes, size_t *front)
{
    place *const places = pm__alloc(sizes->count, sizeof *places);
    double least = (double)INFINITY;
    size_t count = 0;
    if (!places)
        return 0;
    list_places(sizes, SIZE_MAX, places);
    for (size_t i = 0; i < sizes->count; i++)
        if (places[i].error < least) {
            least = places[i].error;
            front[count++] = places[i].size;
        }
    free(places);
    return count;
}
