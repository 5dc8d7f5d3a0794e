/* Rectangles and discs, met all at once, in double: by the same operations as pm__shape_meet, so to the same digits. */
#ifndef PM_SCENE_FLATS_H
#define PM_SCENE_FLATS_H

#include "shapes.h"

#include <stddef.h>

enum { PM__MOST_FLATS = 20 };

/* By component. All that is beyond `count` is 0: a plane without normal is never met. */
typedef struct pm__flats {
    _Alignas(32) double corner[3][PM__MOST_FLATS];
    double normal[3][PM__MOST_FLATS];
    double dual[2][3][PM__MOST_FLATS]; /* as of a shape; 0 for a disc */
    double margin[2][PM__MOST_FLATS];
    double square[PM__MOST_FLATS];     /* m2: a disc's radius squared, with its slack; infinite for a rectangle */
    int64_t number[PM__MOST_FLATS];    /* of the shape */
    size_t count;
    bool wide;                         /* by AVX2: 4 at a time, else 2 */
} pm__flats;

/* A rectangle or disc, prepared. Not more than PM__MOST_FLATS; numbers ascend. `flats` starts as 0. */
void pm__flats_add(pm__flats *flats, const pm__shape *shape, uint32_t number);

/* The first that the ray meets, but for shapes `from` and `to`; the lowest number of equally near ones. Returns its
 * place among the flats, or flats->count: none. *distance: m, within the ray's reach. Cost: 10 ns and 3 ns each. */
size_t pm__flats_meet(const pm__flats *flats, const pm__ray *ray, uint32_t from, uint32_t to, double *distance);

#endif
