/* Any bytes as a PLY file: a status, a sentence, and finite numbers where it is read. */
#include "../../src/photonmap.h"
#include "fuzz.h"

#include <math.h>

static void check_status(pm_status status, const pm_error *error)
{
    FUZZ_CHECK(status == PM_OK || status == PM_EFORMAT || status == PM_ENONFINITE || status == PM_ENOMEM, error->text);
    FUZZ_CHECK(status == PM_OK || strlen(error->text) > 10, "no sentence");
}

static void read_photons(const char *path)
{
    pm_photon *photons = NULL;
    float(*normals)[3] = NULL;
    size_t count = 0;
    pm_error error = {""};
    const pm_status status = pm_ply_read_photons(path, &photons, &normals, &count, &error);
    check_status(status, &error);
    FUZZ_CHECK(status == PM_OK || (!count && !photons && !normals), "photons after an error");
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            FUZZ_CHECK(isfinite(photons[i].position[a]) && isfinite(photons[i].direction[a]) &&
                           isfinite(photons[i].power[a]),
                       "not finite");
    pm_free(photons);
    pm_free(normals);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char name[40];
    int file;
    const char *const path = as_file(data, size, &file, name);
    read_photons(path);
    pm_surface_point *points = NULL;
    size_t count = 0;
    pm_error error = {""};
    const pm_status status = pm_ply_read_points(path, &points, &count, &error);
    check_status(status, &error);
    FUZZ_CHECK(status == PM_OK || (!count && !points), "points after an error");
    pm_free(points);
    (void)close(file);
    return 0;
}
