/* Fixed points in a grid: which of them a photon lies within the radius of ([H09]: photons find the points, not points
 * the photons). The grid is made once and again as radii have shrunk; a pass needs no map of its photons.
 *
 * Each point is listed in every cell that its ball touches, with the radius that it had then. Radii only shrink, so
 * what is listed is what may be found; the radius of now decides. Sums at a point run in the order of the photons,
 * however the work is cut: the cover and the room that there is for pairs change times, never a bit of a result.
 *
 * Memory: some 300 bytes a point, and for pairs of a photon and a point at most PM__CHUNKS lists of PM__PAIRS of them
 * (16 x 0.5 MB), whatever there are in a pass: it is read again before it has left the near caches. */
#ifndef PM_METHODS_PROGRESSIVE_COVER_H
#define PM_METHODS_PROGRESSIVE_COVER_H

#include "progressive.h"

/* Photons of a task; tasks whose pairs are kept at once, and pairs for which each has room, more or less. */
enum { PM__CHUNK = 4096, PM__CHUNKS = 16, PM__PAIRS = 16384 };

/* In a cell's own terms, steps of `step` from its lower corner less `margin`: what is read most must be small. */
typedef struct pm__listed {
    uint8_t position[3], radius; /* the radius rounded up by what rounding may do */
    uint32_t point;
} pm__listed;

/* A point as it is now: half a cache line. Distances are measured as searches do it, in single precision and in a unit
 * that is a power of two, so that the same photons are found, at the same distances. */
typedef struct pm__standing {
    float position[3], radius; /* units; 0: it looks up nothing */
    float normal[3], most2;    /* radius squared, as distances are compared with it */
} pm__standing;

/* What a pass brings to a point. */
typedef struct pm__brought {
    double flux[3]; /* W, weighted */
    size_t count;
} pm__brought;

typedef struct pm__cover {
    double unit, inverse_unit;         /* m, 1/m: a power of two */
    double low[3], edge, inverse_edge; /* of the cells, m */
    double margin, step, inverse_step; /* m: see pm__listed */
    size_t cells[3];
    uint32_t *starts;          /* [cells + 1]: where in `listed` each begins */
    pm__listed *listed;        /* a cell's in ascending order of points; NULL: no point looks anything up */
    pm__standing *now;         /* [points] */
    float *built;              /* [points]: m, the radius as listed */
    double (*share)[3];        /* [points]: pm__found's */
    double area, listed_area;  /* m2 but for pi: the sum of squared radii now, and as listed */
    bool uneven;               /* some surfaces do not scatter evenly */
    /* Room that passes use, one after the other. */
    pm__brought *brought;      /* [points]: all 0 between passes */
    struct pm__pairs *pairs;   /* [pair_lists]: splat.c */
    size_t pair_lists;
} pm__cover;

/* For the radii as they are. NULL: points or what is listed are more than 32 bits count, or radii are beyond all
 * measure: points must look photons up. ENOMEM. */
pm_status pm__cover_make(const pm__run *run, pm__cover **cover, pm_error *error);
void pm__cover_free(pm__cover *cover); /* NULL is allowed */
void pm__pairs_free(struct pm__pairs *pairs, size_t count);

/* Takes the radius of the point's next lookup from the run's state; m, in single precision as that of a query, 0: there
 * is none. */
float pm__cover_take_radius(pm__cover *cover, const pm__run *run, size_t point);

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

/* Shall photons find the points of this configuration, and how much at once? Its points and first radii are there.
 * Depends on the configuration alone. choice.c. As pm__shoot. */
pm_status pm__choose_meeting(pm__progression *progression, pm_error *error);

/* Makes the cover as pm__run_splat does, ahead of it. */
pm_status pm__cover_ready(pm__run *run, bool *done, pm_error *error);

/* The pass's photons at all points; makes the cover where there is none, or where it lists much too far. *done: false
 * where there can be none (pm__cover_make); nothing has happened then. ENOMEM. */
pm_status pm__run_splat(pm__run *run, const pm__photon_set *set, bool *done, pm_error *error);

#endif
