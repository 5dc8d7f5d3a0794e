/* What the nearest photon says, for very many points of few places: by cells of space and of normals, each asked about
 * once, at its middle. So what is answered is a function of the cell alone, whoever asks first. */
#ifndef PM_TRANSPORT_CELLS_H
#define PM_TRANSPORT_CELLS_H

#include "../photonmap.h"

typedef struct pm__cells pm__cells;

/* What a photon, nearest to the middle of a cell, says of it: finite, >= 0. distance: m, from the middle less half the
 * cell's diagonal, or 0. */
typedef float (*pm__cell_value)(const void *context, uint32_t photon, double distance);

/* map: with directions, and photons in it; borrowed. reach: m, none farther is wanted. size: m, of a cell; where no
 * photon is near cells are 8 times as large. ENOMEM. */
pm_status pm__cells_create(const pm_map *map, double reach, double size, pm__cell_value value, const void *context,
                           pm__cells **cells);
void pm__cells_destroy(pm__cells *cells); /* NULL is allowed */

enum { PM__CELLS_AT_ONCE = 64 };

/* For `count` points, at most so many, what the nearest photon that came to the side of the normal says in the middle
 * of the point's cell: 0 where there is none, or a point is not finite. From any number of threads. Cost: some 30 ns a
 * point, and a search or two for the first in a cell. */
void pm__cells_find(pm__cells *cells, const float (*positions)[3], const float (*normals)[3], size_t count,
                    float *values);

#endif
