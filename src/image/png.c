#include "png.h"

#include "image.h"

#include <png.h>
#include <string.h>

/* libpng leaves by longjmp; what it calls on an error must not return. */
typedef struct failure {
    char text[120];
} failure;

static void fail(png_structp png, png_const_charp text)
{
    failure *const f = png_get_error_ptr(png);
    (void)snprintf(f->text, sizeof f->text, "%.100s", text);
    png_longjmp(png, 1);
}

static void pass_over(png_structp png, png_const_charp text)
{
    (void)png;
    (void)text;
}

static void set_texts(png_structp png, png_infop info, const char *title, const char *description)
{
    const char *const keys[] = {"Title", "Description"}, *const texts[] = {title, description};
    for (int i = 0; i < 2; i++) {
        png_text text = {.compression = PNG_TEXT_COMPRESSION_NONE};
        if (!texts[i])
            continue;
        text.key = (png_charp)(uintptr_t)keys[i];
        text.text = (png_charp)(uintptr_t)texts[i];
        png_set_text(png, info, &text, 1);
    }
}

/* In a function of its own: no variable of its caller's changes between setjmp and longjmp. */
static bool write_all(png_structp png, png_infop info, FILE *file, const uint8_t (*pixels)[3], size_t width,
                      size_t height, const char *title, const char *description)
{
    if (setjmp(png_jmpbuf(png)))
        return false;
    png_init_io(png, file);
    png_set_IHDR(png, info, (png_uint_32)width, (png_uint_32)height, 8, PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    set_texts(png, info, title, description);
    png_write_info(png, info);
    for (size_t y = 0; y < height; y++)
        png_write_row(png, (png_const_bytep)pixels[y * width]);
    png_write_end(png, info);
    return true;
}

pm_status pm__png_write(FILE *file, const uint8_t (*pixels)[3], size_t width, size_t height, const char *title,
                        const char *description, pm_error *error)
{
    failure f = {""};
    if (!width || !height || width > PM__LONGEST_SIDE || height > PM__LONGEST_SIDE)
        return pm__fail(error, PM_EINVAL, "an image of %zu x %zu pixels is no PNG", width, height);
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &f, fail, pass_over);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    if (!info) {
        png_destroy_write_struct(&png, NULL);
        return pm__fail(error, PM_ENOMEM, "out of memory for a PNG");
    }
    const bool written = write_all(png, info, file, pixels, width, height, title, description);
    png_destroy_write_struct(&png, &info);
    return written ? PM_OK : pm__fail(error, PM_EIO, "libpng: %s", f.text);
}
