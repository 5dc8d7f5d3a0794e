/* Glossy materials. Schlick's model as [J96a] eq. 5 has it is, for v, v' the cosines of the two directions to the
 * normal and t that of their half vector h,
 *     (1 - G G') / pi + G G' Z / (4 pi v v'),   Z = alpha / (1 + alpha t^2 - t^2)^2,   G = v / (alpha - alpha v + v),
 * with two faults: the printed t is always +-1 (erratum 25), and the first term adds light: the sum reflects up to 1.76
 * of what comes in (erratum 26). The form here keeps the lobe and its Z, and mixes Lambert in by albedos of their own:
 *     f = d / pi + s G G' Z / (4 pi v v').
 * With q = t^2, the integral of (Z / pi) t over half vectors is that of alpha / (1 - (1 - alpha) q)^2 for q from 0
 * to 1, which is 1: Z / pi is a density of facets by their projected area (the one known as GGX, of width
 * sqrt(alpha)). Facets that mirror and hide each other reflect at most what comes in if, from any direction v, those
 * that are seen add up to its own projection: the integral of G <v, h> Z / pi over h must be v. That fixes Smith's
 *     G = 2 v / (v + sqrt(alpha + (1 - alpha) v^2)),
 * of which Schlick's G is a rational fit, too large for small alpha: the lobe's albedo gets up to 1.01 with it. So G is
 * Smith's. The albedo is at most s at every angle, since a facet is seen from v with density G Z <v, h> / (pi v), the
 * lobe reflects into v' with that times G' s, and G' <= 1; and the form is the same under exchange of v and v'.
 * Sampled so: a facet by that density, then on with chance G'. Photons keep their power. */
#include "material.h"

#include "../base/turn.h"
#include "rough.h"

enum { BANDS = 3 };

static const double pi = 3.14159265358979323846;

double pm__fresnel(double cosine, double eta, double *refracted)
{
    const double sine2 = (1.0 - cosine * cosine) / (eta * eta);
    if (sine2 >= 1.0) {
        *refracted = 0.0;
        return 1.0;
    }
    const double far = sqrt(1.0 - sine2);
    const double s = (cosine - eta * far) / (cosine + eta * far);
    const double p = (eta * cosine - far) / (eta * cosine + far);
    *refracted = far;
    return 0.5 * (s * s + p * p);
}

void pm__attenuate(const double absorption[3], double distance, double power[3])
{
    for (int b = 0; b < BANDS; b++)
        if (absorption[b] > 0.0)
            power[b] *= exp(-absorption[b] * distance);
}

void pm__beer(const pm__material *material, double distance, double power[3])
{
    pm__attenuate(material->absorption, distance, power);
}

/* ---- Glossy ---------------------------------------------------------------------------------- */

static double lobe(const double normal[3], const double in[3], const double out[3], double alpha)
{
    double half[3], across[3];
    for (int i = 0; i < 3; i++)
        half[i] = in[i] + out[i];
    pm__normalize_near(half);
    /* 1 - t^2 by the cross product: alpha may be far below the rounding of t^2. */
    pm__cross(normal, half, across);
    const double t = pm__dot(normal, half), w = alpha * t * t + pm__dot(across, across);
    const double g = pm__masking_over_cosine(pm__dot(normal, in), alpha) *
                     pm__masking_over_cosine(pm__dot(normal, out), alpha);
    return g * alpha / (4.0 * pi * w * w);
}

/* [J96a] eq. 5 to the letter, diffuse and specular scaling its terms: t^2 = 1, so Z = 1 / alpha (erratum 25). */
static void printed_brdf(const pm__material *material, const double albedo[3], double v, double w, double value[3])
{
    const double alpha = pm__alpha(material);
    const double g = 1.0 / ((alpha - alpha * v + v) * (alpha - alpha * w + w)); /* G G' / (v v') */
    for (int b = 0; b < BANDS; b++)
        value[b] = albedo[b] * (1.0 - g * v * w) / pi + material->specular[b] * g / (4.0 * pi * alpha);
}

void pm__material_brdf(const pm__material *material, const double normal[3], const double in[3], const double out[3],
                       double value[3])
{
    const double v = pm__dot(normal, in), w = pm__dot(normal, out);
    value[0] = value[1] = value[2] = 0.0;
    if (!pm__is_rough(material) || !(v * w > 0.0))
        return;
    const double *const albedo = material->two_sided && v < 0.0 ? material->back : material->diffuse;
    const double sign = v < 0.0 ? -1.0 : 1.0, facing[3] = {sign * normal[0], sign * normal[1], sign * normal[2]};
    if (material->kind == PM__GLOSSY && material->printed) {
        printed_brdf(material, albedo, fabs(v), fabs(w), value);
        return;
    }
    const double peak = material->kind == PM__GLOSSY ? lobe(facing, in, out, pm__alpha(material)) : 0.0;
    for (int b = 0; b < BANDS; b++)
        value[b] = albedo[b] / pi + material->specular[b] * peak;
}

/* ---- Scattering ------------------------------------------------------------------------------ */

static void mirrored(const double normal[3], const double incoming[3], double outgoing[3])
{
    const double twice = 2.0 * pm__dot(normal, incoming);
    for (int i = 0; i < 3; i++)
        outgoing[i] = incoming[i] - twice * normal[i];
    pm__normalize_known(outgoing); /* unit but for rounding */
}

static void scale(double power[3], const double albedo[3], double factor)
{
    for (int b = 0; b < BANDS; b++)
        power[b] *= albedo[b] * factor;
}

static pm__event scatter_diffuse(const double albedo[3], const double facing[3], const double u[3], double power[3],
                                 double outgoing[3])
{
    const double none[3] = {0.0, 0.0, 0.0};
    const double chance = pm__roulette(albedo, none, power).diffuse;
    if (!(u[0] < chance))
        return PM__ABSORBED;
    scale(power, albedo, 1.0 / chance);
    pm__cosine_direction(facing, u[1], u[2], outgoing);
    return PM__REFLECTED_DIFFUSE;
}

static pm__event scatter_glossy(const pm__material *material, const double albedo[3], const double facing[3],
                                const double incoming[3], const double u[3], double power[3], double outgoing[3])
{
    const pm__chances chance = pm__roulette(albedo, material->specular, power);
    if (u[0] < chance.diffuse) {
        scale(power, albedo, 1.0 / chance.diffuse);
        pm__cosine_direction(facing, u[1], u[2], outgoing);
        return PM__REFLECTED_DIFFUSE;
    }
    const double rest = (u[0] - chance.diffuse) / chance.specular; /* uniform again, or not below 1 */
    if (!(rest < 1.0))
        return PM__ABSORBED;
    const double alpha = pm__alpha(material), from[3] = {-incoming[0], -incoming[1], -incoming[2]};
    double facet[3];
    pm__sample_facet(facing, from, alpha, u[1], u[2], facet);
    mirrored(facet, incoming, outgoing);
    const double cosine = pm__dot(facing, outgoing);
    if (!(cosine > 0.0 && rest < cosine * pm__masking_over_cosine(cosine, alpha)))
        return PM__ABSORBED;
    scale(power, material->specular, 1.0 / chance.specular);
    return PM__REFLECTED_SPECULAR;
}

/* The printed formula reflects more than comes in: powers then grow. */
static pm__event scatter_printed(const pm__material *material, const double albedo[3], const double facing[3],
                                 const double incoming[3], const double u[3], double power[3], double outgoing[3])
{
    double value[3], on[3];
    pm__cosine_direction(facing, u[1], u[2], outgoing);
    printed_brdf(material, albedo, -pm__dot(facing, incoming), pm__dot(facing, outgoing), value);
    for (int b = 0; b < BANDS; b++)
        on[b] = pi * value[b] * power[b];
    const double chance = fmin(1.0, pm__largest(on) / pm__largest(power));
    if (!(u[0] < chance))
        return PM__ABSORBED;
    for (int b = 0; b < BANDS; b++)
        power[b] = on[b] / chance;
    return PM__REFLECTED_DIFFUSE;
}

static pm__event scatter_mirror(const double reflectance[3], const double facing[3], const double incoming[3], double u,
                                double power[3], double outgoing[3])
{
    const double none[3] = {0.0, 0.0, 0.0};
    const double chance = pm__roulette(none, reflectance, power).specular;
    if (!(u < chance))
        return PM__ABSORBED;
    scale(power, reflectance, 1.0 / chance);
    mirrored(facing, incoming, outgoing);
    return PM__REFLECTED_SPECULAR;
}

/* The index of refraction that a photon bends by. Where those of its bands differ it goes on in one, with all its
 * power: each band keeps its power on average. */
static double choose_index(const double ior[3], double u, double power[3])
{
    const double total = pm__sum(power);
    int band = 0;
    for (double sum = power[0]; band < BANDS - 1 && !(u * total < sum); sum += power[band])
        band++;
    while (!(power[band] > 0.0)) /* by rounding at the end of the range */
        band--;
    bool alike = true;
    for (int b = 0; b < BANDS; b++)
        alike = alike && (ior[b] == ior[band] || !(power[b] > 0.0));
    for (int b = 0; b < BANDS && !alike; b++)
        power[b] = b == band ? total : 0.0;
    return ior[band];
}

static pm__event scatter_glass(const pm__material *material, bool front, const double facing[3],
                               const double incoming[3], const double u[3], double power[3], double outgoing[3])
{
    const double ior = choose_index(material->ior, u[1], power), eta = front ? ior : 1.0 / ior;
    const double cosine = fmin(1.0, -pm__dot(facing, incoming));
    double far;
    if (u[0] < pm__fresnel(cosine, eta, &far)) {
        mirrored(facing, incoming, outgoing);
        return PM__REFLECTED_SPECULAR;
    }
    for (int i = 0; i < 3; i++)
        outgoing[i] = incoming[i] / eta + (cosine / eta - far) * facing[i];
    pm__normalize_known(outgoing); /* unit but for rounding */
    return PM__TRANSMITTED;
}

pm__event pm__scatter(const pm__material *material, const double normal[3], const double incoming[3], const double u[3],
                      double power[3], double outgoing[3])
{
    if (!(pm__largest(power) > 0.0))
        return PM__ABSORBED;
    const bool front = pm__dot(normal, incoming) < 0.0;
    const double sign = front ? 1.0 : -1.0, facing[3] = {sign * normal[0], sign * normal[1], sign * normal[2]};
    const double *const albedo = material->two_sided && !front ? material->back : material->diffuse;
    switch (material->kind) {
    case PM__DIFFUSE:
        return scatter_diffuse(albedo, facing, u, power, outgoing);
    case PM__GLOSSY:
        return material->printed ? scatter_printed(material, albedo, facing, incoming, u, power, outgoing)
                                 : scatter_glossy(material, albedo, facing, incoming, u, power, outgoing);
    case PM__MIRROR:
        return scatter_mirror(material->specular, facing, incoming, u[0], power, outgoing);
    case PM__GLASS:
        return scatter_glass(material, front, facing, incoming, u, power, outgoing);
    case PM__BLACK:
        break;
    }
    return PM__ABSORBED;
}

/* ---- Checks ---------------------------------------------------------------------------------- */

static pm_status check_bands(const char *name, const double value[3], double low, double high, pm_error *error)
{
    for (int b = 0; b < BANDS; b++)
        if (!(value[b] >= low && value[b] <= high))
            return pm__fail(error, PM_EINVAL, "a material's %s[%d] is %g, not within %g and %g", name, b, value[b], low,
                            high);
    return PM_OK;
}

static pm_status check_sum(const char *name, const double albedo[3], const double specular[3], pm_error *error)
{
    for (int b = 0; b < BANDS; b++)
        if (!(albedo[b] + specular[b] <= 1.0 + 1e-12))
            return pm__fail(error, PM_EINVAL, "a glossy material's %s and specular add up to %g > 1 in band %d",
                            name, albedo[b] + specular[b], b);
    return PM_OK;
}

static pm_status check_rough(const pm__material *material, pm_error *error)
{
    pm_status status = check_bands("diffuse", material->diffuse, 0.0, 1.0, error);
    if (!status && material->two_sided)
        status = check_bands("back", material->back, 0.0, 1.0, error);
    if (status || material->kind == PM__DIFFUSE)
        return status;
    if (!(material->roughness >= 0.0 && material->roughness <= 1.0))
        return pm__fail(error, PM_EINVAL, "a material's roughness is %g, not within 0 and 1", material->roughness);
    status = check_bands("specular", material->specular, 0.0, 1.0, error);
    if (status || material->printed) /* the printed formula adds light whatever its albedos */
        return status;
    status = check_sum("diffuse", material->diffuse, material->specular, error);
    return status || !material->two_sided ? status : check_sum("back", material->back, material->specular, error);
}

pm_status pm__material_check(const pm__material *material, pm_error *error)
{
    switch (material->kind) {
    case PM__DIFFUSE:
    case PM__GLOSSY:
        return check_rough(material, error);
    case PM__MIRROR:
        return check_bands("specular", material->specular, 0.0, 1.0, error);
    case PM__GLASS: {
        pm_status status = check_bands("ior", material->ior, 1e-3, 1e3, error);
        if (!status)
            status = check_bands("absorption", material->absorption, 0.0, 1e30, error);
        return status ? status : check_bands("outside", material->outside, 0.0, 1e30, error);
    }
    case PM__BLACK:
        return PM_OK;
    }
    return pm__fail(error, PM_EINVAL, "a material's kind is %d, which is none", (int)material->kind);
}
