/* Images from OpenEXR files. A file is not trusted: what its header claims is checked against its size before anything
 * is allocated by it. */
#include "exr_input.h"
#include "image.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_PACKING = 4096, /* bytes out of one: ZIP reaches 1032, PIZ about 410 */
    MOST_CHUNK = 1 << 30 /* bytes that are unpacked at a time */
};

/* ---- The header --------------------------------------------------------------------------------- */

/* What is to be read, as the header has it. */
typedef struct layout {
    exr_attr_box2i_t window;
    size_t width, height;
    int channels;
    exr_compression_t compression;
} layout;

static pm_status examine_window(const pm__exr_input *in, exr_const_context_t context, layout *l, pm_error *error)
{
    const exr_result_t code = exr_get_data_window(context, 0, &l->window);
    if (code != EXR_ERR_SUCCESS)
        return pm__exr_library_error(in, code, error);
    const int64_t width = (int64_t)l->window.max.x - l->window.min.x + 1;
    const int64_t height = (int64_t)l->window.max.y - l->window.min.y + 1;
    if (width < 1 || height < 1 || width > PM__LONGEST_SIDE || height > PM__LONGEST_SIDE ||
        width * height > PM__MOST_PIXELS)
        return pm__fail(error, PM_EFORMAT,
                        "%s: expected 1 to %d pixels a side and at most %d in all, found a data window of %" PRId64
                        " x %" PRId64,
                        in->name, PM__LONGEST_SIDE, PM__MOST_PIXELS, width, height);
    l->width = (size_t)width;
    l->height = (size_t)height;
    return PM_OK;
}

static bool has_channel(const exr_attr_chlist_t *list, char name)
{
    for (int i = 0; i < list->num_channels; i++)
        if (list->entries[i].name.str[0] == name && list->entries[i].name.str[1] == '\0')
            return true;
    return false;
}

static pm_status find_channels(const pm__exr_input *in, const exr_attr_chlist_t *list, layout *l, pm_error *error)
{
    const bool found[3] = {has_channel(list, 'R'), has_channel(list, 'G'), has_channel(list, 'B')};
    l->channels = found[0] && found[1] && found[2] ? 3 : has_channel(list, 'Y') ? 1 : 0;
    if (l->channels)
        return PM_OK;
    if (!found[0] && !found[1] && !found[2])
        return pm__fail(error, PM_EFORMAT, "%s: expected channels R, G and B, or Y, found none of them among %d",
                        in->name, list->num_channels);
    return pm__fail(error, PM_EFORMAT, "%s: expected channels R, G and B, or Y, found no%s%s%s", in->name,
                    found[0] ? "" : " R", found[1] ? "" : " G", found[2] ? "" : " B");
}

/* Channels that are passed over are unpacked with the others, so they count. */
static pm_status examine_channels(const pm__exr_input *in, exr_const_context_t context, layout *l, pm_error *error)
{
    const exr_attr_chlist_t *list = NULL;
    const exr_result_t code = exr_get_channels(context, 0, &list);
    if (code != EXR_ERR_SUCCESS)
        return pm__exr_library_error(in, code, error);
    double pixel = 0.0; /* bytes */
    for (int i = 0; i < list->num_channels; i++) {
        const exr_attr_chlist_entry_t *const entry = &list->entries[i];
        pixel += entry->pixel_type == EXR_PIXEL_HALF ? 2.0 : 4.0;
        if (entry->x_sampling == 1 && entry->y_sampling == 1)
            continue;
        char quoted[PM__QUOTE_SIZE];
        pm__quote(entry->name.str, strlen(entry->name.str), quoted);
        return pm__fail(error, PM_EFORMAT, "%s: expected a sample in each pixel, found channel \"%s\" subsampled",
                        in->name, quoted);
    }
    if (pixel * (double)l->width * (double)l->height > MOST_PACKING * (double)in->size)
        return pm__fail(error, PM_EFORMAT, "%s: expected data for %zu x %zu pixels, found a file of %zu bytes",
                        in->name, l->width, l->height, in->size);
    uint64_t chunk = 0;
    if (exr_get_chunk_unpacked_size(context, 0, &chunk) != EXR_ERR_SUCCESS || chunk > MOST_CHUNK)
        return pm__fail(error, PM_EFORMAT,
                        "%s: expected at most %d bytes of pixels compressed together, found %" PRIu64, in->name,
                        MOST_CHUNK, chunk);
    return find_channels(in, list, l, error);
}

static pm_status examine(const pm__exr_input *in, exr_const_context_t context, layout *l, pm_error *error)
{
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    const exr_result_t code = exr_get_storage(context, 0, &storage);
    if (code != EXR_ERR_SUCCESS)
        return pm__exr_library_error(in, code, error);
    if (storage != EXR_STORAGE_SCANLINE)
        return pm__fail(error, PM_EFORMAT, "%s: expected an image of scanlines in one part", in->name);
    if (exr_get_compression(context, 0, &l->compression) != EXR_ERR_SUCCESS || l->compression > EXR_COMPRESSION_PXR24)
        return pm__fail(error, PM_EFORMAT, "%s: expected no compression, RLE, ZIP, PIZ or PXR24, found another",
                        in->name);
    const pm_status status = examine_window(in, context, l, error);
    return status == PM_OK ? examine_channels(in, context, l, error) : status;
}

/* ---- The pixels --------------------------------------------------------------------------------- */

/* IEEE 754 binary16 to binary32: exact. */
static float from_half(uint32_t half)
{
    const uint32_t exponent = half >> 10 & 31, fraction = half & 1023;
    const float sign = half >> 15 ? -1.0F : 1.0F;
    if (exponent == 31)
        return fraction ? NAN : sign * INFINITY;
    return sign * (exponent ? ldexpf((float)(1024 + fraction), (int)exponent - 25) : ldexpf((float)fraction, -24));
}

static uint32_t little_endian(const unsigned char *from, int count)
{
    uint32_t value = 0;
    for (int i = count - 1; i >= 0; i--)
        value = value << 8 | from[i];
    return value;
}

static float to_float(const unsigned char *from, uint16_t type)
{
    if (type == EXR_PIXEL_HALF)
        return from_half(little_endian(from, 2));
    const uint32_t bits = little_endian(from, 4);
    if (type == EXR_PIXEL_UINT)
        return (float)bits;
    float value;
    memcpy(&value, &bits, sizeof value);
    return value;
}

/* What the library hands through to the function below. */
typedef struct target {
    const pm__image *image;
    size_t row; /* the chunk's first */
} target;

/* Spreads a chunk, whose rows have one channel after the other, over the image. In place of the library's own, of which
 * release 3.1.5 writes to channels that are not wanted and takes pixels to be packed where types differ. */
static exr_result_t spread(exr_decode_pipeline_t *pipeline)
{
    const target *const t = pipeline->decoding_user_data;
    const size_t width = t->image->width, channels = (size_t)t->image->channels;
    const size_t rows = (size_t)pipeline->chunk.height;
    size_t row_bytes = 0;
    for (int i = 0; i < pipeline->channel_count; i++)
        row_bytes += width * (size_t)pipeline->channels[i].bytes_per_element;
    const unsigned char *from = pipeline->unpacked_buffer;
    if (!from || pipeline->chunk.unpacked_size != rows * row_bytes || t->row + rows > t->image->height)
        return EXR_ERR_CORRUPT_CHUNK;
    for (size_t row = t->row; row < t->row + rows; row++)
        for (int i = 0; i < pipeline->channel_count; i++) {
            const exr_coding_channel_info_t *const channel = &pipeline->channels[i];
            const size_t bytes = (size_t)channel->bytes_per_element;
            const int c = pm__exr_channel(channel->channel_name, t->image->channels);
            float *const to = t->image->values + row * width * channels + c;
            for (size_t x = 0; c >= 0 && x < width; x++)
                to[x * channels] = to_float(from + x * bytes, channel->data_type);
            from += width * bytes;
        }
    return EXR_ERR_SUCCESS;
}

/* Data that are stored as they are must be all there; compressed ones must be some. */
static bool is_plausible(const exr_chunk_info_t *chunk, const layout *l)
{
    return chunk->packed_size > 0 && chunk->packed_size <= chunk->unpacked_size &&
           (l->compression != EXR_COMPRESSION_NONE || chunk->packed_size == chunk->unpacked_size);
}

static exr_result_t decode_chunk(exr_const_context_t context, const layout *l, target *t,
                                 exr_decode_pipeline_t *pipeline)
{
    exr_chunk_info_t chunk;
    exr_result_t code = exr_read_scanline_chunk_info(context, 0, l->window.min.y + (int)t->row, &chunk);
    if (code == EXR_ERR_SUCCESS && !is_plausible(&chunk, l))
        code = EXR_ERR_CORRUPT_CHUNK;
    if (code == EXR_ERR_SUCCESS)
        code = t->row ? exr_decoding_update(context, 0, &chunk, pipeline)
                      : exr_decoding_initialize(context, 0, &chunk, pipeline);
    if (code == EXR_ERR_SUCCESS && t->row == 0)
        code = exr_decoding_choose_default_routines(context, 0, pipeline);
    pipeline->unpack_and_convert_fn = spread;
    pipeline->decoding_user_data = t;
    return code == EXR_ERR_SUCCESS ? exr_decoding_run(context, 0, pipeline) : code;
}

static exr_result_t decode(exr_const_context_t context, const layout *l, const pm__image *image)
{
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    target t = {image, 0};
    int32_t rows = 0;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &rows);
    if (code == EXR_ERR_SUCCESS && rows < 1)
        code = EXR_ERR_FILE_BAD_HEADER;
    for (; code == EXR_ERR_SUCCESS && t.row < image->height; t.row += (size_t)rows)
        code = decode_chunk(context, l, &t, &pipeline);
    (void)exr_decoding_destroy(context, &pipeline);
    return code;
}

static pm_status read_pixels(const pm__exr_input *in, exr_const_context_t context, pm__image *image, pm_error *error)
{
    layout l;
    pm_status status = examine(in, context, &l, error);
    if (status == PM_OK)
        status = pm__image_create(l.width, l.height, l.channels, image, error);
    if (status != PM_OK)
        return status;
    const exr_result_t code = decode(context, &l, image);
    if (code == EXR_ERR_SUCCESS)
        return PM_OK;
    pm__image_free(image);
    return pm__exr_library_error(in, code, error);
}

static pm_status read_image(pm__exr_input *in, pm__image *image, pm_error *error)
{
    exr_context_t context = NULL;
    pm_status status = pm__exr_open(in, &context, error);
    if (status != PM_OK)
        return status;
    status = read_pixels(in, context, image, error);
    pm__exr_close(&context);
    return status;
}

pm_status pm__exr_read_memory(const void *bytes, size_t size, const char *name, pm__image *image, pm_error *error)
{
    *image = (pm__image){0};
    pm__exr_input in = {.bytes = bytes, .size = size};
    pm__quote_path(name, in.name);
    return read_image(&in, image, error);
}

pm_status pm__exr_read(const char *path, pm__image *image, pm_error *error)
{
    *image = (pm__image){0};
    pm__exr_input in;
    pm_status status = pm__exr_load(path, &in, error);
    if (status == PM_OK)
        status = read_image(&in, image, error);
    free((void *)in.bytes);
    return status;
}

/* ---- Attributes --------------------------------------------------------------------------------- */

static pm_status spell_attribute(const pm__exr_input *in, exr_const_context_t context, const char *name, char *text,
                                 size_t size, pm_error *error)
{
    const exr_attribute_t *found = NULL;
    const bool there = exr_get_attribute_by_name(context, 0, name, &found) == EXR_ERR_SUCCESS;
    size_t length = 0;
    if (there && found->type == EXR_ATTR_STRING) {
        length = (size_t)found->string->length;
        if (length < size) {
            memcpy(text, found->string->str, length);
            text[length] = '\0';
        }
    } else if (there && found->type == EXR_ATTR_DOUBLE) {
        length = (size_t)snprintf(text, size, "%.17g", found->d);
    } else {
        return pm__fail(error, PM_ENAME, "%s: has no attribute \"%s\" that is text or a number", in->name, name);
    }
    if (length < size)
        return PM_OK;
    return pm__fail(error, PM_EINVAL, "%s: attribute \"%s\" has %zu bytes", in->name, name, length);
}

pm_status pm__exr_attribute(const char *path, const char *name, char *text, size_t size, pm_error *error)
{
    pm__exr_input in;
    exr_context_t context = NULL;
    pm_status status = pm__exr_load(path, &in, error);
    if (status == PM_OK)
        status = pm__exr_open(&in, &context, error);
    if (status == PM_OK)
        status = spell_attribute(&in, context, name, text, size, error);
    pm__exr_close(&context);
    free((void *)in.bytes);
    return status;
}

/* The library keeps a list of them by name, so that the order is not the file's. */
static void tell_attribute(const exr_attribute_t *a, pm__attribute_taker *take, void *context)
{
    char number[32];
    if (a->type == EXR_ATTR_STRING)
        take(context, a->name, a->string->str, (size_t)a->string->length);
    else if (a->type == EXR_ATTR_DOUBLE)
        take(context, a->name, number, (size_t)snprintf(number, sizeof number, "%.17g", a->d));
}

pm_status pm__exr_each_attribute(const void *bytes, size_t size, const char *name, pm__attribute_taker *take,
                                 void *context, pm_error *error)
{
    pm__exr_input in = {.bytes = bytes, .size = size};
    exr_context_t file = NULL;
    int32_t count = 0;
    pm__quote_path(name, in.name);
    const pm_status status = pm__exr_open(&in, &file, error);
    if (status != PM_OK)
        return status;
    exr_result_t code = exr_get_attribute_count(file, 0, &count);
    for (int32_t i = 0; code == EXR_ERR_SUCCESS && i < count; i++) {
        const exr_attribute_t *attribute = NULL;
        code = exr_get_attribute_by_index(file, 0, EXR_ATTR_LIST_SORTED_ORDER, i, &attribute);
        if (code == EXR_ERR_SUCCESS)
            tell_attribute(attribute, take, context);
    }
    pm__exr_close(&file);
    return code == EXR_ERR_SUCCESS ? PM_OK : pm__exr_library_error(&in, code, error);
}
