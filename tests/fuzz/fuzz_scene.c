/* Any text as a scene with its parameters: a status and a sentence, or a scene whose rays meet surfaces at finite
 * places with unit normals. (The program reads scenes from nowhere else.) */
#include "../../cases/scenes/list.h"
#include "../../src/base/vec3.h"
#include "../../src/methods/stage.h"
#include "fuzz.h"

#include <math.h>

enum { TEXT = 200, RAYS = 40 };

static void check_rays(const pm__stage *stage, size_t seed)
{
    for (size_t i = 0; i < RAYS; i++) {
        const double z = 1.0 - 2.0 * ((double)i + 0.5) / RAYS, angle = 2.4 * (double)(i + seed), r = sqrt(1.0 - z * z);
        const double direction[3] = {r * cos(angle), r * sin(angle), z};
        pm__hit hit;
        if (!pm__scene_intersect(stage->scene, stage->camera.eye, direction, INFINITY, PM__NO_SHAPE, &hit))
            continue;
        FUZZ_CHECK(hit.distance >= 0.0 && isfinite(hit.distance), "distance");
        FUZZ_CHECK(isfinite(hit.position[0]) && isfinite(hit.position[1]) && isfinite(hit.position[2]), "position");
        FUZZ_CHECK(fabs(pm__dot(hit.normal, hit.normal) - 1.0) < 1e-9, "normal");
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char text[TEXT + 10] = "scene:";
    pm__spec spec;
    pm__stage stage;
    pm_error error = {""};
    const size_t length = size < TEXT ? size : TEXT;
    memcpy(text + 6, data, length);
    text[6 + length] = '\0';
    pm_status status = pm__spec_parse(&pm__scene_cases, text, &spec, &error);
    if (status == PM_OK)
        status = pm__stage_open(&spec, NULL, 8, 8, &stage, &error);
    else
        FUZZ_CHECK(*error.text, "no sentence");
    if (status != PM_OK) {
        FUZZ_CHECK(*error.text, "no sentence");
        return 0;
    }
    check_rays(&stage, length);
    pm__stage_close(&stage);
    return 0;
}
