#include "reference.h"

#include "embed.h"
#include "references.h"

#include <stdint.h>

#define FOLDER "cases/scenes/references/"
#define X(name)                                                   \
    PM__EMBED(pm__reference_##name, FOLDER #name ".exr");         \
    PM__EMBED(pm__reference_error_##name, FOLDER #name ".error.exr");
PM__REFERENCE_LIST(X)
#undef X

const pm__reference_row pm__references[] = {
#define X(name)                                                                                \
    {#name, pm__reference_##name, pm__reference_##name##_end, pm__reference_error_##name,      \
     pm__reference_error_##name##_end},
    PM__REFERENCE_LIST(X)
#undef X
    {0},
};

/* Rows are C names, which hold no -. */
static bool same_scene(const char *row, const char *scene)
{
    for (; *row && (*row == *scene || (*row == '_' && *scene == '-')); row++)
        scene++;
    return *row == *scene;
}

static const pm__reference_row *find(const pm__reference_row *table, const char *scene)
{
    for (; table->scene; table++)
        if (same_scene(table->scene, scene))
            return table;
    return NULL;
}

/* Not a difference of pointers: to the language the two are of different arrays. */
static size_t bytes_between(const unsigned char *start, const unsigned char *end)
{
    return (size_t)((uintptr_t)end - (uintptr_t)start);
}

bool pm__reference_exists(const char *scene)
{
    return find(pm__references, scene) != NULL;
}

pm_status pm__reference_load_from(const pm__reference_row *table, const char *scene, pm__reference *reference,
                                  pm_error *error)
{
    *reference = (pm__reference){0};
    const pm__reference_row *const row = find(table, scene);
    if (!row)
        return pm__fail(error, PM_ENAME, "no reference is stored of scene \"%.40s\"", scene);
    char name[64];
    (void)snprintf(name, sizeof name, "the reference of %.40s", scene);
    pm_status status = pm__exr_read_memory(row->radiance, bytes_between(row->radiance, row->radiance_end), name,
                                           &reference->radiance, error);
    if (status == PM_OK)
        status = pm__exr_read_memory(row->error, bytes_between(row->error, row->error_end), name, &reference->error,
                                     error);
    const pm__image *const a = &reference->radiance, *const b = &reference->error;
    if (status == PM_OK && a->channels != 3)
        status = pm__fail(error, PM_EFORMAT, "%s: expected channels R, G and B, found Y", name);
    if (status == PM_OK && (a->width != b->width || a->height != b->height || a->channels != b->channels))
        status = pm__fail(error, PM_EFORMAT, "%s: expected an image of errors of %zu x %zu, found one of %zu x %zu",
                          name, a->width, a->height, b->width, b->height);
    if (status != PM_OK)
        pm__reference_free(reference);
    return status;
}

pm_status pm__reference_load(const char *scene, pm__reference *reference, pm_error *error)
{
    return pm__reference_load_from(pm__references, scene, reference, error);
}

void pm__reference_free(pm__reference *reference)
{
    pm__image_free(&reference->radiance);
    pm__image_free(&reference->error);
}
