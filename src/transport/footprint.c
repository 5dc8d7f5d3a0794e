#include "footprint.h"

#include "../scene/rough.h"

#include <math.h>
#include <string.h>

enum { KEPT = 4 }; /* a place on a surface and a direction are four numbers: four vectors do for any more */

static const double pi = 3.14159265358979323846;

void pm__footprint_begin(pm__footprint *footprint, const pm__camera *camera, double x, double y)
{
    const double *const step[2] = {camera->right, camera->down};
    double direction[3];
    for (int i = 0; i < 3; i++)
        direction[i] = camera->corner[i] + x * camera->right[i] + y * camera->down[i];
    const double length = pm__normalize(direction);
    footprint->count = 2;
    for (int n = 0; n < 2; n++) {
        const double along = pm__dot(step[n], direction);
        for (int i = 0; i < 3; i++) {
            footprint->place[n][i] = 0.0;
            footprint->way[n][i] = (step[n][i] - along * direction[i]) / length;
        }
    }
}

/* Igehy 1999, eq. 10 to 12. */
void pm__footprint_arrive(pm__footprint *footprint, const double direction[3], const pm__hit *hit)
{
    const double cosine = pm__dot(direction, hit->normal);
    for (int n = 0; n < footprint->count; n++) {
        double *const place = footprint->place[n];
        for (int i = 0; i < 3; i++)
            place[i] += hit->distance * footprint->way[n][i];
        const double off = pm__dot(place, hit->normal) / cosine;
        for (int i = 0; i < 3; i++)
            place[i] -= off * direction[i];
    }
}

static void times(double matrix[3][3], const double v[3], double product[3])
{
    for (int i = 0; i < 3; i++)
        product[i] = pm__dot(matrix[i], v);
}

/* ---- Mirrors and glass ------------------------------------------------------------------------- */

/* d (D - 2 (D N) N). */
static void mirror(const double normal[3], const double change[3], const double in[3], double way[3])
{
    const double cosine = pm__dot(in, normal), by = pm__dot(way, normal) + pm__dot(in, change);
    for (int i = 0; i < 3; i++)
        way[i] -= 2.0 * (cosine * change[i] + by * normal[i]);
}

/* d (D / eta + (c / eta - f) N), c = -D N, f^2 = 1 - (1 - c^2) / eta^2: N toward the ray. */
static void refract(const double facing[3], const double change[3], const double in[3], double eta, double way[3])
{
    const double c = -pm__dot(in, facing), f = sqrt(1.0 - (1.0 - c * c) / (eta * eta));
    const double dc = -(pm__dot(way, facing) + pm__dot(in, change)), df = c * dc / (eta * eta * f);
    for (int i = 0; i < 3; i++)
        way[i] = way[i] / eta + (dc / eta - df) * facing[i] + (c / eta - f) * change[i];
}

void pm__footprint_pass(pm__footprint *footprint, const pm__scene *scene, const pm__hit *hit, const double in[3],
                        const double out[3], double ior)
{
    double bend[3][3];
    const bool curved = pm__scene_bend(scene, hit, bend), front = pm__dot(in, hit->normal) < 0.0;
    const bool through = pm__dot(in, hit->normal) * pm__dot(out, hit->normal) > 0.0;
    const double sign = front ? 1.0 : -1.0, eta = front ? ior : 1.0 / ior;
    double facing[3];
    for (int i = 0; i < 3; i++)
        facing[i] = sign * hit->normal[i];
    for (int n = 0; n < footprint->count; n++) {
        double change[3] = {0.0, 0.0, 0.0};
        if (curved)
            times(bend, footprint->place[n], change);
        for (int i = 0; i < 3; i++)
            change[i] *= sign;
        if (through)
            refract(facing, change, in, eta, footprint->way[n]);
        else
            mirror(facing, change, in, footprint->way[n]);
    }
}

/* ---- Rough bounces ----------------------------------------------------------------------------- */

/* As many vectors as KEPT that have the same sum of v v^T: by Cholesky. A row is (place, way), in tangents of the
 * surface and of the direction. */
static void factor(double c[KEPT][KEPT], double rows[KEPT][KEPT])
{
    memset(rows, 0, KEPT * sizeof *rows);
    for (int n = 0; n < KEPT; n++) {
        double pivot = c[n][n];
        for (int m = 0; m < n; m++)
            pivot -= rows[m][n] * rows[m][n];
        if (!(pivot > 1e-14 * c[n][n])) /* nothing but rounding: the ones before say it all */
            continue;
        rows[n][n] = sqrt(pivot);
        for (int j = n + 1; j < KEPT; j++) {
            double sum = c[n][j];
            for (int m = 0; m < n; m++)
                sum -= rows[m][n] * rows[m][j];
            rows[n][j] = sum / rows[n][n];
        }
    }
}

static void condense(pm__footprint *footprint, const double normal[3], const double out[3])
{
    double axes[KEPT][3], c[KEPT][KEPT] = {{0.0}}, rows[KEPT][KEPT];
    pm__basis(normal, axes[0], axes[1]);
    pm__basis(out, axes[2], axes[3]);
    for (int n = 0; n < footprint->count; n++) {
        double v[KEPT];
        for (int i = 0; i < KEPT; i++)
            v[i] = pm__dot(i < 2 ? footprint->place[n] : footprint->way[n], axes[i]);
        for (int i = 0; i < KEPT; i++)
            for (int j = 0; j < KEPT; j++)
                c[i][j] += v[i] * v[j];
    }
    factor(c, rows);
    footprint->count = KEPT;
    for (int n = 0; n < KEPT; n++)
        for (int i = 0; i < 3; i++) {
            footprint->place[n][i] = rows[n][0] * axes[0][i] + rows[n][1] * axes[1][i];
            footprint->way[n][i] = rows[n][2] * axes[2][i] + rows[n][3] * axes[3][i];
        }
}

/* Two numbers of their own: the vertex stays, the direction moves over the solid angle. */
static void add_numbers(pm__footprint *footprint, const double out[3], double density)
{
    double axes[2][3];
    const double length = sqrt(1.0 / density);
    pm__basis(out, axes[0], axes[1]);
    for (int n = 0; n < 2; n++, footprint->count++)
        for (int i = 0; i < 3; i++) {
            footprint->place[footprint->count][i] = 0.0;
            footprint->way[footprint->count][i] = length * axes[n][i];
        }
}

/* By which density a rough surface sends paths into `out`, 1/sr, if it sends them on at all; *facet: set to the normal
 * of the facet that mirrors there, if that is how most of them got there; else false. */
static bool densest(const pm__material *material, const double facing[3], bool front, const double in[3],
                    const double out[3], const double weight[3], double facet[3], double *density)
{
    const double cosine = pm__dot(facing, out);
    *density = cosine / pi;
    if (material->kind != PM__GLOSSY || material->printed)
        return false;
    const pm__chances chance =
        pm__roulette(material->two_sided && !front ? material->back : material->diffuse, material->specular, weight);
    const double alpha = pm__alpha(material);
    double across[3];
    for (int i = 0; i < 3; i++)
        facet[i] = out[i] - in[i];
    (void)pm__normalize(facet);
    pm__cross(facing, facet, across);
    const double t = pm__dot(facing, facet), w = alpha * t * t + pm__dot(across, across);
    /* That of visible facets, over 4 <v, h>: as pm__sample_facet has them. */
    const double lobe = pm__masking_over_cosine(-pm__dot(facing, in), alpha) * alpha / (4.0 * pi * w * w);
    const double by_lobe = chance.specular * lobe, by_base = chance.diffuse * *density;
    *density = (by_lobe + by_base) / (chance.specular + chance.diffuse);
    return by_lobe > by_base;
}

/* omega: the surface turns by it as the vertex moves. */
static void turn(const double omega[3], const double in[3], const double out[3], const double *facet, double way[3])
{
    double moved[3];
    if (facet) {
        pm__cross(omega, facet, moved);
        mirror(facet, moved, in, way);
    } else {
        pm__cross(omega, out, way);
    }
}

void pm__footprint_bounce(pm__footprint *footprint, const pm__scene *scene, const pm__hit *hit, const double in[3],
                          const double out[3], const double weight[3])
{
    double bend[3][3], facing[3], facet[3], density;
    const bool curved = pm__scene_bend(scene, hit, bend), front = pm__dot(in, hit->normal) < 0.0;
    for (int i = 0; i < 3; i++)
        facing[i] = front ? hit->normal[i] : -hit->normal[i];
    const bool mirrored = densest(hit->material, facing, front, in, out, weight, facet, &density);
    for (int n = 0; n < footprint->count; n++) {
        double omega[3] = {0.0, 0.0, 0.0}, change[3];
        if (curved) { /* the same about either side's normal */
            times(bend, footprint->place[n], change);
            pm__cross(hit->normal, change, omega);
        }
        turn(omega, in, out, mirrored ? facet : NULL, footprint->way[n]);
    }
    if (footprint->count > KEPT)
        condense(footprint, hit->normal, out);
    add_numbers(footprint, out, density);
}

/* det(sum of v v^T) is the sum over pairs of (v x w)^2 (Cauchy and Binet). */
double pm__footprint_area(const pm__footprint *footprint)
{
    double sum = 0.0;
    for (int n = 0; n < footprint->count; n++)
        for (int m = 0; m < n; m++) {
            double across[3];
            pm__cross(footprint->place[n], footprint->place[m], across);
            sum += pm__dot(across, across);
        }
    return sqrt(sum);
}
