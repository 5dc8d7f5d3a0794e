/* Numbers as colours: on a logarithmic scale, with a legend of numbers; and in classes. */
#ifndef PM_IMAGE_FALSE_COLOUR_H
#define PM_IMAGE_FALSE_COLOUR_H

#include "image.h"

#include <stdint.h>

typedef struct pm__picture {
    size_t width, height;
    uint8_t (*pixels)[3]; /* R G B */
} pm__picture;

/* Whole decades that hold all but the lowest and highest hundredth of the values above 0: low < high, powers of ten;
 * 1 to 10 where there is none. At most 8 decades: the upper ones. */
void pm__colour_range(const pm__image *image, double *low, double *high);

/* The colour of a place on the scale, 0 to 1: dark blue, blue, cyan, green, yellow, red. */
void pm__colour_of(double place, uint8_t colour[3]);

/* The image of one channel, its pixels as squares so that it is about 512 wide, with a bar at the right: numbers at
 * decades. Black: no value (NAN); dark grey: 0 or less. ENOMEM. */
pm_status pm__colour_scale(const pm__image *image, double low, double high, pm__picture *picture, pm_error *error);

/* Each pixel's own colour, enlarged likewise. colours: [width * height]. */
pm_status pm__colour_plain(const uint8_t (*colours)[3], size_t width, size_t height, pm__picture *picture,
                           pm_error *error);

void pm__picture_free(pm__picture *picture);

#endif
