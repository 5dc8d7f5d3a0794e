/* FLIP, HDR-FLIP and SSIM a second time: sums over whole squares of weights, in long double, from the papers' equations
 * and constants. */
#include "../metrics.h"

#include <string.h>

enum { W = 23, H = 17 };

typedef long double plane[H][W];

static int kept(int i, int size)
{
    return i < 0 ? 0 : i >= size ? size - 1 : i;
}

typedef long double weight_of(long double x, long double y, const long double *p);

/* Weights over the square: positive ones sum to 1, negative ones to -1. */
static void filter_square(plane from, int radius, weight_of *weight, const long double *p, plane to)
{
    long double above = 0.0L, below = 0.0L;
    for (int j = -radius; j <= radius; j++)
        for (int i = -radius; i <= radius; i++) {
            const long double w = weight(i, j, p);
            *(w > 0.0L ? &above : &below) += w;
        }
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            long double sum = 0.0L;
            for (int j = -radius; j <= radius; j++)
                for (int i = -radius; i <= radius; i++) {
                    const long double w = weight(i, j, p);
                    sum += (w > 0.0L ? w / above : below < 0.0L ? -w / below : 0.0L) *
                           from[kept(y + j, H)][kept(x + i, W)];
                }
            to[y][x] = sum;
        }
}

static const long double pi = 3.14159265358979323846264338327950288L;

/* p: pixels to the degree, a1, b1, a2, b2. */
static long double csf(long double x, long double y, const long double *p)
{
    const long double z = (x * x + y * y) / (p[0] * p[0]);
    return p[1] * sqrtl(pi / p[2]) * expl(-pi * pi * z / p[2]) + p[3] * sqrtl(pi / p[4]) * expl(-pi * pi * z / p[4]);
}

/* p: standard deviation, in pixels; order of the derivative; 1: down, not along. */
static long double derivative(long double x, long double y, const long double *p)
{
    const long double at = p[2] > 0.0L ? y : x, g = expl(-(x * x + y * y) / (2.0L * p[0] * p[0]));
    return p[1] < 1.5L ? -at * g : (at * at / (p[0] * p[0]) - 1.0L) * g;
}

static long double gauss(long double x, long double y, const long double *p)
{
    return expl(-(x * x + y * y) / (2.0L * p[0] * p[0]));
}

typedef struct picture {
    long double rgb[H][W][3];
} picture;

typedef struct sight {
    long double lab[H][W][3];
    plane edge, point;
} sight;

static long double cube_root(long double t)
{
    return t > 216.0L / 24389.0L ? cbrtl(t) : (24389.0L / 27.0L * t + 16.0L) / 116.0L;
}

/* X, Y, Z of linear sRGB, over the white's. */
static void xyz_of(const long double c[3], long double xyz[3])
{
    xyz[0] = (10135552.0L * c[0] + 8788810.0L * c[1] + 4435075.0L * c[2]) / 24577794.0L / 0.950428545377181L;
    xyz[1] = (2613072.0L * c[0] + 8788810.0L * c[1] + 887015.0L * c[2]) / 12288897.0L;
    xyz[2] = (1425312.0L * c[0] + 8788810.0L * c[1] + 70074185.0L * c[2]) / 73733382.0L / 1.08890037079813L;
}

static void hunt_lab(const long double c[3], long double lab[3])
{
    long double xyz[3];
    xyz_of(c, xyz);
    lab[0] = 116.0L * cube_root(xyz[1]) - 16.0L;
    lab[1] = 0.01L * lab[0] * 500.0L * (cube_root(xyz[0]) - cube_root(xyz[1]));
    lab[2] = 0.01L * lab[0] * 200.0L * (cube_root(xyz[1]) - cube_root(xyz[2]));
}

static void features(plane luminance, long double width, int order, plane out)
{
    static plane along, down;
    const int radius = (int)ceill(3.0L * width);
    filter_square(luminance, radius, derivative, (const long double[]){width, order, 0.0L}, along);
    filter_square(luminance, radius, derivative, (const long double[]){width, order, 1.0L}, down);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            out[y][x] = sqrtl(along[y][x] * along[y][x] + down[y][x] * down[y][x]);
}

static void see(const picture *in, long double ppd, sight *out)
{
    static plane channels[3], filtered[3], luminance;
    static const long double terms[3][4] = {{1.0L, 0.0047L, 0.0L, 1e-5L}, {1.0L, 0.0053L, 0.0L, 1e-5L},
                                            {34.1L, 0.04L, 13.5L, 0.025L}};
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            long double xyz[3];
            xyz_of(in->rgb[y][x], xyz);
            channels[0][y][x] = 116.0L * xyz[1] - 16.0L;
            channels[1][y][x] = 500.0L * (xyz[0] - xyz[1]);
            channels[2][y][x] = 200.0L * (xyz[1] - xyz[2]);
            luminance[y][x] = xyz[1];
        }
    const int radius = (int)ceill(3.0L * sqrtl(0.04L / (2.0L * pi * pi)) * ppd);
    for (int c = 0; c < 3; c++)
        filter_square(channels[c], radius, csf,
                      (const long double[]){ppd, terms[c][0], terms[c][1], terms[c][2], terms[c][3]}, filtered[c]);
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            /* The published inverse, with its ten digits. */
            static const long double back[3][3] = {{3.241003275L, -1.537398934L, -0.498615861L},
                                                   {-0.969224334L, 1.875930071L, 0.041554224L},
                                                   {0.055639423L, -0.204011202L, 1.057148933L}};
            const long double t = (filtered[0][y][x] + 16.0L) / 116.0L;
            const long double xyz[] = {(t + filtered[1][y][x] / 500.0L) * 0.950428545377181L, t,
                                       (t - filtered[2][y][x] / 200.0L) * 1.08890037079813L};
            long double rgb[3];
            for (int c = 0; c < 3; c++)
                rgb[c] = fminl(1.0L, fmaxl(0.0L, back[c][0] * xyz[0] + back[c][1] * xyz[1] + back[c][2] * xyz[2]));
            hunt_lab(rgb, out->lab[y][x]);
        }
    features(luminance, 0.5L * 0.082L * ppd, 1, out->edge);
    features(luminance, 0.5L * 0.082L * ppd, 2, out->point);
}

static long double hyab(const long double a[3], const long double b[3])
{
    return fabsl(a[0] - b[0]) + sqrtl((a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static void flip_again(const picture *a, const picture *b, long double ppd, plane out)
{
    static sight of_a, of_b;
    long double green[3], blue[3];
    see(a, ppd, &of_a);
    see(b, ppd, &of_b);
    hunt_lab((const long double[]){0.0L, 1.0L, 0.0L}, green);
    hunt_lab((const long double[]){0.0L, 0.0L, 1.0L}, blue);
    const long double most = powl(hyab(green, blue), 0.7L), knee = 0.4L * most;
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++) {
            const long double d = powl(hyab(of_a.lab[y][x], of_b.lab[y][x]), 0.7L);
            const long double colour = d < knee ? 0.95L * d / knee : 0.95L + 0.05L * (d - knee) / (most - knee);
            const long double feature = fmaxl(fabsl(of_a.edge[y][x] - of_b.edge[y][x]),
                                              fabsl(of_a.point[y][x] - of_b.point[y][x]));
            out[y][x] = powl(colour, 1.0L - sqrtl(feature / sqrtl(2.0L)));
        }
}

static void show(const pm__image *image, long double factor, bool aces, picture *out)
{
    for (int y = 0; y < H; y++)
        for (int x = 0; x < W; x++)
            for (int c = 0; c < 3; c++) {
                const long double v = factor * (long double)image->values[3 * (y * W + x) + c], x6 = 0.6L * v;
                const long double tone = x6 * (2.51L * x6 + 0.03L) / (x6 * (2.43L * x6 + 0.59L) + 0.14L);
                out->rgb[y][x][c] = fminl(1.0L, fmaxl(0.0L, aces ? tone : v));
            }
}

/* A noisy picture, and it with other noise, a darker half and a bright dot. */
static void make_pair(pm__image *a, pm__image *b)
{
    *a = random_image(W, H, 7);
    *b = random_image(W, H, 7);
    for (size_t i = 0; i < 3 * W * H; i++) {
        b->values[i] = (float)(0.05 + 0.9 * uniform());
        a->values[i] = b->values[i] * (float)(i > 3 * W * H / 2 ? 0.5 : 0.8 + 0.4 * uniform());
    }
    a->values[3 * (8 * W + 11)] = a->values[3 * (8 * W + 11) + 1] = 40.0F;
}

START_TEST(flip_by_brute_force)
{
    static picture shown_a, shown_b;
    static plane want;
    pm__image a, b;
    make_pair(&a, &b);
    static const char *const specs[] = {"flip:ppd=67,grey=none", "flip:ppd=20.5,grey=none", "flip:ppd=1,grey=none"};
    static const long double ppds[] = {67.0L, 20.5L, 1.0L};
    show(&a, 1.0L, false, &shown_a);
    show(&b, 1.0L, false, &shown_b);
    for (int i = 0; i < 3; i++) {
        flip_again(&shown_a, &shown_b, ppds[i], want);
        pm__measured m = measure(specs[i], &a, &b);
        for (int p = 0; p < W * H; p++)
            PM_CHECK_NEAR(m.map[p], (double)want[p / W][p % W], 1e-6);
        ck_assert(m.mean > 0.02 && m.worst > m.mean);
        pm__measured_free(&m);
    }
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

static int ascending(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

START_TEST(hdrflip_by_brute_force)
{
    static picture shown_a, shown_b;
    static plane want, most;
    static double luminance[W * H];
    pm__image a, b;
    make_pair(&a, &b);
    b.values[30] = b.values[31] = b.values[32] = 9.0F;
    for (int p = 0; p < W * H; p++)
        luminance[p] = 0.2126 * (double)b.values[3 * p] + 0.7152 * (double)b.values[3 * p + 1] +
                       0.0722 * (double)b.values[3 * p + 2];
    qsort(luminance, W * H, sizeof *luminance, ascending);
    const double start = (double)log2l(tone_inverse() / (long double)luminance[W * H - 1]);
    const double stop = (double)log2l(tone_inverse() / (long double)luminance[W * H / 2]); /* an odd number of pixels */
    const int count = (int)ceil(stop - start);
    ck_assert_int_ge(count, 3);
    memset(most, 0, sizeof most);
    for (int i = 0; i < count; i++) {
        const long double factor = exp2l((long double)(start + i * (stop - start) / (count - 1)));
        show(&a, factor, true, &shown_a);
        show(&b, factor, true, &shown_b);
        flip_again(&shown_a, &shown_b, 30.0L, want);
        for (int p = 0; p < W * H; p++)
            most[p / W][p % W] = fmaxl(most[p / W][p % W], want[p / W][p % W]);
    }
    pm__measured m = measure("hdrflip:ppd=30", &a, &b);
    ck_assert_uint_eq(m.shown.count, (size_t)count);
    PM_CHECK_NEAR(m.shown.start, start, 1e-9);
    PM_CHECK_NEAR(m.shown.stop, stop, 1e-9);
    for (int p = 0; p < W * H; p++)
        PM_CHECK_NEAR(m.map[p], (double)most[p / W][p % W], 1e-6);
    pm__measured_free(&m);
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

START_TEST(ssim_by_brute_force)
{
    static plane codes[2], moments[5], products;
    pm__image a, b;
    make_pair(&a, &b);
    const pm__image *const images[] = {&a, &b};
    for (int i = 0; i < 2; i++)
        for (int p = 0; p < W * H; p++) {
            const float *const c = &images[i]->values[3 * p];
            const long double y = fminl(1.0L, 0.2126L * (long double)c[0] + 0.7152L * (long double)c[1] +
                                                  0.0722L * (long double)c[2]);
            codes[i][p / W][p % W] = y <= 0.0031308L ? 12.92L * y : 1.055L * powl(y, 1.0L / 2.4L) - 0.055L;
        }
    for (int k = 0; k < 5; k++) { /* a, b, aa, bb, ab */
        for (int p = 0; p < W * H; p++) {
            const long double x = codes[0][p / W][p % W], y = codes[1][p / W][p % W];
            products[p / W][p % W] = k == 0 ? x : k == 1 ? y : k == 2 ? x * x : k == 3 ? y * y : x * y;
        }
        filter_square(products, 5, gauss, (const long double[]){1.5L}, moments[k]);
    }
    pm__measured m = measure("ssim:grey=none", &a, &b);
    for (int p = 0; p < W * H; p++) {
        const int x = p % W, y = p / W;
        const long double ma = moments[0][y][x], mb = moments[1][y][x], saa = moments[2][y][x] - ma * ma;
        const long double sbb = moments[3][y][x] - mb * mb, sab = moments[4][y][x] - ma * mb;
        PM_CHECK_NEAR(m.map[p], (double)((2.0L * ma * mb + 1e-4L) * (2.0L * sab + 9e-4L) /
                                         ((ma * ma + mb * mb + 1e-4L) * (saa + sbb + 9e-4L))), 1e-10);
    }
    ck_assert(m.mean < 0.99 && m.worst < m.p95 && m.p95 < m.median);
    pm__measured_free(&m);
    pm__image_free(&a);
    pm__image_free(&b);
}
END_TEST

PM_TEST_MAIN("flip by brute force", flip_by_brute_force, hdrflip_by_brute_force, ssim_by_brute_force)
