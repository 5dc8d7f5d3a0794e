#include "cover.h"

#include "../../base/memory.h"
#include "../../base/vec3.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Cells are about so many radii wide: of fewer a point touches more, of more a photon meets more points in vain. */
static const double radii_a_cell = 2.0;
/* A cell listed for each point at most, on average. */
static const double most_listed = 10.0;
/* Cells for each point at most, and in any case. */
enum { CELLS_A_POINT = 32, LEAST_CELLS = 4096 };
/* Of the unit: within it powers of two are floats, and so are their inverses. */
enum { LARGEST_EXPONENT = 100 };
/* Steps across what a cell lists. */
static const double steps = 250.0;
/* What is listed reaches a little farther than single precision may find. */
static const double beyond = 1.0 + 1e-5;

/* What cells can be: none where no point looks anything up. */
typedef enum layout { CELLS, NO_BALLS, TOO_LARGE } layout;

void pm__cover_free(pm__cover *cover)
{
    if (!cover)
        return;
    free(cover->starts);
    free(cover->listed);
    free(cover->now);
    free(cover->built);
    free(cover->share);
    free(cover->brought);
    pm__pairs_free(cover->pairs, cover->pair_lists);
    free(cover);
}

/* ---- Points ------------------------------------------------------------------------------------ */

static float radius_of(const pm__run *run, size_t point)
{
    const pm__progressive *const method = pm__progressive_of(run);
    size_t k = 0;
    double radius = 0.0;
    if (!run->of->fixed[point].material)
        return 0.0f;
    method->ask(run, point, run->state + point * method->fields, &k, &radius);
    return radius > 0.0 ? (float)radius : 0.0f;
}

/* The square is rounded as that of a query is. */
float pm__cover_take_radius(pm__cover *cover, const pm__run *run, size_t point)
{
    pm__standing *const now = &cover->now[point];
    const float radius = radius_of(run, point);
    const double own = (double)radius * cover->inverse_unit;
    now->radius = (float)own;
    now->most2 = (float)fmin(own * own, (double)FLT_MAX);
    return radius;
}

bool pm__cover_follow(pm__cover *cover, const pm__run *run)
{
    bool holds = true;
    cover->area = 0.0;
    for (size_t i = 0; i < run->of->points; i++) {
        const float radius = pm__cover_take_radius(cover, run, i);
        cover->area += (double)radius * (double)radius;
        holds = holds && radius <= cover->built[i];
    }
    return holds;
}

/* Positions are those of queries everywhere, in single precision. */
static double at(const pm__run *run, size_t i, int a)
{
    return (double)(float)run->of->fixed[i].position[a];
}

static void choose_unit(const pm__run *run, pm__cover *cover)
{
    double largest = 0.0;
    int exponent = 0;
    for (size_t i = 0; i < run->of->points; i++) {
        cover->built[i] = radius_of(run, i);
        cover->listed_area += (double)cover->built[i] * (double)cover->built[i];
        largest = fmax(largest, (double)cover->built[i]);
        for (int a = 0; a < 3 && cover->built[i] > 0.0f; a++)
            largest = fmax(largest, fabs(at(run, i, a)));
    }
    (void)frexp(isfinite(largest) ? largest : 1.0, &exponent);
    if (abs(exponent) > LARGEST_EXPONENT)
        exponent = exponent > 0 ? LARGEST_EXPONENT : -LARGEST_EXPONENT;
    cover->unit = ldexp(1.0, exponent);
    cover->inverse_unit = ldexp(1.0, -exponent);
}

static void note_point(const pm__run *run, size_t i, pm__cover *cover)
{
    const pm__hit_point *const point = &run->of->fixed[i];
    double brdf[3] = {1.0, 1.0, 1.0}, normal[3];
    (void)pm__cover_take_radius(cover, run, i);
    if (!point->material)
        return;
    if (point->material->kind == PM__DIFFUSE)
        pm__hit_point_brdf(point, point->normal, brdf);
    else
        cover->uneven = true;
    for (int a = 0; a < 3; a++)
        normal[a] = (double)(float)point->normal[a];
    (void)pm__normalize(normal); /* as queries have it */
    for (int a = 0; a < 3; a++) {
        cover->now[i].position[a] = (float)(at(run, i, a) * cover->inverse_unit);
        cover->now[i].normal[a] = (float)normal[a];
        cover->share[i][a] = point->weight[a] * brdf[a];
    }
}

/* ---- Cells ------------------------------------------------------------------------------------- */

/* Half the side of the box about the point's ball, m; 0: it has none. */
static double reach_of(const pm__cover *cover, size_t i)
{
    return beyond * (double)cover->built[i];
}

/* The box about all balls; the largest one's reach. */
static double find_box(const pm__run *run, const pm__cover *cover, double low[3], double high[3])
{
    double most = 0.0;
    for (int a = 0; a < 3; a++) {
        low[a] = INFINITY;
        high[a] = -INFINITY;
    }
    for (size_t i = 0; i < run->of->points; i++) {
        const double reach = reach_of(cover, i);
        most = fmax(most, reach);
        for (int a = 0; a < 3 && reach > 0.0; a++) {
            low[a] = fmin(low[a], at(run, i, a) - reach);
            high[a] = fmax(high[a], at(run, i, a) + reach);
        }
    }
    return most;
}

/* About how many entries cells of this edge need. */
static double estimate_listed(const pm__run *run, const pm__cover *cover, double edge)
{
    double sum = 0.0;
    for (size_t i = 0; i < run->of->points; i++) {
        const double reach = reach_of(cover, i), along = 1.0 + 2.0 * reach / edge;
        sum += reach > 0.0 ? along * along * along : 0.0;
    }
    return sum;
}

static layout choose_cells(const pm__run *run, pm__cover *cover)
{
    const double points = (double)run->of->points;
    double high[3], edge = radii_a_cell * sqrt(cover->listed_area / points);
    const double reach = find_box(run, cover, cover->low, high);
    if (!(reach > 0.0))
        return NO_BALLS;
    if (!isfinite(edge) || !isfinite(reach))
        return TOO_LARGE;
    for (;; edge *= 1.25) {
        double cells = 1.0;
        for (int a = 0; a < 3; a++)
            cells *= floor((high[a] - cover->low[a]) / edge) + 1.0;
        if (cells <= fmax(CELLS_A_POINT * points, LEAST_CELLS) &&
            (cells < 2.0 || estimate_listed(run, cover, edge) <= most_listed * points))
            break;
    }
    cover->edge = edge;
    cover->inverse_edge = 1.0 / edge;
    cover->margin = reach;
    cover->step = (edge + 2.0 * reach) / steps;
    cover->inverse_step = 1.0 / cover->step;
    for (int a = 0; a < 3; a++)
        cover->cells[a] = (size_t)floor((high[a] - cover->low[a]) * cover->inverse_edge) + 1;
    return CELLS;
}

/* The cells that the point's ball may touch: from[a] <= c <= to[a]; false: none. */
static bool touched(const pm__run *run, const pm__cover *cover, size_t i, size_t from[3], size_t to[3])
{
    const double reach = reach_of(cover, i);
    for (int a = 0; a < 3 && reach > 0.0; a++) {
        const double offset = at(run, i, a) - cover->low[a], most = (double)cover->cells[a] - 1.0;
        from[a] = (size_t)fmin(fmax(floor((offset - reach) * cover->inverse_edge), 0.0), most);
        to[a] = (size_t)fmin(fmax(floor((offset + reach) * cover->inverse_edge), 0.0), most);
    }
    return reach > 0.0;
}

/* Rounded to the nearest step, of the centre by half a one an axis at most; of photons single precision rounds less. */
static pm__listed entry_of(const pm__run *run, const pm__cover *cover, size_t i, const size_t cell[3])
{
    pm__listed entry = {.point = (uint32_t)i};
    for (int a = 0; a < 3; a++) {
        const double offset = at(run, i, a) - cover->low[a] - (double)cell[a] * cover->edge;
        entry.position[a] = (uint8_t)fmin(fmax((offset + cover->margin) * cover->inverse_step + 0.5, 0.0), 255.0);
    }
    entry.radius = (uint8_t)fmin(ceil(reach_of(cover, i) * cover->inverse_step) + 2.0, 255.0);
    return entry;
}

/* Without `listed` counts what each cell lists into starts; with it fills in, each cell's start running to its end. */
static void list_points(const pm__run *run, pm__cover *cover)
{
    size_t from[3], to[3];
    for (size_t i = 0; i < run->of->points; i++) {
        if (!touched(run, cover, i, from, to))
            continue;
        for (size_t z = from[2]; z <= to[2]; z++)
            for (size_t y = from[1]; y <= to[1]; y++)
                for (size_t x = from[0]; x <= to[0]; x++) {
                    uint32_t *const start = &cover->starts[(z * cover->cells[1] + y) * cover->cells[0] + x];
                    if (cover->listed)
                        cover->listed[*start] = entry_of(run, cover, i, (size_t[3]){x, y, z});
                    (*start)++;
                }
    }
}

/* Of all cells together; what one lists are different points, which 32 bits count. */
static uint64_t count_listed(const pm__run *run, const pm__cover *cover)
{
    uint64_t sum = 0;
    size_t from[3], to[3];
    for (size_t i = 0; i < run->of->points; i++)
        if (touched(run, cover, i, from, to))
            sum += (uint64_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1) * (to[2] - from[2] + 1);
    return sum;
}

static bool list_all(const pm__run *run, pm__cover *cover, uint64_t listed)
{
    const size_t cells = cover->cells[0] * cover->cells[1] * cover->cells[2];
    uint32_t before = 0;
    cover->starts = pm__alloc_zero(cells + 1, sizeof *cover->starts);
    if (!cover->starts)
        return false;
    list_points(run, cover);
    for (size_t c = 0; c <= cells; c++) {
        const uint32_t here = cover->starts[c];
        cover->starts[c] = before;
        before += here;
    }
    cover->listed = pm__alloc((size_t)listed, sizeof *cover->listed);
    if (!cover->listed)
        return false;
    list_points(run, cover);
    memmove(cover->starts + 1, cover->starts, cells * sizeof *cover->starts); /* each stands at its cell's end */
    cover->starts[0] = 0;
    return true;
}

static pm__cover *allocate(size_t points)
{
    pm__cover *const made = calloc(1, sizeof *made);
    if (!made)
        return NULL;
    made->now = pm__alloc_zero(points, sizeof *made->now);
    made->built = pm__alloc(points, sizeof *made->built);
    made->share = pm__alloc_zero(points, sizeof *made->share);
    made->brought = pm__alloc_zero(points, sizeof *made->brought);
    if (made->now && made->built && made->share && made->brought)
        return made;
    pm__cover_free(made);
    return NULL;
}

pm_status pm__cover_make(const pm__run *run, pm__cover **cover, pm_error *error)
{
    const size_t points = run->of->points;
    pm__cover *const made = points <= UINT32_MAX ? allocate(points) : NULL;
    *cover = NULL;
    if (points > UINT32_MAX)
        return PM_OK;
    if (!made)
        return pm__fail(error, PM_ENOMEM, "out of memory for %zu points", points);
    choose_unit(run, made);
    for (size_t i = 0; i < points; i++)
        note_point(run, i, made);
    made->area = made->listed_area;
    const layout found = choose_cells(run, made);
    const uint64_t listed = found == CELLS ? count_listed(run, made) : 0;
    const bool fits = found != TOO_LARGE && listed <= UINT32_MAX;
    if (fits && (found == NO_BALLS || list_all(run, made, listed))) {
        *cover = made;
        return PM_OK;
    }
    pm__cover_free(made);
    return fits ? pm__fail(error, PM_ENOMEM, "out of memory for %zu points", points) : PM_OK;
}
