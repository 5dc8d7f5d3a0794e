/* Photons and query points from PLY files, and photons into one. */
#include "../base/memory.h"
#include "../base/output.h"
#include "../base/vec3.h"
#include "ply_reader.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FIRST_CAPACITY = 4096 };

/* ---- Reading ------------------------------------------------------------------------------------ */

/* Where the vertices go: one array, or two that grow together. */
typedef struct table {
    const pm__ply_budget *budget; /* or NULL */
    void *columns[2];
    size_t sizes[2]; /* of an entry; 0: there is no such array */
    size_t capacities[2];
    pm_status (*store)(const struct table *table, const pm__ply *ply, const double *values, size_t i, pm_error *error);
} table;

static const pm__ply_field photon_fields[] = {
    {"x", NULL},    {"y", NULL},    {"z", NULL},    {"dx", NULL}, {"dy", NULL}, {"dz", NULL},
    {"r", "power_r"}, {"g", "power_g"}, {"b", "power_b"}, {"nx", NULL}, {"ny", NULL}, {"nz", NULL},
};
static const pm__ply_field point_fields[] = {
    {"x", NULL}, {"y", NULL}, {"z", NULL}, {"nx", NULL}, {"ny", NULL}, {"nz", NULL},
};
enum { PHOTON_FIELDS = 9, NORMAL_FIELDS = 3, POINT_FIELDS = 6 };

static void to_float(const double from[3], float to[3])
{
    for (int i = 0; i < 3; i++)
        to[i] = (float)from[i];
}

static pm_status bad_length(const pm__ply *ply, const char *what, double length, size_t i, pm_error *error)
{
    char place[PM__PLY_PLACE];
    pm__ply_vertex_place(ply, place);
    return pm__fail(error, PM_EFORMAT, "%s: expected %s of vertex %zu, found one of length %g", place, what, i, length);
}

static pm_status store_direction(const pm__ply *ply, const double values[3], float direction[3], size_t i,
                                 pm_error *error)
{
    double v[3] = {values[0], values[1], values[2]};
    const double length = pm__normalize(v);
    if (!(fabs(length - 1.0) <= 0.01))
        return bad_length(ply, "a direction dx dy dz of length 1", length, i, error);
    /* What is already unit but for the rounding to float stays, so that photons written come back the same. */
    to_float(fabs(length - 1.0) < 0x1p-23 ? values : v, direction);
    return PM_OK;
}

static pm_status store_normal(const pm__ply *ply, const double values[3], float normal[3], size_t i, pm_error *error)
{
    double v[3] = {values[0], values[1], values[2]};
    const double length = pm__normalize(v);
    if (!(length > 0.0))
        return bad_length(ply, "a normal nx ny nz that is not zero", length, i, error);
    to_float(fabs(length - 1.0) < 0x1p-23 ? values : v, normal);
    return PM_OK;
}

static pm_status store_photon(const table *t, const pm__ply *ply, const double *values, size_t i, pm_error *error)
{
    pm_photon *const photon = (pm_photon *)t->columns[0] + i;
    to_float(values, photon->position);
    to_float(values + 6, photon->power);
    pm_status status = store_direction(ply, values + 3, photon->direction, i, error);
    if (status == PM_OK && t->sizes[1])
        status = store_normal(ply, values + PHOTON_FIELDS, ((float(*)[3])t->columns[1])[i], i, error);
    return status;
}

static pm_status store_point(const table *t, const pm__ply *ply, const double *values, size_t i, pm_error *error)
{
    pm_surface_point *const point = (pm_surface_point *)t->columns[0] + i;
    to_float(values, point->position);
    return store_normal(ply, values + 3, point->normal, i, error);
}

/* A system that promises more memory than it has kills who takes it at its word: so ask first. */
static pm_status check_budget(const table *t, const pm__ply *ply, size_t wanted, pm_error *error)
{
    const double arrays = (double)(t->sizes[0] + t->sizes[1]);
    if (!t->budget || !(t->budget->memory > 0.0))
        return PM_OK;
    const double needed = (double)wanted * (arrays + t->budget->per_vertex);
    if (needed <= t->budget->memory)
        return PM_OK;
    return pm__fail(error, PM_ENOMEM, "%s: %zu of %" PRIu64 " vertices take %.3g GB of memory; %.3g GB are free",
                    ply->input.name, wanted, ply->vertex->count, 1e-9 * needed, 1e-9 * t->budget->memory);
}

static pm_status reserve(table *t, const pm__ply *ply, size_t wanted, pm_error *error)
{
    const pm_status status = check_budget(t, ply, wanted, error);
    if (status != PM_OK)
        return status;
    for (int c = 0; c < 2; c++)
        if (t->sizes[c] && pm__grow(&t->columns[c], &t->capacities[c], wanted, t->sizes[c]) != 0)
            return pm__fail(error, PM_ENOMEM, "%s: no memory for %" PRIu64 " vertices", ply->input.name,
                            ply->vertex->count);
    return PM_OK;
}

/* A count that the file's size has confirmed is allocated at once; any other as the data come. At least one entry,
 * so that an array of none is a pointer too. */
static pm_status read_table(pm__ply *ply, table *t, pm_error *error)
{
    const size_t count = (size_t)ply->vertex->count;
    const bool confirmed = pm__ply_remaining(&ply->input) != UINT64_MAX;
    const size_t first = confirmed || count < FIRST_CAPACITY ? count : FIRST_CAPACITY;
    pm_status status = reserve(t, ply, first ? first : 1, error);
    for (size_t i = 0; status == PM_OK && i < count; i++) {
        double values[PM__PLY_FIELDS];
        status = pm__ply_next(ply, values, error);
        if (status == PM_OK && i >= t->capacities[0])
            status = reserve(t, ply, i + 1, error);
        if (status == PM_OK)
            status = t->store(t, ply, values, i, error);
    }
    for (int c = 0; status != PM_OK && c < 2; c++) {
        free(t->columns[c]);
        t->columns[c] = NULL;
    }
    return status;
}

static bool has_normals(const pm__ply *ply)
{
    return pm__ply_has(ply, "nx") || pm__ply_has(ply, "ny") || pm__ply_has(ply, "nz");
}

pm_status pm_ply_read_photons(const char *path, pm_photon **photons, float (**normals)[3], size_t *count,
                              pm_error *error)
{
    return pm__ply_read_photons(path, NULL, photons, normals, count, error);
}

pm_status pm__ply_read_photons(const char *path, const pm__ply_budget *budget, pm_photon **photons,
                               float (**normals)[3], size_t *count, pm_error *error)
{
    if (normals)
        *normals = NULL;
    if (photons)
        *photons = NULL;
    if (count)
        *count = 0;
    if (!path || !photons || !count)
        return pm__fail(error, PM_EINVAL, "reading photons needs a path and somewhere to put them");
    pm__ply ply;
    pm_status status = pm__ply_open(path, &ply, error);
    if (status != PM_OK)
        return status;
    const bool with_normals = normals && has_normals(&ply);
    table t = {.budget = budget,
               .sizes = {sizeof(pm_photon), with_normals ? sizeof(float[3]) : 0},
               .store = store_photon};
    status = pm__ply_start(&ply, photon_fields, PHOTON_FIELDS + (with_normals ? NORMAL_FIELDS : 0), error);
    if (status == PM_OK)
        status = read_table(&ply, &t, error);
    pm__ply_close(&ply);
    if (status != PM_OK)
        return status;
    *photons = t.columns[0];
    *count = (size_t)ply.vertex->count;
    if (normals)
        *normals = t.columns[1];
    return PM_OK;
}

pm_status pm_ply_read_points(const char *path, pm_surface_point **points, size_t *count, pm_error *error)
{
    return pm__ply_read_points(path, NULL, points, count, error);
}

pm_status pm__ply_read_points(const char *path, const pm__ply_budget *budget, pm_surface_point **points, size_t *count,
                              pm_error *error)
{
    if (points)
        *points = NULL;
    if (count)
        *count = 0;
    if (!path || !points || !count)
        return pm__fail(error, PM_EINVAL, "reading points needs a path and somewhere to put them");
    pm__ply ply;
    pm_status status = pm__ply_open(path, &ply, error);
    if (status != PM_OK)
        return status;
    table t = {.budget = budget, .sizes = {sizeof(pm_surface_point), 0}, .store = store_point};
    status = pm__ply_start(&ply, point_fields, POINT_FIELDS, error);
    if (status == PM_OK)
        status = read_table(&ply, &t, error);
    pm__ply_close(&ply);
    if (status != PM_OK)
        return status;
    *points = t.columns[0];
    *count = (size_t)ply.vertex->count;
    return PM_OK;
}

/* ---- Writing ------------------------------------------------------------------------------------ */

enum { RECORD_FLOATS = 9, CHUNK = 1024 };

static unsigned char *put_floats(unsigned char *to, const float values[3])
{
    for (int i = 0; i < 3; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        for (int byte = 0; byte < 4; byte++)
            *to++ = (unsigned char)(bits >> (8 * byte));
    }
    return to;
}

static void write_records(FILE *file, const pm_photon *photons, size_t count)
{
    unsigned char buffer[CHUNK * RECORD_FLOATS * 4];
    for (size_t i = 0; i < count && !ferror(file);) {
        unsigned char *to = buffer;
        for (const size_t stop = count - i < CHUNK ? count : i + CHUNK; i < stop; i++) {
            to = put_floats(to, photons[i].position);
            to = put_floats(to, photons[i].direction);
            to = put_floats(to, photons[i].power);
        }
        (void)fwrite(buffer, 1, (size_t)(to - buffer), file);
    }
}

/* The first photon that is not finite; `count` where all are. */
static size_t first_not_finite(const pm_photon *photons, size_t count)
{
    for (size_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            if (!isfinite(photons[i].position[a]) || !isfinite(photons[i].direction[a]) ||
                !isfinite(photons[i].power[a]))
                return i;
    return count;
}

pm_status pm_ply_write_photons(const char *path, const pm_photon *photons, size_t count, pm_error *error)
{
    if (!path || (!photons && count))
        return pm__fail(error, PM_EINVAL, "writing photons needs a path and the photons");
    if (count > SIZE_MAX / sizeof *photons)
        return pm__fail(error, PM_EINVAL, "%zu photons: memory cannot hold so many", count);
    const size_t bad = first_not_finite(photons, count);
    if (bad < count)
        return pm__fail(error, PM_ENONFINITE, "photon %zu: a value is not finite", bad);
    pm__output output;
    const pm_status status = pm__output_open(path, &output, error);
    if (status != PM_OK)
        return status;
    (void)fprintf(output.file, "ply\nformat binary_little_endian 1.0\nelement vertex %zu\n", count);
    for (size_t i = 0; i < RECORD_FLOATS; i++)
        (void)fprintf(output.file, "property float %s\n", photon_fields[i].name);
    (void)fputs("end_header\n", output.file);
    write_records(output.file, photons, count);
    return pm__output_commit(&output, error);
}
