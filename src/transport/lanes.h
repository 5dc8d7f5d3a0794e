/* In which cells of importance, and in which plots of surface, points lie: loops over many points, in three widths with
 * the same results. */
#ifndef PM_TRANSPORT_LANES_H
#define PM_TRANSPORT_LANES_H

#include <stdint.h>

enum { PM__LANE_POINTS = 64 }; /* at once */

/* ---- Cells (cells.h) ---------------------------------------------------------------------------- */

enum { PM__CELL_BITS = 19, PM__CELL_HALF = 1 << (PM__CELL_BITS - 1) }; /* cells on each side of the middle */

/* Where space is cut. */
typedef struct pm__cell_frame {
    double centre[3], inverse_unit, limit; /* to map units, as pm__in_frame does */
    float low[3], per_edge;                /* voxels of the vicinity, map units */
    float per_size;                        /* cells, of map units: a power of two */
} pm__cell_frame;

/* Points, one array for each number, and what is found of them. */
typedef struct pm__cell_points {
    _Alignas(64) float position[3][PM__LANE_POINTS], normal[3][PM__LANE_POINTS];
    uint64_t mixed[PM__LANE_POINTS];   /* of the eight cells that its own is of */
    uint32_t cell[3][PM__LANE_POINTS]; /* counted from PM__CELL_HALF below the middle */
    uint32_t cone[PM__LANE_POINTS];
    int32_t voxel[PM__LANE_POINTS];    /* < 0: outside all, or not finite */
    int32_t is_far[PM__LANE_POINTS];   /* 1: too far off to be counted */
} pm__cell_points;

/* A cell's numbers and its normals' class. */
static inline uint64_t pm__cell_key(uint32_t x, uint32_t y, uint32_t z, uint32_t cone)
{
    return ((((uint64_t)1 << PM__CELL_BITS | x) << PM__CELL_BITS | y) << PM__CELL_BITS | z) << 6 | cone;
}

/* Of the eight cells that make a cube with this one, one for one: no two keys are mixed alike. */
static inline uint64_t pm__cell_mixed(uint32_t x, uint32_t y, uint32_t z, uint32_t cone)
{
    uint64_t key = pm__cell_key(x >> 1, y >> 1, z >> 1, cone);
    key *= 0x9e3779b97f4a7c15u;
    key ^= key >> 32;
    key *= 0xbf58476d1ce4e5b9u;
    return key ^ key >> 29;
}

/* ---- Plots (plots.h) ---------------------------------------------------------------------------- */

/* A key: level, class of normals and one, importance, then the cell: along the two axes across, and along the class. */
enum { PM__PLOT_LEVEL_BITS = 4, PM__PLOT_CONE_BITS = 6, PM__PLOT_ACROSS_BITS = 17, PM__PLOT_ALONG_BITS = 19 };
enum { PM__PLOT_IMPORTANT_AT = 2 * PM__PLOT_ACROSS_BITS + PM__PLOT_ALONG_BITS }; /* the key's bit */
enum { PM__PLOT_SHARD_BITS = 5, PM__PLOT_SHARDS = 1 << PM__PLOT_SHARD_BITS };
enum { PM__PLOT_LEVELS = 16, PM__PLOT_USUAL = 8 };

/* Of the photons wanted: what is rounded shall not ask for one more. */
#define PM__PLOT_LESS (1.0f - 1e-5f)

/* In the middle of a level: required densities there are another's only by more than this factor. */
#define PM__PLOT_MIDDLE 1.2f

/* Where surface is cut: of the usual level, from which edges double and areas quadruple. */
typedef struct pm__plot_frame {
    float low[3];              /* m: a corner of the scene */
    float per_edge, area;      /* 1/m, m2: of a square */
    float offset;              /* m: of all squares */
    float usual;               /* 1/m2: in the middle of the level */
    int32_t least, most;       /* levels that are used */
    int32_t common;            /* plots in one square of this level are of one shard */
} pm__plot_frame;

/* Photons, one array for each number, and what is found of them. */
typedef struct pm__plot_points {
    _Alignas(64) float position[3][PM__LANE_POINTS], normal[3][PM__LANE_POINTS];
    float required[PM__LANE_POINTS]; /* 1/m2, > 0 */
    uint32_t important[PM__LANE_POINTS]; /* 0 or 1 */
    uint64_t key[PM__LANE_POINTS];
    uint64_t beside[PM__LANE_POINTS]; /* of the plot there of another size, the next that counts it; 0: none does */
    float wanted[PM__LANE_POINTS], area[PM__LANE_POINTS]; /* photons; m2 */
    int32_t at[2][PM__LANE_POINTS]; /* in the square, 256ths of its edge */
    uint32_t shard[PM__LANE_POINTS];
} pm__plot_points;

/* All bits depend on all of the key's. */
static inline uint64_t pm__plot_hash(uint64_t key)
{
    key *= 0x9e3779b97f4a7c15u;
    key ^= key >> 32;
    key *= 0xbf58476d1ce4e5b9u;
    return key ^ key >> 29;
}

/* ---- Widths ------------------------------------------------------------------------------------- */

/* All PM__LANE_POINTS are looked at, whatever is in them. */
typedef struct pm__lanes {
    void (*cut_cells)(const pm__cell_frame *frame, pm__cell_points *points);
    void (*cut_plots)(const pm__plot_frame *frame, pm__plot_points *points);
} pm__lanes;

extern const pm__lanes pm__lanes_plain, pm__lanes_avx2, pm__lanes_avx512;

/* The widest that the processor has, or that PHOTONBENCH_SIMD names. */
const pm__lanes *pm__lanes_choose(void);

#endif
