/* Every photon measured: the oracle that the other searches are held against. */
#include "result.h"

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    for (size_t i = 1; i <= map->count; i++)
        pm__offer_node(map, query, result, i);
}

const pm_search pm__search_brute = {
    .entry = {.name = "brute", .summary = "every photon measured: slow, and the judge of the others",
              .citation = "definition"},
    .find = find,
};
