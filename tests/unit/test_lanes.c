/* Cells and plots of points by the loops of every width, against the same found one by one with branches and tables:
 * equal to the last bit, of points near and far, at edges, and not finite. */
#include "../../src/base/random.h"
#include "../../src/transport/cone.h"
#include "../../src/transport/lanes.h"
#include "../../src/transport/plots.h"
#include "../../src/transport/vicinity.h"
#include "../test.h"

#include <string.h>

enum { BATCHES = 150 };

static const char *const widths[] = {"v2", "avx2", "avx512"};

static const pm__lanes *lanes_of(size_t w)
{
    const pm__lanes *const lanes[] = {&pm__lanes_plain, &pm__lanes_avx2, &pm__lanes_avx512};
    ck_assert_int_eq(setenv("PHOTONBENCH_SIMD", widths[w], 1), 0);
    return pm__lanes_choose() == lanes[w] ? lanes[w] : NULL; /* else the processor lacks it */
}

/* Most within a few m, on whole numbers, on axes; some of any size, and what is no number. */
static float coordinate(int batch, int i, int axis, double reach)
{
    static const float odd[] = {NAN, INFINITY, -INFINITY, 3e38f, -3e38f, 1e-45f, -1e-45f, 0.0f, -0.0f, 1e18f, -1e18f};
    double u[3];
    pm__random_uniform(21, PM__FOR_TESTS, (uint32_t)axis, (uint64_t)(batch * PM__LANE_POINTS + i), u, 3);
    if (u[0] < 0.01)
        return odd[(size_t)(u[1] * sizeof odd / sizeof *odd)];
    if (u[0] < 0.05)
        return (float)(u[2] < 0.5 ? pow(10.0, 60.0 * u[1] - 30.0) : -pow(10.0, 60.0 * u[1] - 30.0));
    return (float)(u[0] < 0.2 ? rint(reach * (2.0 * u[1] - 1.0)) : reach * (2.0 * u[1] - 1.0));
}

static bool is_any(const float position[3], const float normal[3])
{
    const float sum = fabsf(normal[0]) + fabsf(normal[1]) + fabsf(normal[2]);
    return sum > 0.0f && sum < INFINITY && isfinite(position[0] + position[1] + position[2]);
}

/* ---- Cells -------------------------------------------------------------------------------------- */

static float framed(const pm__cell_frame *f, int axis, float x)
{
    return (float)fmax(-f->limit, fmin(((double)x - f->centre[axis]) * f->inverse_unit, f->limit));
}

/* The voxel: -1 outside. */
static int32_t voxel_at(const pm__cell_frame *f, const float position[3])
{
    int32_t at = 0;
    for (int axis = 2; axis >= 0; axis--) {
        const float x = (framed(f, axis, position[axis]) - f->low[axis]) * f->per_edge;
        if (!(x >= 0.0f && x < (float)PM__VOXELS))
            return -1;
        at = at * PM__VOXELS + (int32_t)x;
    }
    return at;
}

static void check_cell(const pm__cell_frame *f, const pm__cell_points *p, int i)
{
    const float position[3] = {p->position[0][i], p->position[1][i], p->position[2][i]};
    const float normal[3] = {p->normal[0][i], p->normal[1][i], p->normal[2][i]};
    uint32_t cell[3];
    int is_far = 0;
    bool alike = true;
    if (!is_any(position, normal)) {
        ck_assert_int_eq(p->voxel[i], -1);
        return;
    }
    const pm__cone cone = pm__cone_at(normal);
    for (int axis = 0; axis < 3; axis++) {
        const double at = floor((double)framed(f, axis, position[axis]) * (double)f->per_size) + PM__CELL_HALF;
        const bool is_in = at >= 0.0 && at < 2.0 * PM__CELL_HALF;
        is_far |= !is_in;
        cell[axis] = is_in ? (uint32_t)at : 0;
        alike = alike && p->cell[axis][i] == cell[axis];
    }
    alike = alike && p->cone[i] == pm__cone_number(&cone) && p->is_far[i] == is_far &&
            p->voxel[i] == voxel_at(f, position) &&
            p->mixed[i] == pm__cell_mixed(cell[0], cell[1], cell[2], p->cone[i]);
    if (!alike) /* asserting each takes a message to another process */
        ck_abort_msg("cell of %g %g %g", (double)position[0], (double)position[1], (double)position[2]);
}

START_TEST(test_cells)
{
    const pm__lanes *const lanes = lanes_of((size_t)_i);
    const pm__cell_frame frame = {.centre = {0.3, -1.0, 2.0}, .inverse_unit = 0.37, .limit = 1e18,
                                  .low = {-2.0f, -1.0f, -3.0f}, .per_edge = 11.0f, .per_size = 64.0f};
    static pm__cell_points p;
    size_t near = 0, outside = 0;
    for (int batch = 0; batch < BATCHES && lanes; batch++) {
        for (int i = 0; i < PM__LANE_POINTS; i++)
            for (int axis = 0; axis < 3; axis++) {
                p.position[axis][i] = coordinate(batch, i, axis, 8.0);
                p.normal[axis][i] = coordinate(batch, i, axis + 3, 1.5);
            }
        lanes->cut_cells(&frame, &p);
        for (int i = 0; i < PM__LANE_POINTS; i++) {
            check_cell(&frame, &p, i);
            near += p.voxel[i] >= 0;
            outside += p.voxel[i] < 0;
        }
    }
    ck_assert(!lanes || (near > 1000 && outside > 1000));
}
END_TEST

/* ---- Plots -------------------------------------------------------------------------------------- */

static float bounded(float x, float most)
{
    return x > 0.0f ? x < most ? x : most : 0.0f;
}

/* The key of a plot of that level, and where in its square the point lies. */
static uint64_t key_at(const pm__plot_frame *f, const float position[3], const pm__cone *cone, int level,
                       bool important, int32_t at[2])
{
    static const float slope[PM__CONE_STEPS] = {-2.0f / PM__CONE_STEPS, 0.0f, 2.0f / PM__CONE_STEPS};
    static const float most = (1 << PM__PLOT_ACROSS_BITS) - 1;
    static const float half = 1 << (PM__PLOT_ALONG_BITS - 1), last = (1 << PM__PLOT_ALONG_BITS) - 1;
    const int u = (cone->axis + 1) % 3, v = (cone->axis + 2) % 3;
    const float scale = ldexpf(f->per_edge, PM__PLOT_USUAL - level), offset = f->offset * scale;
    const float w = (position[cone->axis] - f->low[cone->axis]) * scale;
    const float x = (position[u] - f->low[u]) * scale, y = (position[v] - f->low[v]) * scale;
    const float along = (cone->face & 1 ? -w : w) + slope[cone->u] * x + slope[cone->v] * y;
    const float in[2] = {bounded(x + offset, most), bounded(y + offset, most)};
    uint64_t key = ((uint64_t)level << PM__PLOT_CONE_BITS | (pm__cone_number(cone) + 1)) << 1 | important;
    for (int i = 0; i < 2; i++) {
        key = key << PM__PLOT_ACROSS_BITS | (uint64_t)in[i];
        at[i] = (int32_t)((in[i] - floorf(in[i])) * 256.0f);
    }
    return key << PM__PLOT_ALONG_BITS | (uint64_t)bounded(along + offset + half, last);
}

static int level_of(const pm__plot_frame *f, float required)
{
    int level = PM__PLOT_USUAL + (int)floor(0.5 - 0.5 * log2((double)(required / f->usual)));
    /* Half and twice belong to the levels above: a power of two in doubles, whatever the logarithm says. */
    while ((double)(required / f->usual) >= ldexp(2.0, 2 * (PM__PLOT_USUAL - level)))
        level--;
    while ((double)(required / f->usual) < ldexp(0.5, 2 * (PM__PLOT_USUAL - level)))
        level++;
    return level < f->least ? f->least : level > f->most ? f->most : level;
}

static uint64_t beside(const pm__plot_frame *f, const float position[3], const pm__cone *cone, float required,
                       bool important)
{
    const float ratio = required / f->usual;
    const int level = level_of(f, required);
    int exponent = 0;
    int32_t at[2];
    const double of = frexp((double)ratio, &exponent); /* in [1/2, 1): of an odd level's twice as much */
    const double fill = exponent % 2 ? 2.0 * of : of;
    const int next = fill > 1.0 ? level - 1 : level + 1;
    const bool is_middle = fill < (double)PM__PLOT_MIDDLE && (float)fill * PM__PLOT_MIDDLE > 1.0f;
    if (next < f->least || next > f->common || level > f->common || is_middle)
        return 0;
    return key_at(f, position, cone, next, important, at);
}

static void check_plot(const pm__plots *plots, const pm__plot_points *p, int i)
{
    const pm__plot_frame *const f = &plots->frame;
    const float position[3] = {p->position[0][i], p->position[1][i], p->position[2][i]};
    const float normal[3] = {p->normal[0][i], p->normal[1][i], p->normal[2][i]};
    const bool important = p->important[i];
    int32_t at[2];
    if (!is_any(position, normal))
        return; /* nothing is promised but that it comes back */
    const pm__cone cone = pm__cone_at(normal);
    const int level = level_of(f, p->required[i]);
    const uint64_t key = key_at(f, position, &cone, level, important, at);
    const float area = ldexpf(f->area, 2 * (level - PM__PLOT_USUAL)) / fabsf(normal[cone.axis]);
    if (p->key[i] == key && p->at[0][i] == at[0] && p->at[1][i] == at[1] && p->area[i] == area &&
        p->wanted[i] == p->required[i] * area * PM__PLOT_LESS && p->shard[i] == pm__plot_shard_of(plots, key) &&
        p->beside[i] == beside(f, position, &cone, p->required[i], important))
        return; /* asserting each takes a message to another process */
    ck_abort_msg("key %llx for %llx of %g %g %g", (unsigned long long)p->key[i], (unsigned long long)key,
                 (double)position[0], (double)position[1], (double)position[2]);
}

START_TEST(test_plots)
{
    static const double low[3] = {-8.0, -8.0, -8.0};
    const pm__lanes *const lanes = lanes_of((size_t)_i);
    static pm__plot_points p;
    pm__plots plots;
    pm__plots_init(&plots, 20.0, 300.0, 5.0, low, 28.0, 0, false);
    for (int batch = 0; batch < BATCHES && lanes; batch++) {
        for (int i = 0; i < PM__LANE_POINTS; i++) {
            double u[2];
            pm__random_uniform(22, PM__FOR_TESTS, 0, (uint64_t)(batch * PM__LANE_POINTS + i), u, 2);
            for (int axis = 0; axis < 3; axis++) {
                p.position[axis][i] = coordinate(batch, i, axis, 8.0);
                p.normal[axis][i] = coordinate(batch, i, axis + 3, 1.5);
            }
            p.required[i] = (float)(u[1] < 0.2 ? ldexp(300.0, (int)(20.0 * u[0]) - 8) : 5.0 * pow(1e5, u[0]));
            p.important[i] = u[1] > 0.7;
        }
        lanes->cut_plots(&plots.frame, &p);
        for (int i = 0; i < PM__LANE_POINTS; i++)
            check_plot(&plots, &p, i);
    }
    pm__plots_free(&plots);
}
END_TEST

int main(void)
{
    Suite *const suite = suite_create("lanes");
    TCase *const tcase = tcase_create("lanes");
    tcase_add_loop_test(tcase, test_cells, 0, 3);
    tcase_add_loop_test(tcase, test_plots, 0, 3);
    suite_add_tcase(suite, tcase);
    return pm__test_run(suite);
}
