#include "colour.h"

#include <math.h>

/* Rows X Y Z over those of the white (1, 1, 1), which are the sums of the rows: from the chromaticities of IEC
 * 61966-2-1, red (0.64, 0.33), green (0.30, 0.60), blue (0.15, 0.06), white (0.3127, 0.3290). */
static const double to_xyz[3][3] = {
    {10135552.0 / 23359437.0, 8788810.0 / 23359437.0, 4435075.0 / 23359437.0},
    {2613072.0 / 12288897.0, 8788810.0 / 12288897.0, 887015.0 / 12288897.0},
    {1425312.0 / 80288307.0, 8788810.0 / 80288307.0, 70074185.0 / 80288307.0},
};

/* Minor of `to_xyz` without row i and column j, with its sign. */
static double cofactor(int i, int j)
{
    const int a = (i + 1) % 3, b = (i + 2) % 3, c = (j + 1) % 3, d = (j + 2) % 3;
    return to_xyz[a][c] * to_xyz[b][d] - to_xyz[a][d] * to_xyz[b][c];
}

void pm__rgb_to_xyz(const double rgb[3], double xyz[3])
{
    for (int i = 0; i < 3; i++)
        xyz[i] = to_xyz[i][0] * rgb[0] + to_xyz[i][1] * rgb[1] + to_xyz[i][2] * rgb[2];
}

/* Cramer's rule. */
void pm__xyz_to_rgb(const double xyz[3], double rgb[3])
{
    const double all = to_xyz[0][0] * cofactor(0, 0) + to_xyz[0][1] * cofactor(0, 1) + to_xyz[0][2] * cofactor(0, 2);
    for (int j = 0; j < 3; j++)
        rgb[j] = (cofactor(0, j) * xyz[0] + cofactor(1, j) * xyz[1] + cofactor(2, j) * xyz[2]) / all;
}

void pm__rgb_to_ycxcz(const double rgb[3], double ycxcz[3])
{
    double xyz[3];
    pm__rgb_to_xyz(rgb, xyz);
    ycxcz[0] = 116.0 * xyz[1] - 16.0;
    ycxcz[1] = 500.0 * (xyz[0] - xyz[1]);
    ycxcz[2] = 200.0 * (xyz[1] - xyz[2]);
}

void pm__ycxcz_to_rgb(const double ycxcz[3], double rgb[3])
{
    const double y = (ycxcz[0] + 16.0) / 116.0;
    pm__xyz_to_rgb((const double[]){y + ycxcz[1] / 500.0, y, y - ycxcz[2] / 200.0}, rgb);
}

/* CIE 15: the cube root, continued by its tangent below (6/29)^3. */
static double lab_curve(double t)
{
    const double d = 6.0 / 29.0;
    return t > d * d * d ? cbrt(t) : t / (3.0 * d * d) + 4.0 / 29.0;
}

void pm__rgb_to_hunt_lab(const double rgb[3], double lab[3])
{
    double xyz[3];
    pm__rgb_to_xyz(rgb, xyz);
    const double x = lab_curve(xyz[0]), y = lab_curve(xyz[1]), z = lab_curve(xyz[2]);
    lab[0] = 116.0 * y - 16.0;
    lab[1] = 0.01 * lab[0] * 500.0 * (x - y);
    lab[2] = 0.01 * lab[0] * 200.0 * (y - z);
}

double pm__hyab(const double a[3], const double b[3])
{
    return fabs(a[0] - b[0]) + hypot(a[1] - b[1], a[2] - b[2]);
}
