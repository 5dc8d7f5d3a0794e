#include "coverage.h"

#include "../base/vec3.h"

/* Does a ray down the normal through `point` meet the surface, from the same side of what it is made of as in the
 * middle of the disc? side: of the middle; 0 takes and returns whichever it is. */
static int look_down(const pm__scene *scene, const double point[3], const double normal[3], double height, int side)
{
    double from[3], down[3];
    pm__hit hit;
    for (int i = 0; i < 3; i++) {
        from[i] = point[i] + height * normal[i];
        down[i] = -normal[i];
    }
    if (!pm__scene_intersect(scene, from, down, 2.0 * height, PM__NO_SHAPE, &hit))
        return 0;
    const double facing = -pm__dot(hit.normal, down);
    const int met = facing > 0.9 ? 1 : facing < -0.9 ? -1 : 0; /* as stored irradiance asks of normals */
    return !side || met == side ? met : 0;
}

void pm__coverage_find(const pm__scene *scene, const double position[3], const double normal[3], double radius,
                       double phase, pm__coverage *coverage)
{
    const double golden = 2.399963229728653, height = 0.25 * radius; /* pi (3 - sqrt 5): even at every size */
    double s[3], t[3];
    pm__basis(normal, s, t);
    const int side = look_down(scene, position, normal, height, 0);
    for (int i = 0; i < PM__DISC_POINTS; i++) {
        const double r = radius * sqrt((i + 0.5) / PM__DISC_POINTS), turn = golden * i + 6.283185307179586 * phase;
        double point[3];
        for (int a = 0; a < 3; a++)
            point[a] = position[a] + r * (cos(turn) * s[a] + sin(turn) * t[a]);
        coverage->there[i] = !side || look_down(scene, point, normal, height, side);
    }
}

double pm__coverage_share(const pm__coverage *coverage, const pm__spec *spec)
{
    const pm__estimator *const estimator = pm__estimator_of(spec);
    double on = 0.0, all = 0.0;
    if (estimator->needs & PM__OFFSETS)
        return 1.0;
    for (int i = 0; i < PM__DISC_POINTS; i++) {
        const double t2 = (i + 0.5) / PM__DISC_POINTS;
        const double weight = estimator->weight ? estimator->weight(spec->values, t2) : 1.0;
        on += coverage->there[i] ? weight : 0.0;
        all += weight;
    }
    return on > 0.0 ? on / all : 1.0 / PM__DISC_POINTS;
}
