#include "crowd.h"

#include "../base/memory.h"
#include "../search/wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Bits of a cell's coordinate in its key. Coordinates wrap: cells that share a key are far apart, and a photon's
 * distance tells. */
enum { BITS = 18 };

/* Cells of a region's edge, as bits. */
enum { REGION_BITS = 2, REGION_EDGE = 1 << REGION_BITS };

/* Counters of fresh photons. */
enum { COUNTERS = 1 << 18 };

pm_status pm__crowd_init(pm__crowd *crowd, double edge, bool one_reach)
{
    *crowd = (pm__crowd){.one_reach = one_reach, .fresh = calloc(COUNTERS, sizeof *crowd->fresh)};
    for (int level = 0; level < PM__CROWD_LEVELS; level++)
        crowd->inverse_edge[level] = ldexp(1.0 / edge, PM__CROWD_MIDDLE - level);
    return crowd->fresh ? PM_OK : PM_ENOMEM;
}

void pm__crowd_free(pm__crowd *crowd)
{
    free(crowd->cells);
    free(crowd->regions);
    free(crowd->blocks);
    free(crowd->fresh);
    *crowd = (pm__crowd){0};
}

/* ---- Keys --------------------------------------------------------------------------------------- */

static uint64_t key_of(const int64_t cell[3], int level)
{
    const uint64_t mask = ((uint64_t)1 << BITS) - 1;
    uint64_t key = (uint64_t)level;
    for (int a = 0; a < 3; a++)
        key = key << BITS | ((uint64_t)cell[a] & mask);
    return key + 1; /* never 0 */
}

static size_t hash(uint64_t key)
{
    key ^= key >> 31;
    key *= 0x9e3779b97f4a7c15u;
    key ^= key >> 29;
    key *= 0xbf58476d1ce4e5b9u;
    return (size_t)(key ^ key >> 32);
}

/* The largest whole number that is not above. */
static inline int64_t coordinate(double x, double inverse_edge)
{
    static const double farthest = 0x1p52;
    const double cells = fmax(-farthest, fmin(x * inverse_edge, farthest));
    const int64_t toward_zero = (int64_t)cells;
    return toward_zero - ((double)toward_zero > cells);
}

/* The smallest level whose edge is no less than reach, of those that there are; by how much less reach is, in
 * (0.5, 1]. As frexp has it, without a call. */
static inline int level_of(const pm__crowd *crowd, double reach, double *fill)
{
    const double edges = reach * crowd->inverse_edge[PM__CROWD_MIDDLE];
    uint64_t bits;
    memcpy(&bits, &edges, sizeof bits);
    int level = (int)(bits >> 52) - 1022;
    bits = (bits & 0x000fffffffffffffu) | 0x3fe0000000000000u;
    memcpy(fill, &bits, sizeof bits);
    if (*fill == 0.5) {
        *fill = 1.0;
        level--;
    }
    level += PM__CROWD_MIDDLE;
    return level < 1 ? 1 : level > PM__CROWD_LEVELS - 2 ? PM__CROWD_LEVELS - 2 : level;
}

static inline pm__crowd_place place_at(const pm__crowd *crowd, const float position[3], int level)
{
    pm__crowd_place place = {.level = level};
    for (int a = 0; a < 3; a++)
        place.cell[a] = coordinate((double)position[a], crowd->inverse_edge[level]);
    place.key = key_of(place.cell, level);
    return place;
}

pm__crowd_place pm__crowd_place_of(const pm__crowd *crowd, const float position[3], double reach)
{
    double fill;
    return place_at(crowd, position, level_of(crowd, reach, &fill));
}

/* Its place in the table; that of a free one if it is not there. The table must have one. */
static size_t find_region(const pm__crowd *crowd, uint64_t key)
{
    size_t i = hash(key) & (crowd->table_size - 1);
    while (crowd->regions[i].key && crowd->regions[i].key != key)
        i = (i + 1) & (crowd->table_size - 1);
    return i;
}

/* Cells of a region, as bits: z runs fastest. */
static uint64_t cells_between(const int64_t region[3], const int64_t from[3], const int64_t to[3])
{
    static const uint64_t slices[3] = {0xffff, 0x000f000f000f000f, 0x1111111111111111};
    static const unsigned strides[3] = {16, 4, 1};
    uint64_t all = UINT64_MAX;
    for (int a = 0; a < 3; a++) {
        const int64_t first = from[a] - REGION_EDGE * region[a], last = to[a] - REGION_EDGE * region[a];
        uint64_t some = 0;
        for (int64_t i = first > 0 ? first : 0; i <= last && i < REGION_EDGE; i++)
            some |= slices[a] << (strides[a] * (unsigned)i);
        all &= some;
    }
    return all;
}

static uint32_t cell_at(const pm__crowd_region *region, uint64_t bit)
{
    return region->first + (uint32_t)__builtin_popcountll(region->filled & (bit - 1));
}

/* ---- Hoods -------------------------------------------------------------------------------------- */

static pm_status enlarge_hood(pm__crowd_hood *hood, size_t wanted)
{
    size_t rooms[5] = {hood->room, hood->room, hood->room, hood->room, hood->room};
    for (int a = 0; a < 3; a++)
        if (pm__grow((void **)&hood->at[a], &rooms[a], wanted, sizeof *hood->at[a]))
            return PM_ENOMEM;
    if (pm__grow((void **)&hood->ids, &rooms[3], wanted, sizeof *hood->ids) ||
        pm__grow((void **)&hood->tags, &rooms[4], wanted, sizeof *hood->tags))
        return PM_ENOMEM;
    hood->room = rooms[4];
    return PM_OK;
}

static pm_status add_to_hood(const pm__crowd *crowd, const pm__crowd_cell *cell, pm__crowd_hood *hood)
{
    const size_t wanted = hood->count + cell->count + PM__CROWD_SPARE;
    uint32_t differ = 0;
    if (wanted > hood->room && enlarge_hood(hood, wanted))
        return PM_ENOMEM;
    for (uint32_t i = 0; i < cell->count; i += PM__CROWD_BLOCK) {
        const pm__crowd_block *const block = &crowd->blocks[cell->first + i / PM__CROWD_BLOCK];
        const size_t to = hood->count + i;
        for (int a = 0; a < 3; a++)
            memcpy(hood->at[a] + to, block->at[a], sizeof block->at[a]);
        memcpy(hood->ids + to, block->ids, sizeof block->ids);
        memcpy(hood->tags + to, block->tags, sizeof block->tags);
        for (uint32_t lane = 0; lane < PM__CROWD_BLOCK && i + lane < cell->count; lane++)
            differ |= block->tags[lane] ^ hood->tags[0];
    }
    hood->alike = hood->alike && !differ;
    hood->count += cell->count;
    return PM_OK;
}

/* Lanes beyond the last are far from everywhere. */
static void pad_hood(pm__crowd_hood *hood)
{
    for (size_t i = hood->count; i < hood->count + PM__CROWD_SPARE && hood->room; i++)
        hood->at[0][i] = hood->at[1][i] = hood->at[2][i] = INFINITY;
}

static pm_status gather_region(const pm__crowd *crowd, int level, const int64_t at[3], const int64_t from[3],
                               const int64_t to[3], pm__crowd_hood *hood)
{
    if (!crowd->table_size)
        return PM_OK;
    const pm__crowd_region *const region = &crowd->regions[find_region(crowd, key_of(at, level))];
    uint64_t left = region->filled & cells_between(at, from, to);
    for (; left; left &= left - 1)
        if (add_to_hood(crowd, &crowd->cells[cell_at(region, left & (0 - left))], hood))
            return PM_ENOMEM;
    return PM_OK;
}

pm_status pm__crowd_gather(const pm__crowd *crowd, const pm__crowd_place *place, const double low[3],
                           const double high[3], pm__crowd_hood *hood)
{
    const double inverse_edge = crowd->inverse_edge[place->level];
    int64_t from[3], to[3], low_region[3], high_region[3], at[3];
    hood->count = 0;
    hood->alike = true;
    for (int a = 0; a < 3; a++) {
        const int64_t first = coordinate(low[a], inverse_edge), last = coordinate(high[a], inverse_edge);
        from[a] = first < place->cell[a] - 1 ? place->cell[a] - 1 : first;
        to[a] = last > place->cell[a] + 1 ? place->cell[a] + 1 : last;
    }
    for (int a = 0; a < 3; a++) {
        low_region[a] = from[a] >> REGION_BITS;
        high_region[a] = to[a] >> REGION_BITS;
    }
    for (at[0] = low_region[0]; at[0] <= high_region[0]; at[0]++)
        for (at[1] = low_region[1]; at[1] <= high_region[1]; at[1]++)
            for (at[2] = low_region[2]; at[2] <= high_region[2]; at[2]++)
                if (gather_region(crowd, place->level, at, from, to, hood))
                    return PM_ENOMEM;
    pad_hood(hood);
    return PM_OK;
}

void pm__crowd_hood_free(pm__crowd_hood *hood)
{
    for (int a = 0; a < 3; a++)
        free(hood->at[a]);
    free(hood->ids);
    free(hood->tags);
}

pm_status pm__crowd_found_reserve(pm__crowd_found *found, const pm__crowd_hood *hood)
{
    const size_t wanted = hood->count + PM__CROWD_FEW + PM__CROWD_SPARE;
    size_t rooms[2] = {found->room, found->room};
    if (wanted <= found->room)
        return PM_OK;
    if (pm__grow((void **)&found->distance2, &rooms[0], wanted, sizeof *found->distance2) ||
        pm__grow((void **)&found->places, &rooms[1], wanted, sizeof *found->places))
        return PM_ENOMEM;
    found->room = rooms[0];
    return PM_OK;
}

void pm__crowd_found_free(pm__crowd_found *found)
{
    free(found->distance2);
    free(found->places);
}

/* ---- Growing ------------------------------------------------------------------------------------ */

/* Twice as large as the regions are many, at least. */
static pm_status enlarge_table(pm__crowd *crowd)
{
    const pm__crowd_region *const old = crowd->regions;
    const size_t before = crowd->table_size, size = before ? 2 * before : 1024;
    pm__crowd_region *const table = calloc(size, sizeof *table);
    if (!table)
        return PM_ENOMEM;
    crowd->regions = table;
    crowd->table_size = size;
    for (size_t i = 0; i < before; i++)
        if (old[i].key)
            table[find_region(crowd, old[i].key)] = old[i];
    free((void *)(uintptr_t)old);
    return PM_OK;
}

static pm_status find_or_add_region(pm__crowd *crowd, uint64_t key, pm__crowd_region **region)
{
    if (2 * (crowd->region_count + 1) > crowd->table_size && enlarge_table(crowd))
        return PM_ENOMEM;
    *region = &crowd->regions[find_region(crowd, key)];
    crowd->region_count += !(*region)->key;
    (*region)->key = key;
    return PM_OK;
}

/* Moves a region's cells to where there is room for twice as many. */
static pm_status enlarge_region(pm__crowd *crowd, pm__crowd_region *region)
{
    const uint32_t room = region->room ? 2 * region->room : 1;
    if (crowd->cell_count + room > UINT32_MAX ||
        (crowd->cell_count + room > crowd->cell_room &&
         pm__grow((void **)&crowd->cells, &crowd->cell_room, crowd->cell_count + room, sizeof *crowd->cells)))
        return PM_ENOMEM;
    if (region->room)
        memcpy(crowd->cells + crowd->cell_count, crowd->cells + region->first, region->room * sizeof *crowd->cells);
    region->first = (uint32_t)crowd->cell_count;
    region->room = room;
    crowd->cell_count += room;
    return PM_OK;
}

static pm_status find_or_add_cell(pm__crowd *crowd, pm__crowd_region *region, uint64_t bit, pm__crowd_cell **cell)
{
    const uint32_t filled = (uint32_t)__builtin_popcountll(region->filled);
    const bool is_new = !(region->filled & bit);
    if (is_new && filled == region->room && enlarge_region(crowd, region))
        return PM_ENOMEM;
    const uint32_t at = cell_at(region, bit);
    *cell = &crowd->cells[at];
    if (!is_new)
        return PM_OK;
    memmove(*cell + 1, *cell, (region->first + filled - at) * sizeof **cell);
    **cell = (pm__crowd_cell){0, 0, 0};
    region->filled |= bit;
    return PM_OK;
}

/* Moves a full cell to twice the room at the end; what it had before is given up. */
static pm_status enlarge_cell(pm__crowd *crowd, pm__crowd_cell *cell)
{
    const uint32_t room = cell->room ? 2 * cell->room : 1;
    if (crowd->used + room > UINT32_MAX)
        return PM_ENOMEM;
    if (crowd->used + room > crowd->room &&
        pm__grow((void **)&crowd->blocks, &crowd->room, crowd->used + room, sizeof *crowd->blocks))
        return PM_ENOMEM;
    if (cell->room)
        memcpy(crowd->blocks + crowd->used, crowd->blocks + cell->first, cell->room * sizeof *crowd->blocks);
    memset(crowd->blocks + crowd->used + cell->room, 0, (room - cell->room) * sizeof *crowd->blocks);
    cell->first = (uint32_t)crowd->used;
    cell->room = room;
    crowd->used += room;
    return PM_OK;
}

static size_t counter_of(const int64_t region[3], int level)
{
    return hash(key_of(region, level)) % COUNTERS;
}

/* In every region that has a cell next to it. */
static void count_fresh(pm__crowd *crowd, const pm__crowd_place *place)
{
    int64_t from[3], to[3], region[3];
    for (int a = 0; a < 3; a++) {
        from[a] = (place->cell[a] - 1) >> REGION_BITS;
        to[a] = (place->cell[a] + 1) >> REGION_BITS;
    }
    for (region[0] = from[0]; region[0] <= to[0]; region[0]++)
        for (region[1] = from[1]; region[1] <= to[1]; region[1]++)
            for (region[2] = from[2]; region[2] <= to[2]; region[2]++) {
                uint16_t *const counter = &crowd->fresh[counter_of(region, place->level)];
                *counter = (uint16_t)(*counter + (*counter < UINT16_MAX));
            }
}

unsigned pm__crowd_fresh(const pm__crowd *crowd, const pm__crowd_place *place)
{
    int64_t region[3];
    for (int a = 0; a < 3; a++)
        region[a] = place->cell[a] >> REGION_BITS;
    return crowd->fresh[counter_of(region, place->level)];
}

void pm__crowd_settle(pm__crowd *crowd)
{
    memset(crowd->fresh, 0, COUNTERS * sizeof *crowd->fresh);
}

static pm_status add_at(pm__crowd *crowd, const float position[3], int level, uint32_t id, uint32_t tag)
{
    const pm__crowd_place place = place_at(crowd, position, level);
    int64_t at[3];
    pm__crowd_region *region;
    pm__crowd_cell *cell;
    for (int a = 0; a < 3; a++)
        at[a] = place.cell[a] >> REGION_BITS;
    pm_status status = find_or_add_region(crowd, key_of(at, level), &region);
    if (status == PM_OK)
        status = find_or_add_cell(crowd, region, cells_between(at, place.cell, place.cell), &cell);
    if (status == PM_OK && cell->count == PM__CROWD_BLOCK * cell->room)
        status = enlarge_cell(crowd, cell);
    if (status != PM_OK)
        return status;
    const uint32_t lane = cell->count % PM__CROWD_BLOCK;
    pm__crowd_block *const block = &crowd->blocks[cell->first + cell->count++ / PM__CROWD_BLOCK];
    for (int a = 0; a < 3; a++)
        block->at[a][lane] = position[a];
    block->ids[lane] = id;
    block->tags[lane] = tag;
    count_fresh(crowd, &place);
    return PM_OK;
}

pm_status pm__crowd_add(pm__crowd *crowd, const float position[3], double reach, uint32_t id, uint32_t tag)
{
    double fill;
    const int level = level_of(crowd, reach, &fill);
    const pm_status status = add_at(crowd, position, level, id, tag);
    if (status != PM_OK || crowd->one_reach)
        return status;
    return add_at(crowd, position, fill > sqrt(0.5) ? level + 1 : level - 1, id, tag);
}

const pm__crowd_kernel *pm__crowd_choose(void)
{
#ifdef __x86_64__
    pm_simd simd;
    if (pm__choose_simd(PM_SIMD_AUTO, &simd, NULL) == PM_OK) {
        if (simd == PM_SIMD_AVX512)
            return &pm__crowd_avx512;
        if (simd == PM_SIMD_AVX2)
            return &pm__crowd_avx2;
    }
#endif
    return &pm__crowd_plain;
}
