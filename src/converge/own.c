/* What the runs of a series say of their own error, beside what it is. */
#include "measuring.h"

#include <math.h>
#include <string.h>

static const double single = 1e-6; /* rounding of errors and of positions, relative */

/* The share of points whose error is within their own bound. What is without noise is as exact as errors are kept. */
static double share_right(const pm__measuring *m, const float *e)
{
    const pm__yardstick *const y = &m->yardstick;
    double right = 0.0;
    for (size_t v = 0; v < y->values; v++) {
        double square = 0.0, truth = 0.0;
        for (size_t b = 0; b < 3; b++) {
            square += (double)e[3 * v + b] * (double)e[3 * v + b] / 3.0;
            truth = fmax(truth, fabs(y->truth[3 * v + b]));
        }
        right += sqrt(square) <= pm__run_own_bound(&m->run, y->point[v], PM__CONFIDENCE) + single * truth;
    }
    return right / (double)y->values;
}

/* A stored reference is of pixels or blocks of them, and has an error of its own: not what a point's bound is about. */
static bool is_exact(const pm__measuring *m)
{
    return strcmp(m->yardstick.name, "exact") == 0;
}

double pm__measuring_own_error(const pm__measuring *m)
{
    return pm__run_own_rel_rmse(&m->run, is_exact(m) ? m->yardstick.point : NULL, m->yardstick.values);
}

void pm__measuring_own_record(pm__measuring *m, const float *e)
{
    const size_t at = m->series->trials * m->room + m->record;
    if (!m->estimated)
        return;
    m->estimated[at] = pm__measuring_own_error(m);
    m->right[at] = isfinite(m->estimated[at]) && is_exact(m) ? share_right(m, e) : (double)NAN;
}

void pm__measuring_own_average(const pm__measuring *m)
{
    const double trials = (double)m->series->trials;
    for (size_t r = 0; r < m->records; r++) {
        pm__converge_row *const row = &m->series->rows[r];
        double estimated = 0.0, right = 0.0;
        for (size_t t = 0; t < m->series->trials && m->estimated; t++) {
            estimated += m->estimated[t * m->room + r] / trials;
            right += m->right[t * m->room + r] / trials;
        }
        row->estimated_rel_rmse = m->estimated ? m->estimated[r] : (double)NAN;
        row->estimated_rel_rmse_mean = m->estimated ? estimated : (double)NAN;
        row->estimate_right = m->estimated ? right : (double)NAN;
    }
}
