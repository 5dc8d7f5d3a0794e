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

#endif
