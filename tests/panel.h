/* Means of estimates over many independent neighbourhoods of even light, random or stratified. */
#ifndef PM_TESTS_PANEL_H
#define PM_TESTS_PANEL_H

#include "neighborhood.h"

static const double pi = 3.14159265358979323846;

static hood h; /* the one at work */

enum { MAX_SUBJECTS = 12 };

/* Several estimators on the same neighbourhoods. */
typedef struct panel {
    subject subjects[MAX_SUBJECTS];
    moments results[MAX_SUBJECTS];
    size_t count;
} panel;

static inline void panel_init(panel *p, const char *const *names, size_t count)
{
    p->count = count;
    for (size_t i = 0; i < count; i++) {
        p->subjects[i] = subject_of(names[i]);
        p->results[i] = (moments){0};
    }
}

#define PANEL(p, ...)                                                      \
    do {                                                                   \
        const char *const names_[] = {__VA_ARGS__};                        \
        panel_init(&(p), names_, sizeof names_ / sizeof *names_);          \
    } while (0)

static inline void panel_add(panel *p, const pm__lookup *lookup)
{
    for (size_t i = 0; i < p->count; i++)
        moments_add(&p->results[i], estimate_of(&p->subjects[i], lookup));
}

static inline void run_poisson(panel *p, stream *s, int dimensions, size_t n, size_t runs)
{
    hood_init(&h, dimensions);
    for (size_t i = 0; i < runs; i++) {
        hood_poisson(&h, s, n);
        panel_add(p, &h.lookup);
    }
}

/* Poisson photons in x > -left, y > -below only. */
static inline void run_corner(panel *p, stream *s, size_t n, double left, double below_, size_t runs)
{
    hood_init(&h, 2);
    for (size_t i = 0; i < runs; i++) {
        hood_poisson_in(&h, s, n, left, below_);
        panel_add(p, &h.lookup);
    }
}

/* ---- Stratified photons: one in each cell of the unit lattice, the query anywhere in its cell -------- */

typedef struct spot {
    double distance2, x, y;
    int row, column;
} spot;

enum { MAX_SPOTS = 1200 };

static inline int compare_spots(const void *a, const void *b)
{
    const double d = ((const spot *)a)->distance2 - ((const spot *)b)->distance2;
    return (d > 0) - (d < 0);
}

/* All photons within `radius`, by distance. */
static inline size_t stratify(stream *s, double radius, spot *spots)
{
    const int reach = (int)ceil(radius);
    const double x = uniform(s), y = uniform(s);
    size_t count = 0;
    for (int row = -reach; row <= reach; row++)
        for (int column = -reach; column <= reach; column++) {
            const double dx = column + uniform(s) - x, dy = row + uniform(s) - y;
            if (dx * dx + dy * dy <= radius * radius && count < MAX_SPOTS)
                spots[count++] = (spot){dx * dx + dy * dy, dx, dy, row, column};
        }
    qsort(spots, count, sizeof *spots, compare_spots);
    return count;
}

/* A disc of radius r meets cells of area below pi (r + sqrt 2)^2 and holds those within r - sqrt 2. */
static inline void hood_stratified(hood *hd, stream *s, size_t n)
{
    static spot spots[MAX_SPOTS];
    const size_t found = stratify(s, sqrt((double)n / pi) + 1.5, spots);
    if (found < n)
        ck_abort_msg("too few photons");
    hd->set.count = 0;
    for (size_t i = 0; i < n; i++)
        hood_add(hd, spots[i].x, spots[i].y);
}

static inline void run_stratified(panel *p, stream *s, size_t n, size_t runs)
{
    hood_init(&h, 2);
    for (size_t i = 0; i < runs; i++) {
        hood_stratified(&h, s, n);
        panel_add(p, &h.lookup);
    }
}

#endif
