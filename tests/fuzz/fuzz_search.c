/* Any bytes as photons and a query, by every search with one width or another. By the first byte's lowest bit: photons
 * on a lattice, held against the judge of `stress`; or floats of any bits, where all find what brute force does. */
#include "../../src/search/search.h"
#include "../../src/stress/test.h"
#include "fuzz.h"

enum { MOST = 300 };

static pm_photon photons[PM__HOOD_MOST];

static void on_lattice(bytes *b)
{
    const pm_search *searches[16];
    pm__stress_widths widths;
    pm__hood hood = {.photons = photons};
    pm__dice dice = {.seed = 1};
    pm__worst worst[16];
    FUZZ_CHECK(pm__stress_widths_here(&widths, NULL) == PM_OK, "no width");
    widths.width[0] = widths.width[take_byte(b) % widths.count];
    widths.count = 1;
    for (size_t i = 0; i < pm__searches.count; i++)
        searches[i] = (const pm_search *)(const void *)pm__searches.entries[i];
    pm__hood_clear(&hood);
    hood.query.k = 1 + take_byte(b);
    hood.query.max_radius = (float)take_byte(b) / PM__HOOD_STEPS;
    hood.query.front_only = take_byte(b) & 1;
    for (int a = 0; a < 3; a++)
        hood.query.position[a] = (float)take_signed(b) / PM__HOOD_STEPS;
    while (b->left && hood.count < MOST) {
        const int x = take_signed(b), y = take_signed(b);
        pm__hood_add(&hood, &dice, x, y, take_signed(b));
    }
    memset(worst, 0, sizeof worst);
    const pm__asking asking = {.hood = &hood, .searches = searches, .search_count = pm__searches.count,
                               .widths = &widths, .worst = worst};
    FUZZ_CHECK(pm__stress_search(&asking) == PM_OK, "a search");
    for (size_t i = 0; i < pm__searches.count; i++)
        FUZZ_CHECK(!worst[i].failed && worst[i].measured <= worst[i].bound, worst[i].detail);
}

/* Finds by one search into `found`; the status. */
static pm_status find(const pm_search *search, size_t count, const pm_query *query, pm_neighbor *found, size_t *hits,
                      uint32_t *sources)
{
    const pm_map_options options = {.search = search};
    pm_map *map = NULL;
    pm_error error = {""};
    pm_status status = pm_map_create(photons, count, &options, &map, &error);
    if (status != PM_OK)
        return status;
    FUZZ_CHECK(pm_map_check(map, &error) == PM_OK, error.text);
    status = pm_map_search(map, query, found, MOST + 1, hits);
    for (size_t i = 0; i < *hits && status == PM_OK; i++)
        sources[i] = pm_map_source(map, found[i].number);
    pm_map_destroy(map);
    return status;
}

static void with_any_bits(bytes *b)
{
    static pm_neighbor found[MOST + 1], due[MOST + 1];
    static uint32_t sources[MOST + 1], due_sources[MOST + 1];
    pm_query query;
    size_t count = 0, hits = 0, due_hits = 0;
    pm_query_init(&query);
    query.k = take_byte(b);
    query.shape = (pm_lookup_shape)(take_byte(b) % 4);
    query.front_only = take_byte(b) & 1;
    query.max_radius = take_float(b);
    query.shape_parameter = take_float(b);
    for (int a = 0; a < 3; a++) {
        query.position[a] = take_float(b);
        query.normal[a] = take_float(b);
    }
    for (; b->left && count < MOST; count++) {
        photons[count] = (pm_photon){.direction = {0.0f, 0.0f, take_byte(b) & 1 ? -1.0f : 1.0f}, .power = {1, 1, 1}};
        for (int a = 0; a < 3; a++)
            photons[count].position[a] = take_float(b);
    }
    const pm_status status = find(pm_search_find("brute"), count, &query, due, &due_hits, due_sources);
    for (size_t i = 0; i < pm__searches.count; i++) {
        const pm_search *const search = (const pm_search *)(const void *)pm__searches.entries[i];
        if (search->radius_only && query.k)
            continue;
        FUZZ_CHECK(find(search, count, &query, found, &hits, sources) == status, search->entry.name);
        FUZZ_CHECK(status != PM_OK || (hits == due_hits && !memcmp(sources, due_sources, hits * sizeof *sources)),
                   search->entry.name);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes b = {data, size};
    if (take_byte(&b) & 1)
        on_lattice(&b);
    else
        with_any_bits(&b);
    return 0;
}
