/* Fixed points in a grid: which of them a photon lies within the radius of ([H09]: photons find the points, not points
 * the photons). The grid is made once and again as radii have shrunk; a pass needs no map of its photons.
 *
 * Each point is listed in every cell that its ball touches, with the radius that it had then. Radii only shrink, so
 * what is listed is what may be found; the radius of now decides. */
#ifndef PM_METHODS_PROGRESSIVE_COVER_H
#define PM_METHODS_PROGRESSIVE_COVER_H

#include "progressive.h"

/* In a cell's own terms, steps of `step` from its lower corner less `margin`: what is read most must be small. */
typedef struct pm__listed {
    uint8_t position[3], radius; /* the radius rounded up by what rounding may do */
    uint32_t point;
} pm__listed;

/* A point as it is now: half a cache line. */
typedef struct pm__standing {
    float position[3], radius; /* m; 0: it looks up nothing */
    float normal[3], unused;
} pm__standing;

/* What a photon brings to a point: its power, by the BRDF where that depends on it, and the kernel's weight. */
typedef struct pm__gift {
    double weight;
    float flux[3]; /* W */
    uint32_t point;
} pm__gift;

typedef struct pm__gifts {
    pm__gift *items;
    size_t count, capacity;
} pm__gifts;

/* What a pass brings to a point. */
typedef struct pm__brought {
    double flux[3]; /* W, weighted */
    size_t count;
} pm__brought;

typedef struct pm__cover {
    double low[3], edge, inverse_edge; /* of the cells, m */
    double margin, step, inverse_step; /* m: see pm__listed */
    size_t cells[3];
    uint32_t *starts;            /* [cells + 1]: where in `listed` each begins */
    pm__listed *listed;
    pm__standing *now;           /* [points] */
    float *built;                /* [points]: the radius as listed */
    double (*share)[3];          /* [points]: pm__found's */
    double area, listed_area;    /* m2 but for pi: the sum of squared radii now, and as listed */
    bool uneven;                 /* some surfaces do not scatter evenly */
    /* Room that passes use, one after the other. */
    pm__brought *brought;        /* [points] */
    pm__gifts *gifts;            /* [gift_lists] */
    size_t gift_lists;
} pm__cover;

/* Does the run's method look up at fixed points, all within a radius, by a kernel of distances alone? Then a pass is
 * pm__run_splat. */
bool pm__run_splats(const pm__run *run);

/* For the radii as they are. ENOMEM. */
pm_status pm__cover_make(const pm__run *run, pm__cover **cover, pm_error *error);
void pm__cover_free(pm__cover *cover); /* NULL is allowed */

/* Of the next lookup of a point that has a surface, in single precision, as that of a query; 0: there is none. */
float pm__cover_radius(const pm__run *run, size_t point);

/* Takes over the radii of the run's state: false where one has grown since it was made. */
bool pm__cover_follow(pm__cover *cover, const pm__run *run);

/* The cell of a position, and the position in its terms; SIZE_MAX: it lies in none. */
static inline size_t pm__cover_cell(const pm__cover *cover, const float position[3], float within[3])
{
    size_t at[3];
    for (int a = 0; a < 3; a++) {
        const double offset = (double)position[a] - cover->low[a], x = offset * cover->inverse_edge;
        if (!(x >= 0.0 && x < (double)cover->cells[a]))
            return SIZE_MAX;
        at[a] = (size_t)x;
        within[a] = (float)((offset - (double)at[a] * cover->edge + cover->margin) * cover->inverse_step);
    }
    return (at[2] * cover->cells[1] + at[1]) * cover->cells[0] + at[0];
}

/* The pass's photons at all points; makes the cover where there is none, or where it lists much too far. ENOMEM. */
pm_status pm__run_splat(pm__run *run, const pm__photon_set *set, pm_error *error);

#endif
