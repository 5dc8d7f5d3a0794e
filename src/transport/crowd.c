#include "crowd.h"

#include "../base/memory.h"
#include "../search/wide.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NO_CELL UINT32_MAX

/* Slots of a cell's first room, bits of a cell's coordinate in its key. Coordinates
 * wrap: cells that share a key are far apart, and a photon's distance tells. */
enum { FIRST_ROOM = 4, BITS = 18 };

/* Counters of fresh photons; cells of a block's edge, as bits. */
enum { COUNTERS = 1 << 14, BLOCK_BITS = 2 };

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
    free(crowd->table);
    for (int a = 0; a < 3; a++)
        free(crowd->at[a]);
    free(crowd->ids);
    free(crowd->tags);
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

static uint32_t find_cell(const pm__crowd *crowd, uint64_t key)
{
    if (!crowd->table_size)
        return NO_CELL;
    for (size_t i = hash(key);; i++) {
        const uint32_t cell = crowd->table[i & (crowd->table_size - 1)];
        if (cell == NO_CELL || crowd->cells[cell].key == key)
            return cell;
    }
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

/* Of so few words a call would be most of the cost: by fours, to where there is room for more than are wanted. */
static inline void copy(void *to, const void *from, uint32_t count)
{
    for (uint32_t i = 0; i < count; i += 4)
        memcpy((char *)to + 4 * (size_t)i, (const char *)from + 4 * (size_t)i, 16);
}

static pm_status add_to_hood(const pm__crowd *crowd, const pm__crowd_cell *cell, pm__crowd_hood *hood)
{
    const size_t wanted = hood->count + cell->count + PM__CROWD_SPARE;
    if (wanted > hood->room && enlarge_hood(hood, wanted))
        return PM_ENOMEM;
    for (int a = 0; a < 3; a++)
        copy(hood->at[a] + hood->count, crowd->at[a] + cell->first, cell->count);
    copy(hood->ids + hood->count, crowd->ids + cell->first, cell->count);
    copy(hood->tags + hood->count, crowd->tags + cell->first, cell->count);
    uint32_t differ = 0;
    for (uint32_t i = 0; i < cell->count; i++)
        differ |= hood->tags[hood->count + i] ^ hood->tags[0];
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

pm_status pm__crowd_gather(const pm__crowd *crowd, const pm__crowd_place *place, const double low[3],
                           const double high[3], pm__crowd_hood *hood)
{
    const double inverse_edge = crowd->inverse_edge[place->level];
    int64_t from[3], to[3], cell[3];
    hood->count = 0;
    hood->alike = true;
    for (int a = 0; a < 3; a++) {
        const int64_t first = coordinate(low[a], inverse_edge), last = coordinate(high[a], inverse_edge);
        from[a] = first < place->cell[a] - 1 ? place->cell[a] - 1 : first;
        to[a] = last > place->cell[a] + 1 ? place->cell[a] + 1 : last;
    }
    for (cell[0] = from[0]; cell[0] <= to[0]; cell[0]++)
        for (cell[1] = from[1]; cell[1] <= to[1]; cell[1]++)
            for (cell[2] = from[2]; cell[2] <= to[2]; cell[2]++) {
                const uint32_t found = find_cell(crowd, key_of(cell, place->level));
                if (found != NO_CELL && add_to_hood(crowd, &crowd->cells[found], hood))
                    return PM_ENOMEM;
            }
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

static void enter(pm__crowd *crowd, uint32_t cell)
{
    size_t i = hash(crowd->cells[cell].key);
    while (crowd->table[i & (crowd->table_size - 1)] != NO_CELL)
        i++;
    crowd->table[i & (crowd->table_size - 1)] = cell;
}

/* Twice as large as the cells are many, at least. */
static pm_status enlarge_table(pm__crowd *crowd)
{
    const size_t size = crowd->table_size ? 2 * crowd->table_size : 1024;
    uint32_t *const table = malloc(size * sizeof *table);
    if (!table)
        return PM_ENOMEM;
    free(crowd->table);
    crowd->table = table;
    crowd->table_size = size;
    memset(table, 0xff, size * sizeof *table);
    for (size_t i = 0; i < crowd->cell_count; i++)
        enter(crowd, (uint32_t)i);
    return PM_OK;
}

static pm_status add_cell(pm__crowd *crowd, uint64_t key, uint32_t *cell)
{
    if (2 * (crowd->cell_count + 1) > crowd->table_size && enlarge_table(crowd))
        return PM_ENOMEM;
    if (crowd->cell_count == NO_CELL ||
        pm__grow((void **)&crowd->cells, &crowd->cell_room, crowd->cell_count + 1, sizeof *crowd->cells))
        return PM_ENOMEM;
    *cell = (uint32_t)crowd->cell_count++;
    crowd->cells[*cell] = (pm__crowd_cell){.key = key};
    enter(crowd, *cell);
    return PM_OK;
}

static pm_status reserve_slots(pm__crowd *crowd, size_t more)
{
    const size_t wanted = crowd->used + more + FIRST_ROOM; /* may be read beyond */
    size_t rooms[5] = {crowd->room, crowd->room, crowd->room, crowd->room, crowd->room};
    if (wanted > UINT32_MAX)
        return PM_ENOMEM;
    for (int a = 0; a < 3; a++)
        if (pm__grow((void **)&crowd->at[a], &rooms[a], wanted, sizeof *crowd->at[a]))
            return PM_ENOMEM;
    if (pm__grow((void **)&crowd->ids, &rooms[3], wanted, sizeof *crowd->ids) ||
        pm__grow((void **)&crowd->tags, &rooms[4], wanted, sizeof *crowd->tags))
        return PM_ENOMEM;
    crowd->room = rooms[3];
    return PM_OK;
}

/* Moves a full cell to twice the room at the end; what it had before is given up. */
static pm_status enlarge_cell(pm__crowd *crowd, pm__crowd_cell *cell)
{
    const uint32_t room = cell->room ? 2 * cell->room : FIRST_ROOM;
    const pm_status status = reserve_slots(crowd, room);
    if (status != PM_OK)
        return status;
    for (int a = 0; a < 3 && cell->count; a++)
        memcpy(crowd->at[a] + crowd->used, crowd->at[a] + cell->first, cell->count * sizeof *crowd->at[a]);
    if (cell->count) {
        memcpy(crowd->ids + crowd->used, crowd->ids + cell->first, cell->count * sizeof *crowd->ids);
        memcpy(crowd->tags + crowd->used, crowd->tags + cell->first, cell->count * sizeof *crowd->tags);
    }
    cell->first = (uint32_t)crowd->used;
    cell->room = room;
    crowd->used += room;
    return PM_OK;
}

static size_t counter_of(const int64_t block[3], int level)
{
    return hash(key_of(block, level)) % COUNTERS;
}

/* In every block that has a cell next to it. */
static void count_fresh(pm__crowd *crowd, const pm__crowd_place *place)
{
    int64_t from[3], to[3], block[3];
    for (int a = 0; a < 3; a++) {
        from[a] = (place->cell[a] - 1) >> BLOCK_BITS;
        to[a] = (place->cell[a] + 1) >> BLOCK_BITS;
    }
    for (block[0] = from[0]; block[0] <= to[0]; block[0]++)
        for (block[1] = from[1]; block[1] <= to[1]; block[1]++)
            for (block[2] = from[2]; block[2] <= to[2]; block[2]++) {
                uint16_t *const counter = &crowd->fresh[counter_of(block, place->level)];
                *counter = (uint16_t)(*counter + (*counter < UINT16_MAX));
            }
}

unsigned pm__crowd_fresh(const pm__crowd *crowd, const pm__crowd_place *place)
{
    int64_t block[3];
    for (int a = 0; a < 3; a++)
        block[a] = place->cell[a] >> BLOCK_BITS;
    return crowd->fresh[counter_of(block, place->level)];
}

void pm__crowd_settle(pm__crowd *crowd)
{
    memset(crowd->fresh, 0, COUNTERS * sizeof *crowd->fresh);
}

static pm_status add_at(pm__crowd *crowd, const float position[3], int level, uint32_t id, uint32_t tag)
{
    const pm__crowd_place place = place_at(crowd, position, level);
    uint32_t number = find_cell(crowd, place.key);
    pm_status status = number == NO_CELL ? add_cell(crowd, place.key, &number) : PM_OK;
    if (status != PM_OK)
        return status;
    pm__crowd_cell *const cell = &crowd->cells[number];
    if (cell->count == cell->room)
        status = enlarge_cell(crowd, cell);
    if (status != PM_OK)
        return status;
    const size_t slot = cell->first + cell->count++;
    for (int a = 0; a < 3; a++)
        crowd->at[a][slot] = position[a];
    crowd->ids[slot] = id;
    crowd->tags[slot] = tag;
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
