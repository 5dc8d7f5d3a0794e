/* The automaton of a light-path expression, walked a letter at a time while a photon is traced. */
#ifndef PM_TRANSPORT_PATHS_H
#define PM_TRANSPORT_PATHS_H

#include "trace.h"

/* Where in the expression a path may be: a set of its letters. */
typedef uint64_t pm__places;

pm__places pm__paths_begin(void);
/* Goes on by a letter, L, S or D; 0: the path is no beginning of a match. */
pm__places pm__paths_step(const pm__paths *paths, pm__places places, char letter);
bool pm__paths_accept(const pm__paths *paths, pm__places places);
/* As pm__paths_end. */
bool pm__paths_dead(const pm__paths *paths, pm__places places);

/* The same backwards, for paths from the eye: where the first letter may be of what is spelled so far, the end of a
 * photon's path. It begins with the D at which the photon would be stored; `letter` is of the surface before it. */
pm__places pm__paths_from_end(const pm__paths *paths);
pm__places pm__paths_step_back(const pm__paths *paths, pm__places places, char letter);
/* Is it a whole path once L stands before it? */
bool pm__paths_whole(const pm__paths *paths, pm__places places);
/* Can it be one once L and further surfaces do? Exact. */
bool pm__paths_grow(const pm__paths *paths, pm__places places);

#endif
