#include "image.h"

#include "../base/memory.h"

#include <stdlib.h>

pm_status pm__image_create(size_t width, size_t height, int channels, pm__image *image, pm_error *error)
{
    *image = (pm__image){0};
    if (width == 0 || height == 0 || (channels != 1 && channels != 3))
        return pm__fail(error, PM_EINVAL, "an image needs pixels of 1 or 3 channels, not %zu x %zu of %d", width,
                        height, channels);
    if (width > PM__LONGEST_SIDE || height > PM__LONGEST_SIDE || width * height > PM__MOST_PIXELS)
        return pm__fail(error, PM_EINVAL, "an image has at most %d pixels a side and %d in all, not %zu x %zu",
                        PM__LONGEST_SIDE, PM__MOST_PIXELS, width, height);
    float *const values = pm__alloc_zero(width * height, (size_t)channels * sizeof *values);
    if (!values)
        return pm__fail(error, PM_ENOMEM, "no memory for an image of %zu x %zu", width, height);
    *image = (pm__image){width, height, channels, values};
    return PM_OK;
}

void pm__image_free(pm__image *image)
{
    free(image->values);
    *image = (pm__image){0};
}
