/* The vertices of a PLY file, one after another. */
#ifndef PM_MAP_PLY_READER_H
#define PM_MAP_PLY_READER_H

#include "ply_header.h"

#include "../photonmap.h"

enum { PM__PLY_FIELDS = 12 };

/* A scalar property that the caller needs. */
typedef struct pm__ply_field {
    const char *name;
    const char *alias; /* another name for it, or NULL */
} pm__ply_field;

typedef struct pm__ply {
    pm__ply_input input;
    pm__ply_header header;
    const pm__ply_element *vertex;
    uint64_t index;               /* of the record read next (or now) */
    uint64_t line, offset;        /* where the last vertex began */
    int slot[PM__PLY_PROPERTIES]; /* of each of the vertex's properties: which field it is, or -1 */
} pm__ply;

/* What may be taken for a file's vertices. */
typedef struct pm__ply_budget {
    double memory;     /* bytes; 0: as many as it wants */
    double per_vertex; /* bytes that the caller will want for each, beside what reading takes */
} pm__ply_budget;

/* pm_ply_read_photons and pm_ply_read_points within a budget (NULL: none): ENOMEM before it is exceeded, at once where
 * the file's size vouches for the header's count. */
pm_status pm__ply_read_photons(const char *path, const pm__ply_budget *budget, pm_photon **photons,
                               float (**normals)[3], size_t *count, pm_error *error);
pm_status pm__ply_read_points(const char *path, const pm__ply_budget *budget, pm_surface_point **points, size_t *count,
                              pm_error *error);

/* Opens, reads the header, finds the element `vertex`. On error nothing is to be closed. */
pm_status pm__ply_open(const char *path, pm__ply *ply, pm_error *error);
void pm__ply_close(pm__ply *ply);

/* Whether the vertices have a property of that name. */
bool pm__ply_has(const pm__ply *ply, const char *name);

/* Finds the fields among the properties and goes to the first vertex. EFORMAT: one is missing, a list, or there
 * under both names; the file is too short for the vertices it declares. */
pm_status pm__ply_start(pm__ply *ply, const pm__ply_field *fields, size_t count, pm_error *error);

/* The fields of the next vertex, in the order given at the start, each within the range of a float.
 * ENONFINITE, EFORMAT, EIO. Not to be called more than vertex->count times. */
pm_status pm__ply_next(pm__ply *ply, double *values, pm_error *error);

/* The place of the vertex that pm__ply_next gave last. */
void pm__ply_vertex_place(const pm__ply *ply, char place[PM__PLY_PLACE]);

#endif
