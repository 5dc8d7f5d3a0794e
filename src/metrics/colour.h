/* Colour spaces of FLIP (Andersson et al. 2020, section 4.1), from linear sRGB primaries with the white of D65. */
#ifndef PM_METRICS_COLOUR_H
#define PM_METRICS_COLOUR_H

/* CIE XYZ over the white's, of linear R G B: white is (1, 1, 1). And back. */
void pm__rgb_to_xyz(const double rgb[3], double xyz[3]);
void pm__xyz_to_rgb(const double xyz[3], double rgb[3]);

/* YCxCz, a linear opponent space: Y -16 (black) to 100 (white); Cx red to green, Cz yellow to blue. And back. */
void pm__rgb_to_ycxcz(const double rgb[3], double ycxcz[3]);
void pm__ycxcz_to_rgb(const double ycxcz[3], double rgb[3]);

/* CIE L*a*b* with a* and b* times 0.01 L*: colours are less colourful in the dark (Hunt). rgb: 0 to 1. */
void pm__rgb_to_hunt_lab(const double rgb[3], double lab[3]);

/* |difference in L*| + the Euclidean distance in (a*, b*) (Abasi et al. 2020). */
double pm__hyab(const double a[3], const double b[3]);

#endif
