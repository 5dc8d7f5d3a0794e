/* Any bytes as an OpenEXR file: a status, a sentence, and an image that is whole or empty. */
#include "../../src/image/image.h"
#include "fuzz.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    char name[40];
    int file;
    pm__image image;
    pm_error error = {""};
    const char *const path = as_file(data, size, &file, name);
    const pm_status status = pm__exr_read(path, &image, &error);
    FUZZ_CHECK(status == PM_OK || status == PM_EFORMAT || status == PM_ENOMEM, error.text);
    FUZZ_CHECK(status == PM_OK || strlen(error.text) > 10, "no sentence");
    FUZZ_CHECK(status == PM_OK || !image.values, "pixels after an error");
    double sum = 0.0; /* so that each pixel is read */
    for (size_t i = 0; status == PM_OK && i < image.width * image.height * (size_t)image.channels; i++)
        sum += (double)image.values[i];
    FUZZ_CHECK(sum != 1.0 || status == PM_OK, "a sum of nothing");
    pm__image_free(&image);
    (void)close(file);
    return 0;
}
