/* The library is asked for neighbours: one by one, many at once, and handed over in blocks. */
#include "test.h"

#include "../search/search.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { AT_ONCE = 17 }; /* more than any search takes in one go */

typedef struct looking {
    const pm__hood *hood;
    const pm_map *map;
    pm_query query;
    const pm__nears *due;
    pm_neighbor *found;
    size_t room, count;
    pm__worst *worst;
    char what[120];
} looking;

/* Float's own error of squares and sums where the set is on no lattice: stress.h. */
static void compare(const looking *l)
{
    const bool rounds = l->hood->rounds;
    const long double unit = (long double)pm_map_unit(l->map);
    l->worst->lookups++;
    const bool beyond = l->hood->coarse && (l->due->r2 < 0x1p-116L * unit * unit || l->due->r2 > 1e35L * unit * unit);
    if (beyond && l->due->count) { /* squares that float cannot hold */
        pm__worst_take(l->worst, 0.0, 0.0, "float ulp", l->what);
        return;
    }
    if (rounds && !(l->due->gap > 64 * 0x1p-24L)) {
        l->worst->unclear++;
        return;
    }
    if (l->count != l->due->count) {
        pm__worst_fail(l->worst, "%zu photons where %zu were due: %s", l->count, l->due->count, l->what);
        return;
    }
    pm__worst_take(l->worst, 0.0, rounds ? 5.0 : 0.0, "float ulp", l->what);
    for (size_t i = 0; i < l->count; i++) {
        const long double d2 = (long double)l->found[i].distance2 * unit * unit, want = l->due->near[i].d2;
        const uint32_t source = pm_map_source(l->map, l->found[i].number);
        if (source != l->due->near[i].index) {
            pm__worst_fail(l->worst, "number %zu is photon %u, not %u: %s", i, (unsigned)source,
                           (unsigned)l->due->near[i].index, l->what);
            return;
        }
        pm__worst_take(l->worst, pm__ulps(d2, want, want, 24), rounds ? 5.0 : 0.0, "float ulp", l->what);
    }
}

/* The same query many times over, and between them others, gives each time what it gives alone. */
static void compare_batch(const looking *l, pm_neighbor *many)
{
    pm_query queries[AT_ONCE];
    size_t counts[AT_ONCE];
    for (int i = 0; i < AT_ONCE; i++) {
        queries[i] = l->query;
        if (i % 3 == 1)
            queries[i].position[i % 2] = -l->query.position[i % 2];
    }
    const pm_status status = pm_map_search_batch(l->map, queries, AT_ONCE, many, l->room, counts);
    if (status != PM_OK)
        pm__worst_fail(l->worst, "many at once: status %d: %s", (int)status, l->what);
    for (int i = 0; i < AT_ONCE && status == PM_OK; i++)
        if (i % 3 != 1 && (counts[i] != l->count || memcmp(many + (size_t)i * l->room, l->found,
                                                           l->count * sizeof *l->found) != 0))
            pm__worst_fail(l->worst, "many at once find others than one alone: %s", l->what);
}

static bool count_them(void *context, const pm_neighbor *neighbors, size_t count)
{
    (void)neighbors;
    *(size_t *)context += count;
    return true;
}

static void compare_blocks(const looking *l)
{
    size_t count = 0;
    const pm_status status = pm_map_search_each(l->map, &l->query, count_them, &count);
    if (status != PM_OK || (count != l->count && !(l->hood->rounds)))
        pm__worst_fail(l->worst, "in blocks: status %d, %zu photons, not %zu: %s", (int)status, count, l->count,
                       l->what);
}

static void search_form(looking *l, int form, const pm__nears *due, pm_neighbor *many)
{
    l->due = due;
    l->query = pm__form_query(l->hood, form);
    (void)snprintf(l->what, sizeof l->what, "%s, %s", l->hood->what, pm__form_names[form]);
    const pm_status status = pm_map_search(l->map, &l->query, l->found, l->room, &l->count);
    if (status != PM_OK) {
        pm__worst_fail(l->worst, "status %d: %s", (int)status, l->what);
        return;
    }
    compare(l);
    compare_batch(l, many);
    if (form == PM__BY_RADIUS)
        compare_blocks(l);
}

static pm_status search_subject(const pm__asking *asking, const pm__nears *dues, size_t search, size_t width,
                                pm_neighbor *found, pm_neighbor *many)
{
    const pm_map_options options = {.search = asking->searches[search], .simd = asking->widths->width[width]};
    pm_map *map = NULL;
    pm_error error = {""};
    pm__worst *const worst = &asking->worst[search * asking->widths->count + width];
    pm_status status = pm_map_create(asking->hood->photons, asking->hood->count, &options, &map, NULL);
    if (status != PM_OK)
        return status;
    status = pm_map_check(map, &error);
    if (status == PM_ENOMEM) {
        pm_map_destroy(map);
        return status;
    }
    if (status != PM_OK)
        pm__worst_fail(worst, "%.120s: %s", error.text, asking->hood->what);
    looking l = {.hood = asking->hood, .map = map, .found = found, .room = asking->hood->count + 1, .worst = worst};
    for (int form = 0; form < PM__FORMS; form++)
        if (pm__form_fits(asking->searches[search], form))
            search_form(&l, form, &dues[form], many);
    pm_map_destroy(map);
    return PM_OK;
}

pm_status pm__stress_search(const pm__asking *asking)
{
    const pm__hood *const hood = asking->hood;
    const size_t room = hood->count + 1;
    pm__nears dues[PM__FORMS];
    pm__near *const near = calloc(PM__FORMS * room, sizeof *near);
    pm_neighbor *const found = calloc(room, sizeof *found), *const many = calloc(AT_ONCE * room, sizeof *many);
    pm_status status = near && found && many ? PM_OK : PM_ENOMEM;
    for (int form = 0; form < PM__FORMS && status == PM_OK; form++) {
        const pm_query query = pm__form_query(hood, form);
        dues[form].near = near + (size_t)form * room;
        pm__judge_find(hood->photons, hood->count, &query, query.k, 0, 1, &dues[form]);
    }
    for (size_t i = 0; i < asking->search_count; i++)
        for (size_t w = 0; w < asking->widths->count && status == PM_OK; w++)
            status = search_subject(asking, dues, i, w, found, many);
    free(near);
    free(found);
    free(many);
    return status;
}
