#include "planar.h"

#include <stdlib.h>

static const double pi = 3.14159265358979323846;

const pm__rectangle pm__unit_square = {0.0, 1.0, 0.0, 1.0};
const pm__rectangle pm__inset_square = {0.15, 0.85, 0.15, 0.85};

/* Gauss-Legendre: positive nodes on [-1, 1] and weights. */
static const double nodes8[4][2] = {
    {0.1834346424956498, 0.3626837833783620}, {0.5255324099163290, 0.3137066458778873},
    {0.7966664774136267, 0.2223810344533745}, {0.9602898564975362, 0.1012285362903763}};
static const double nodes16[8][2] = {
    {0.0950125098376374, 0.1894506104550685}, {0.2816035507792589, 0.1826034150449236},
    {0.4580167776572274, 0.1691565193950025}, {0.6178762444026437, 0.1495959888165767},
    {0.7554044083550030, 0.1246289712555339}, {0.8656312023878318, 0.0951585116824928},
    {0.9445750230732326, 0.0622535239386479}, {0.9894009349916499, 0.0271524594117541}};

enum { MAX_RAYS = 64 };

/* The irradiance as seen from a probe. side[q]: distance to the rectangle's side in the direction q * 90 degrees,
 * negative beyond it. */
typedef struct field {
    double (*irradiance)(const double *values, double x, double y);
    const double *values;
    double x, y;
    double side[4];
    double rays[MAX_RAYS][2]; /* directions for full circles */
    int ray_count;
} field;

/* ---- Full circles: the trapezoid rule, of geometric convergence for a periodic integrand ---- */

static double ray_mean(const field *f, double r, int from, int to)
{
    double sum = 0.0;
    for (int i = from; i < to; i++)
        sum += f->irradiance(f->values, f->x + r * f->rays[i][0], f->y + r * f->rays[i][1]);
    return sum / (to - from);
}

/* Doubles the rays, which lie in the order of their doublings, until those between agree with those before. */
static void choose_rays(field *f, double r)
{
    for (int i = 0; i < 8; i++) {
        f->rays[i][0] = cos(0.25 * pi * i);
        f->rays[i][1] = sin(0.25 * pi * i);
    }
    double mean = ray_mean(f, r, 0, 8);
    for (f->ray_count = 8; f->ray_count < MAX_RAYS; f->ray_count *= 2) {
        const int n = f->ray_count;
        for (int i = 0; i < n; i++) {
            f->rays[n + i][0] = cos(2.0 * pi * (i + 0.5) / n);
            f->rays[n + i][1] = sin(2.0 * pi * (i + 0.5) / n);
        }
        const double between = ray_mean(f, r, n, 2 * n);
        if (fabs(between - mean) <= 1e-8 * fabs(between))
            return;
        mean = 0.5 * (mean + between);
    }
}

/* A ring inside the rectangle. Circle means are even in r, so smooth in r squared. */
static double full_ring(field *f, double a, double b)
{
    choose_rays(f, b);
    const bool rough = f->ray_count > 16;
    const double(*const nodes)[2] = rough ? nodes16 : nodes8;
    const double middle = 0.5 * (a * a + b * b), half = 0.5 * (b - a) * (b + a);
    double sum = 0.0;
    for (int i = 0; i < (rough ? 8 : 4); i++)
        for (int sign = -1; sign <= 1; sign += 2)
            sum += nodes[i][1] * ray_mean(f, sqrt(middle + sign * half * nodes[i][0]), 0, f->ray_count);
    return pi * half * sum;
}

/* ---- Circles that leave the rectangle ---- */

static double arc(const field *f, double r, double from, double to)
{
    if (!(to > from))
        return 0.0;
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = 0.0;
    for (int i = 0; i < 8; i++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const double angle = middle + sign * half * nodes16[i][0];
            sum += nodes16[i][1] * f->irradiance(f->values, f->x + r * cos(angle), f->y + r * sin(angle));
        }
    return half * sum;
}

/* The integral over the angles at which radius r is inside. Side q hides the angles within acos(side / r) of its
 * direction; an arc lies between the directions q and q + 1, and sides farther round may reach into it. */
static double arcs(const field *f, double r)
{
    double hidden[4], sum = 0.0;
    for (int q = 0; q < 4; q++)
        hidden[q] = f->side[q] >= r ? 0.0 : acos(fmax(-1.0, f->side[q] / r));
    for (int q = 0; q < 4; q++) {
        const double start = 0.5 * pi * q;
        const double from = fmax(hidden[q], hidden[(q + 3) % 4] - 0.5 * pi);
        const double to = fmin(0.5 * pi - hidden[(q + 1) % 4], pi - hidden[(q + 2) % 4]);
        sum += arc(f, r, start + from, start + to);
    }
    return sum;
}

/* A ring without a side or corner between a and b. At a side the arcs shrink like sqrt(r - side), which
 * r = side + s^2 makes smooth. */
static double cut_ring(const field *f, double a, double b)
{
    double base = 0.0;
    for (int q = 0; q < 4; q++)
        if (fabs(f->side[q]) <= a)
            base = fmax(base, fabs(f->side[q]));
    const double from = sqrt(a - base), to = sqrt(b - base);
    const double middle = 0.5 * (from + to), half = 0.5 * (to - from);
    double sum = 0.0;
    for (int i = 0; i < 8; i++)
        for (int sign = -1; sign <= 1; sign += 2) {
            const double s = middle + sign * half * nodes16[i][0];
            const double r = base + s * s;
            sum += nodes16[i][1] * 2.0 * s * r * arcs(f, r);
        }
    return half * sum;
}

static int compare(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Radii at which the shape of the arcs changes: sides and corners. */
static void breakpoints(const field *f, double list[8])
{
    for (int q = 0; q < 4; q++) {
        list[q] = fabs(f->side[q]);
        list[4 + q] = hypot(f->side[q], f->side[(q + 1) % 4]);
    }
    qsort(list, 8, sizeof *list, compare);
}

double pm__mass_rectangle(double (*irradiance)(const double *values, double x, double y), const double *values,
                          const pm__rectangle *rectangle, const pm__probe *probe, double r0, double r1)
{
    const double x = probe->position[0], y = probe->position[1];
    field f = {.irradiance = irradiance, .values = values, .x = x, .y = y,
               .side = {rectangle->x1 - x, rectangle->y1 - y, x - rectangle->x0, y - rectangle->y0}};
    const double nearest = fmin(fmin(f.side[0], f.side[1]), fmin(f.side[2], f.side[3]));
    double list[8], sum = 0.0, a = r0;
    breakpoints(&f, list);
    for (int i = 0; i <= 8 && a < r1; i++) {
        const double b = i < 8 ? fmin(list[i], r1) : r1;
        if (b <= a)
            continue;
        sum += b <= nearest ? full_ring(&f, a, b) : cut_ring(&f, a, b);
        a = b;
    }
    return sum;
}

/* ---- Small things ---- */

bool pm__holds_disc(const pm__rectangle *rectangle, const pm__probe *probe, double r)
{
    const double x = probe->position[0], y = probe->position[1];
    return x - r >= rectangle->x0 && x + r <= rectangle->x1 && y - r >= rectangle->y0 && y + r <= rectangle->y1;
}

double pm__shell_area(const pm__rectangle *rectangle, const pm__probe *probe, double r0, double r1)
{
    const double x = probe->position[0], y = probe->position[1];
    const pm__rectangle *const b = rectangle;
    return pm__disc_rectangle_area(x, y, r1, b->x0, b->x1, b->y0, b->y1) -
           pm__disc_rectangle_area(x, y, r0, b->x0, b->x1, b->y0, b->y1);
}

void pm__probe_rectangle(const pm__rectangle *rectangle, const double *u, pm__probe *probe)
{
    *probe = (pm__probe){.position = {rectangle->x0 + u[0] * (rectangle->x1 - rectangle->x0),
                                      rectangle->y0 + u[1] * (rectangle->y1 - rectangle->y0), 0.0},
                         .normal = {0.0, 0.0, 1.0}};
}

void pm__probe_ring(double x, double y, double r0, double r1, const double *u, pm__probe *probe)
{
    const double r = sqrt(r0 * r0 + u[0] * (r1 * r1 - r0 * r0)), phi = 2.0 * pi * u[1];
    *probe = (pm__probe){.position = {x + r * cos(phi), y + r * sin(phi), 0.0}, .normal = {0.0, 0.0, 1.0}};
}

void pm__photon_down(double x, double y, double position[3], double direction[3], double normal[3])
{
    position[0] = x;
    position[1] = y;
    position[2] = direction[0] = direction[1] = normal[0] = normal[1] = 0.0;
    direction[2] = -1.0;
    normal[2] = 1.0;
}

bool pm__accepts_down(const pm__probe *probe, const pm__shape *shape)
{
    return !shape->front_only || probe->normal[2] > 0.0;
}

void pm__concentric(const double *u, double point[2])
{
    const double a = 2.0 * u[0] - 1.0, b = 2.0 * u[1] - 1.0;
    const bool wide = fabs(a) > fabs(b);
    const double r = wide ? a : b;
    const double angle = r == 0.0 ? 0.0 : 0.25 * pi * (wide ? b : a) / r;
    point[0] = wide ? r * cos(angle) : r * sin(angle);
    point[1] = wide ? r * sin(angle) : r * cos(angle);
}

void pm__aspect_square(const double *values, double aspect[2])
{
    (void)values;
    aspect[0] = aspect[1] = 1.0;
}
