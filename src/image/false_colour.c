#include "false_colour.h"

#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { WIDE = 512, BAR = 24, LEGEND = 96, MARGIN = 12, SIZE = 2, DECADES = 8 }; /* pixels; SIZE: of a letter's dot */

static const uint8_t black[3] = {0, 0, 0}, grey[3] = {48, 48, 48}, white[3] = {255, 255, 255};

static int ascending(const void *a, const void *b)
{
    const float x = *(const float *)a, y = *(const float *)b;
    return x < y ? -1 : x > y;
}

void pm__colour_range(const pm__image *image, double *low, double *high)
{
    const size_t pixels = image->width * image->height;
    float *const values = pm__alloc(pixels, sizeof *values);
    size_t count = 0;
    *low = 1.0;
    *high = 10.0;
    for (size_t i = 0; values && i < pixels; i++)
        if (isfinite(image->values[i]) && image->values[i] > 0.0F)
            values[count++] = image->values[i];
    if (count) {
        qsort(values, count, sizeof *values, ascending);
        const double first = floor(log10((double)values[count / 100]));
        const double last = fmax(first + 1.0, ceil(log10((double)values[count - 1 - count / 100])));
        *low = pow(10.0, fmax(first, last - DECADES));
        *high = pow(10.0, last);
    }
    free(values);
}

void pm__colour_of(double place, uint8_t colour[3])
{
    static const double stops[][3] = {{0, 0, 96}, {0, 64, 255}, {0, 220, 220}, {0, 190, 0}, {255, 230, 0}, {230, 0, 0}};
    enum { LAST = sizeof stops / sizeof *stops - 1 };
    const double at = LAST * fmin(1.0, fmax(0.0, place));
    const int i = at < LAST ? (int)at : LAST - 1;
    for (int b = 0; b < 3; b++)
        colour[b] = (uint8_t)lround(stops[i][b] + (at - i) * (stops[i + 1][b] - stops[i][b]));
}

/* ---- Drawing ----------------------------------------------------------------------------------- */

static pm_status create(size_t width, size_t height, pm__picture *picture, pm_error *error)
{
    *picture = (pm__picture){width, height, pm__alloc_zero(width * height, sizeof *picture->pixels)};
    return picture->pixels ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory for a picture");
}

static void fill(pm__picture *picture, size_t x, size_t y, size_t width, size_t height, const uint8_t colour[3])
{
    for (size_t j = y; j < y + height && j < picture->height; j++)
        for (size_t i = x; i < x + width && i < picture->width; i++)
            memcpy(picture->pixels[j * picture->width + i], colour, 3);
}

static size_t enlargement(size_t width)
{
    return width < WIDE ? WIDE / width : 1;
}

/* Letters of 3 x 5 dots, the top row in the highest bits. */
static unsigned dots_of(char letter)
{
    static const char letters[] = "0123456789e-+";
    static const unsigned dots[] = {075557, 026227, 071747, 071717, 055711, 074717, 074757,
                                    071111, 075757, 075717, 007547, 000700, 002720};
    const char *const found = strchr(letters, letter);
    return found && letter ? dots[found - letters] : 0;
}

static void write_text(pm__picture *picture, size_t x, size_t y, const char *text)
{
    for (; *text; text++, x += 4 * SIZE)
        for (size_t dot = 0; dot < 15; dot++)
            if (dots_of(*text) >> (14 - dot) & 1)
                fill(picture, x + dot % 3 * SIZE, y + dot / 3 * SIZE, SIZE, SIZE, white);
}

static void draw_bar(pm__picture *picture, size_t x, double low, double high)
{
    const double decades = log10(high / low);
    const size_t length = picture->height - 2 * MARGIN;
    for (size_t y = 0; y < length; y++) {
        uint8_t colour[3];
        pm__colour_of(1.0 - (double)y / (double)(length - 1), colour);
        fill(picture, x, MARGIN + y, BAR, 1, colour);
    }
    for (int i = 0; i <= (int)lround(decades); i++) {
        char number[16];
        const double y = MARGIN + (1.0 - i / decades) * (double)(length - 1);
        (void)snprintf(number, sizeof number, "1e%d", (int)lround(log10(low)) + i);
        fill(picture, x + BAR, (size_t)y, MARGIN / 2, 1, white);
        write_text(picture, x + BAR + MARGIN, (size_t)y - 2 * SIZE, number);
    }
}

pm_status pm__colour_scale(const pm__image *image, double low, double high, pm__picture *picture, pm_error *error)
{
    const size_t times = enlargement(image->width), width = times * image->width;
    const size_t tall = times * image->height, height = tall > 8 * MARGIN ? tall : 8 * MARGIN;
    const pm_status status = create(width + LEGEND, height, picture, error);
    if (status != PM_OK)
        return status;
    for (size_t p = 0; p < image->width * image->height; p++) {
        const double value = (double)image->values[p];
        uint8_t colour[3];
        memcpy(colour, isnan(value) ? black : grey, sizeof colour);
        if (value > 0.0)
            pm__colour_of(log(value / low) / log(high / low), colour);
        fill(picture, p % image->width * times, p / image->width * times, times, times, colour);
    }
    draw_bar(picture, width + MARGIN, low, high);
    return PM_OK;
}

pm_status pm__colour_plain(const uint8_t (*colours)[3], size_t width, size_t height, pm__picture *picture,
                           pm_error *error)
{
    const size_t times = enlargement(width);
    const pm_status status = create(times * width, times * height, picture, error);
    for (size_t p = 0; p < width * height && status == PM_OK; p++)
        fill(picture, p % width * times, p / width * times, times, times, colours[p]);
    return status;
}

void pm__picture_free(pm__picture *picture)
{
    free(picture->pixels);
    *picture = (pm__picture){0};
}
