/* Any bytes as photons on a lattice with powers of any size and sign, an estimator and a query: held against the judge
 * of `stress`, within its bound. */
#include "../../estimators/estimator.h"
#include "../../src/search/search.h"
#include "../../src/stress/test.h"
#include "fuzz.h"

#include <math.h>

enum { MOST = 120 };

static const char *const specs[] = {"disc", "disc:last=none", "cone", "cone:k=0.5", "gaussian:form=normalised",
                                    "epanechnikov", "biweight:last=half", "differential:start=4,trend=3",
                                    "differential:rule=significance,start=5,z=1", "hull",
                                    "hull:boundary=0,outside=zero", "combined:maps=2", "combined:rule=mean,maps=3",
                                    "precomputed",
                                    "precomputed:form=unbiased,fraction=1,when=demand", "oracle"};

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    static pm_photon photons[PM__HOOD_MOST];
    bytes b = {data, size};
    pm__hood hood = {.photons = photons, .what = "the input"};
    pm__dice dice = {.seed = 1};
    pm__spec spec;
    pm__worst worst = {.lookups = 0};
    const pm_search *const searches[] = {pm_search_find("wide")};
    const pm__stress_widths widths = {.width = {PM_SIMD_V2}, .count = 1};
    FUZZ_CHECK(pm__spec_parse(&pm__estimators, specs[take_byte(&b) % (sizeof specs / sizeof *specs)], &spec, NULL) ==
                   PM_OK,
               "a spec");
    pm__hood_clear(&hood);
    (void)snprintf(hood.what, sizeof hood.what, "the input");
    hood.query.k = 1 + take_byte(&b) % 80;
    hood.query.max_radius = (float)take_byte(&b) / PM__HOOD_STEPS;
    hood.query.normal[take_byte(&b) % 3] = 0.0f;
    hood.query.position[0] = (float)take_signed(&b) / PM__HOOD_STEPS;
    if (hood.query.normal[2] == 0.0f)
        hood.query.normal[1] = -1.0f;
    while (b.left && hood.count < MOST) {
        const int x = take_signed(&b), y = take_signed(&b), z = take_signed(&b);
        pm__hood_add(&hood, &dice, x, y, z);
        const int power = take_signed(&b);
        for (int c = 0; c < 3; c++)
            photons[hood.count - 1].power[c] = power % 3 ? ldexpf((float)power, power % 50) : (float)(power / 3);
    }
    const pm__asking asking = {.hood = &hood, .spec = &spec, .searches = searches, .search_count = 1,
                               .widths = &widths, .worst = &worst};
    FUZZ_CHECK(pm__stress_ask(&asking) == PM_OK, "an estimate");
    FUZZ_CHECK(!worst.failed && (!worst.unit || worst.measured <= worst.bound), worst.detail);
    return 0;
}
