#include "judge.h"

#include <math.h>
#include <stdlib.h>

/* d2 as the query's shape measures; -1 where it rejects the photon. */
static long double measure(const pm_query *query, const pm_photon *photon)
{
    long double d[3], n[3], d2 = 0, n2 = 0, height = 0, facing = 0;
    for (int a = 0; a < 3; a++) {
        d[a] = (long double)photon->position[a] - (long double)query->position[a];
        n[a] = (long double)query->normal[a];
        d2 += d[a] * d[a];
        n2 += n[a] * n[a];
        height += d[a] * n[a];
        facing += (long double)photon->direction[a] * n[a];
    }
    if (query->front_only && !(facing < 0))
        return -1;
    if (query->shape == PM_LOOKUP_SPHERE)
        return d2;
    const long double h = height / sqrtl(n2), parameter = (long double)query->shape_parameter;
    if (query->shape == PM_LOOKUP_ELLIPSOID)
        return d2 + (parameter * parameter - 1) * h * h;
    if (fabsl(h) > parameter)
        return -1;
    d2 = 0;
    for (int a = 0; a < 3; a++) {
        const long double t = d[a] - h * n[a] / sqrtl(n2);
        d2 += t * t;
    }
    return d2;
}

static int by_distance(const void *left, const void *right)
{
    const pm__near *const a = left, *const b = right;
    if (a->d2 != b->d2)
        return a->d2 < b->d2 ? -1 : 1;
    return a->index < b->index ? -1 : a->index > b->index;
}

void pm__judge_find(const pm_photon *photons, size_t count, const pm_query *query, size_t k, size_t map, size_t maps,
                    pm__nears *nears)
{
    const long double radius = (long double)query->max_radius;
    size_t accepted = 0;
    for (size_t i = map; i < count; i += maps) {
        const long double d2 = measure(query, &photons[i]);
        if (d2 >= 0)
            nears->near[accepted++] = (pm__near){d2, (uint32_t)i};
    }
    qsort(nears->near, accepted, sizeof *nears->near, by_distance);
    size_t wanted = 0;
    while (wanted < accepted && nears->near[wanted].d2 <= radius * radius && (!query->k || wanted < k))
        wanted++;
    nears->count = wanted;
    nears->cut = !query->k || (wanted < k && !isinf(query->max_radius));
    nears->r2 = nears->cut ? radius * radius : wanted ? nears->near[wanted - 1].d2 : 0;
    nears->gap = 1;
    for (size_t i = 1; i <= wanted && i < accepted; i++) {
        const long double here = nears->near[i].d2, before = nears->near[i - 1].d2;
        if (here > 0)
            nears->gap = fminl(nears->gap, (here - before) / here);
    }
    if (!isinf(query->max_radius)) /* is one close to the rim? */
        for (size_t i = 0; i < accepted && radius > 0; i++)
            nears->gap = fminl(nears->gap, fabsl(nears->near[i].d2 / (radius * radius) - 1));
}

size_t pm__judge_share(size_t k, size_t maps, size_t map)
{
    return k / maps + (map < k % maps ? 1 : 0);
}
