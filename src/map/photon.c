/* The 20-byte photon of [C02] 2.1.3: Ward's shared-exponent power and two bytes of direction. */
#include "../photonmap.h"

#include <math.h>
#include <string.h>

enum { EXPONENT_BIAS = 128, MAX_EXPONENT = 255 - EXPONENT_BIAS };

static const double pi = 3.14159265358979323846;
static const float smallest_power = 1e-38f;

static float usable_power(float power)
{
    return isfinite(power) && power > 0.0f ? power : 0.0f;
}

/* The cell of `fraction` (0 to 1) among 256 (errata 22: all 256 are used); NaN falls into the first. */
static uint8_t cell(double fraction)
{
    const double scaled = fraction * 256.0;
    if (!(scaled > 0.0))
        return 0;
    return scaled < 255.0 ? (uint8_t)scaled : 255;
}

static void pack_power(const float power[3], uint8_t rgbe[4])
{
    const float r = usable_power(power[0]), g = usable_power(power[1]), b = usable_power(power[2]);
    const float largest = fmaxf(r, fmaxf(g, b));
    memset(rgbe, 0, 4);
    if (largest < smallest_power)
        return;
    int exponent;
    (void)frexpf(largest, &exponent);
    if (exponent > MAX_EXPONENT)
        exponent = MAX_EXPONENT;
    const double scale = ldexp(1.0, -exponent);
    rgbe[0] = cell((double)r * scale);
    rgbe[1] = cell((double)g * scale);
    rgbe[2] = cell((double)b * scale);
    rgbe[3] = (uint8_t)(exponent + EXPONENT_BIAS);
}

/* Errata 24: the middle of the code's cell. A band that was exactly 0 beside others that were not comes back as
 * half a step, for code 0 also stands for all that is less than a step: within the bound, and unbiased. */
static void unpack_power(const uint8_t rgbe[4], float power[3])
{
    const double step = rgbe[3] ? ldexp(1.0, (int)rgbe[3] - EXPONENT_BIAS - 8) : 0.0;
    for (int band = 0; band < 3; band++)
        power[band] = (float)(((double)rgbe[band] + 0.5) * step);
}

void pm_photon_pack(const pm_photon *photon, pm_packed_photon *packed)
{
    const double x = (double)photon->direction[0], y = (double)photon->direction[1], z = (double)photon->direction[2];
    memcpy(packed->position, photon->position, sizeof packed->position);
    pack_power(photon->power, packed->rgbe);
    /* Errata 21: theta is the angle to z. The arctangent needs no unit length, and keeps its digits at the poles. */
    packed->theta = cell(atan2(hypot(x, y), z) / pi);
    packed->phi = cell((atan2(y, x) + pi) / (2.0 * pi));
    packed->flags = 0;
}

void pm_photon_unpack(const pm_packed_photon *packed, pm_photon *photon)
{
    const double theta = ((double)packed->theta + 0.5) * (pi / 256.0);
    const double phi = ((double)packed->phi + 0.5) * (pi / 128.0) - pi;
    memcpy(photon->position, packed->position, sizeof photon->position);
    photon->direction[0] = (float)(sin(theta) * cos(phi));
    photon->direction[1] = (float)(sin(theta) * sin(phi));
    photon->direction[2] = (float)cos(theta);
    unpack_power(packed->rgbe, photon->power);
}
