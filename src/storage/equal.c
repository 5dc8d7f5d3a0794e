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
        if (!isfinite(a->error) || !isfinite(b->error) || a->error == b->error)
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

static const char *why_none(const pm__sizes *mine, const place *places, size_t count)
{
    double least = (double)INFINITY, most = (double)-INFINITY, mine_least = (double)INFINITY;
    for (size_t i = 0; i < count; i++) {
        least = fmin(least, places[i].error);
        most = fmax(most, places[i].error);
    }
    for (size_t i = 0; i < mine->count; i++)
        mine_least = fmin(mine_least, place_of(mine, i, SIZE_MAX).error);
    return count < 2             ? "it takes two sizes of all to compare with"
           : !isfinite(least)    ? "an error of all does not stand out of the reference's"
           : mine_least > most   ? "its errors are larger than all of those of all"
           : mine_least < least  ? "its errors are smaller than all of those of all"
                                 : "its errors are none of those between the sizes of all";
}

/* The logarithm of the ratio at a size, without a trial. */
static double log_ratio(const pm__sizes *mine, size_t size, const pm__sizes *other, size_t left, place *places)
{
    const place own = place_of(mine, size, left);
    list_places(other, left, places);
    return cost_at(places, other->count, own.error, true) - own.cost;
}

static void fill(const pm__sizes *mine, const pm__sizes *other, place *places, double *without, pm__equal *equal)
{
    double least = (double)INFINITY, found = (double)NAN;
    list_places(other, SIZE_MAX, places);
    for (size_t i = 0; i < mine->count; i++) {
        const place own = place_of(mine, i, SIZE_MAX);
        const double cost = cost_at(places, other->count, own.error, false);
        if (isfinite(cost) && own.error < least) {
            least = own.error;
            found = cost - own.cost;
            equal->at = i;
        }
    }
    if (equal->at == SIZE_MAX) {
        equal->why = why_none(mine, places, other->count);
        return;
    }
    equal->ratio = exp(found);
    for (size_t t = 0; t < mine->trials; t++)
        without[t] = log_ratio(mine, equal->at, other, t, places);
    const double half = pm__jackknife_half(without, mine->trials);
    equal->ci95 = (pm__interval){exp(found - half), exp(found + half)};
}

pm__equal pm__equal_error(const pm__sizes *mine, const pm__sizes *other)
{
    pm__equal equal = {SIZE_MAX, (double)NAN, {(double)NAN, (double)NAN}, NULL};
    place *const places = pm__alloc(other->count, sizeof *places);
    double *const without = pm__alloc(mine->trials, sizeof *without);
    if (places && without && mine->trials > 1)
        fill(mine, other, places, without, &equal);
    else
        equal.why = mine->trials > 1 ? "out of memory" : "it takes two trials";
    free(places);
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
