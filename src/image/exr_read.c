/* Images from OpenEXR files. A file is held in memory whole and is not trusted: what its header claims is checked against
 * its size before the library allocates by it. */
#include "exr_messages.h"
#include "image.h"

#include "../base/memory.h"
#include "../base/quote.h"

#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct input {
    pm__exr_message message;
    char name[PM__NAME_SIZE];
    const unsigned char *bytes;
    size_t size;
} input;

enum {
    START = 8, /* bytes: the magic number, the version and its flags */
    FIRST_CAPACITY = 1 << 16,
    MOST_PACKING = 4096, /* bytes out of one: ZIP reaches 1032, PIZ about 410 */
    MOST_CHUNK = 1 << 30 /* bytes that are unpacked at a time */
};

/* ---- The bytes ---------------------------------------------------------------------------------- */

static int64_t copy_bytes(exr_const_context_t context, void *user, void *to, uint64_t count, uint64_t offset,
                          exr_stream_error_func_ptr_t fail)
{
    (void)context;
    (void)fail;
    const input *const in = user;
    if (offset >= in->size)
        return 0;
    const size_t left = in->size - (size_t)offset;
    const size_t got = count < left ? (size_t)count : left;
    memcpy(to, in->bytes + offset, got);
    return (int64_t)got;
}

static int64_t tell_size(exr_const_context_t context, void *user)
{
    (void)context;
    return (int64_t)((const input *)user)->size;
}

/* Fails before the first chunk is read where a file does not begin as it should: it may have no end. */
static pm_status check_start(const input *in, pm_error *error)
{
    static const unsigned char magic[4] = {0x76, 0x2f, 0x31, 0x01};
    if (in->size < START || memcmp(in->bytes, magic, sizeof magic) != 0)
        return pm__fail(error, PM_EFORMAT, "%s: expected an OpenEXR file, which begins with the bytes 76 2f 31 01",
                        in->name);
    if (in->bytes[4] != 2)
        return pm__fail(error, PM_EFORMAT, "%s: expected version 2 of the OpenEXR format, found %d", in->name,
                        in->bytes[4]);
    static const char *const kinds[8] = {NULL, "tiles", NULL, "deep pixels", "several parts", NULL, NULL, NULL};
    for (int bit = 0; bit < 8; bit++)
        if (kinds[bit] && (in->bytes[5] >> bit & 1))
            return pm__fail(error, PM_EFORMAT, "%s: expected an image of scanlines in one part, found %s", in->name,
                            kinds[bit]);
    return PM_OK;
}

static pm_status io_error(const input *in, int number, pm_error *error)
{
    return pm__fail(error, PM_EIO, "%s: cannot be read: %s", in->name, strerror(number ? number : EIO));
}

static pm_status read_all(FILE *file, input *in, pm_error *error)
{
    void *bytes = NULL;
    size_t capacity = 0;
    pm_status status = PM_OK;
    for (bool ended = false; status == PM_OK && !ended;) {
        if (pm__grow(&bytes, &capacity, in->size ? in->size + 1 : FIRST_CAPACITY, 1) != 0) {
            status = pm__fail(error, PM_ENOMEM, "%s: no memory for its bytes", in->name);
            break;
        }
        in->bytes = bytes;
        const bool first = in->size == 0;
        errno = 0;
        const size_t got = fread((unsigned char *)bytes + in->size, 1, capacity - in->size, file);
        in->size += got;
        ended = in->size < capacity;
        if (ended && ferror(file))
            status = io_error(in, errno, error);
        else if (first)
            status = check_start(in, error);
    }
    if (status == PM_OK)
        return PM_OK;
    free(bytes);
    in->bytes = NULL;
    return status;
}

/* Free in->bytes. */
static pm_status load(const char *path, input *in, pm_error *error)
{
    *in = (input){0};
    pm__quote_path(path, in->name);
    FILE *const file = fopen(path, "rbe");
    if (!file)
        return io_error(in, errno, error);
    const pm_status status = read_all(file, in, error);
    (void)fclose(file);
    return status;
}

/* ---- The header --------------------------------------------------------------------------------- */

static pm_status library_error(const input *in, exr_result_t code, pm_error *error)
{
    if (code == EXR_ERR_OUT_OF_MEMORY)
        return pm__fail(error, PM_ENOMEM, "%s: no memory to read it", in->name);
    return pm__fail(error, PM_EFORMAT, "%s: expected a whole OpenEXR file: %s", in->name,
                    pm__exr_reason(&in->message, code));
}

/* What is to be read, as the header has it. */
typedef struct layout {
    exr_attr_box2i_t window;
    size_t width, height;
    int channels;
} layout;

static pm_status examine_window(const input *in, exr_const_context_t context, layout *l, pm_error *error)
{
    const exr_result_t code = exr_get_data_window(context, 0, &l->window);
    if (code != EXR_ERR_SUCCESS)
        return library_error(in, code, error);
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

static pm_status find_channels(const input *in, const exr_attr_chlist_t *list, layout *l, pm_error *error)
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
static pm_status examine_channels(const input *in, exr_const_context_t context, layout *l, pm_error *error)
{
    const exr_attr_chlist_t *list = NULL;
    const exr_result_t code = exr_get_channels(context, 0, &list);
    if (code != EXR_ERR_SUCCESS)
        return library_error(in, code, error);
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
        return pm__fail(error, PM_EFORMAT, "%s: expected data for %zu x %zu pixels, found a file of %zu bytes", in->name,
                        l->width, l->height, in->size);
    uint64_t chunk = 0;
    if (exr_get_chunk_unpacked_size(context, 0, &chunk) != EXR_ERR_SUCCESS || chunk > MOST_CHUNK)
        return pm__fail(error, PM_EFORMAT, "%s: expected at most %d bytes of pixels compressed together, found %" PRIu64,
                        in->name, MOST_CHUNK, chunk);
    return find_channels(in, list, l, error);
}

static pm_status examine(const input *in, exr_const_context_t context, layout *l, pm_error *error)
{
    exr_storage_t storage = EXR_STORAGE_LAST_TYPE;
    const exr_result_t code = exr_get_storage(context, 0, &storage);
    if (code != EXR_ERR_SUCCESS)
        return library_error(in, code, error);
    if (storage != EXR_STORAGE_SCANLINE)
        return pm__fail(error, PM_EFORMAT, "%s: expected an image of scanlines in one part", in->name);
    const pm_status status = examine_window(in, context, l, error);
    return status == PM_OK ? examine_channels(in, context, l, error) : status;
}

/* ---- The pixels --------------------------------------------------------------------------------- */

static void point_to_row(exr_decode_pipeline_t *pipeline, const pm__image *image, size_t row)
{
    const size_t channels = (size_t)image->channels;
    float *const values = image->values + row * image->width * channels;
    for (int16_t i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *const channel = &pipeline->channels[i];
        const int c = pm__exr_channel(channel->channel_name, image->channels);
        channel->user_bytes_per_element = sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = (int32_t)(channels * sizeof(float));
        channel->user_line_stride = (int32_t)(image->width * channels * sizeof(float));
        channel->decode_to_ptr = c < 0 ? NULL : (uint8_t *)(values + c);
    }
}

static exr_result_t decode(exr_const_context_t context, const layout *l, const pm__image *image)
{
    exr_decode_pipeline_t pipeline = EXR_DECODE_PIPELINE_INITIALIZER;
    int32_t rows = 1;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &rows);
    for (size_t row = 0; code == EXR_ERR_SUCCESS && row < image->height; row += (size_t)rows) {
        exr_chunk_info_t chunk;
        code = exr_read_scanline_chunk_info(context, 0, l->window.min.y + (int)row, &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = row ? exr_decoding_update(context, 0, &chunk, &pipeline)
                       : exr_decoding_initialize(context, 0, &chunk, &pipeline);
        if (code == EXR_ERR_SUCCESS)
            point_to_row(&pipeline, image, row);
        if (code == EXR_ERR_SUCCESS && row == 0)
            code = exr_decoding_choose_default_routines(context, 0, &pipeline);
        if (code == EXR_ERR_SUCCESS)
            code = exr_decoding_run(context, 0, &pipeline);
    }
    (void)exr_decoding_destroy(context, &pipeline);
    return code;
}

static pm_status read_pixels(const input *in, exr_const_context_t context, pm__image *image, pm_error *error)
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
    return library_error(in, code, error);
}

static pm_status open_context(input *in, exr_context_t *context, pm_error *error)
{
    const pm_status status = check_start(in, error);
    if (status != PM_OK)
        return status;
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = pm__exr_keep_message;
    settings.user_data = in;
    settings.read_fn = copy_bytes;
    settings.size_fn = tell_size;
    /* A table of offsets that is damaged is an error, not a puzzle. */
    settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    const exr_result_t code = exr_start_read(context, "image", &settings);
    if (code == EXR_ERR_SUCCESS)
        return PM_OK;
    if (*context)
        (void)exr_finish(context);
    return library_error(in, code, error);
}

static pm_status read_image(input *in, pm__image *image, pm_error *error)
{
    exr_context_t context = NULL;
    pm_status status = open_context(in, &context, error);
    if (status != PM_OK)
        return status;
    status = read_pixels(in, context, image, error);
    (void)exr_finish(&context);
    return status;
}

pm_status pm__exr_read_memory(const void *bytes, size_t size, const char *name, pm__image *image, pm_error *error)
{
    *image = (pm__image){0};
    input in = {.bytes = bytes, .size = size};
    pm__quote_path(name, in.name);
    return read_image(&in, image, error);
}

pm_status pm__exr_read(const char *path, pm__image *image, pm_error *error)
{
    *image = (pm__image){0};
    input in;
    pm_status status = load(path, &in, error);
    if (status == PM_OK)
        status = read_image(&in, image, error);
    free((void *)in.bytes);
    return status;
}

/* ---- Attributes --------------------------------------------------------------------------------- */

static pm_status spell_attribute(const input *in, exr_const_context_t context, const char *name, char *text, size_t size,
                                 pm_error *error)
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
    input in;
    exr_context_t context = NULL;
    pm_status status = load(path, &in, error);
    if (status == PM_OK)
        status = open_context(&in, &context, error);
    if (status == PM_OK)
        status = spell_attribute(&in, context, name, text, size, error);
    if (context)
        (void)exr_finish(&context);
    free((void *)in.bytes);
    return status;
}
