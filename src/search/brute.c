/* Every photon measured: the oracle that the other searches are held against. */
#include "result.h"

static void find(const pm_map *map, const pm__query *query, pm__result *result)
{
    for (size_t number = 0; number < map->count; number++) {
        float position[3];
        pm__position(map, number, position);
        pm__offer(map, query, result, position, (uint32_t)number);
    }
}

const pm_search pm__search_brute = {
    .entry = {.name = "brute", .summary = "every photon measured: slow, and the judge of the others",
              .citation = "definition"},
    .find = find,
};
