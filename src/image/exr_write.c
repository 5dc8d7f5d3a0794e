/* Images into OpenEXR files. The format has its table of offsets before the data that it points to, so the file is put
 * together in memory: then a pipe will do. */
#include "exr_messages.h"
#include "image.h"

#include "../base/memory.h"
#include "../base/quote.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

typedef struct output {
    pm__exr_message message;
    unsigned char *bytes;
    size_t size, capacity;
    bool refused; /* memory: the library makes its own error of ours */
} output;

static int64_t append(exr_const_context_t context, void *user, const void *from, uint64_t count, uint64_t offset,
                      exr_stream_error_func_ptr_t fail)
{
    output *const out = user;
    const size_t end = (size_t)(offset + count);
    void *bytes = out->bytes;
    if (pm__grow(&bytes, &out->capacity, end, 1) != 0) {
        out->refused = true;
        (void)fail(context, EXR_ERR_OUT_OF_MEMORY, "no memory for the file's %zu bytes", end);
        return -1;
    }
    out->bytes = bytes;
    if (end > out->size) { /* the table is written last: until then its place is empty */
        memset(out->bytes + out->size, 0, end - out->size);
        out->size = end;
    }
    memcpy(out->bytes + offset, from, (size_t)count);
    return (int64_t)count;
}

/* These would make the file another kind of file; those that are there already are found by looking. */
static bool is_reserved(const char *name)
{
    static const char *const names[] = {"name", "type", "version", "chunkCount", "maxSamplesPerPixel", "tiles",
                                        "preview"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (strcmp(name, names[i]) == 0)
            return true;
    return false;
}

static pm_status add_attribute(exr_context_t context, const pm__attribute *attribute, pm_error *error)
{
    const exr_attribute_t *known = NULL;
    exr_result_t code = EXR_ERR_INVALID_ATTR;
    /* Setting one again would change it, be it the format's own. */
    if (!is_reserved(attribute->name) &&
        exr_get_attribute_by_name(context, 0, attribute->name, &known) != EXR_ERR_SUCCESS)
        code = attribute->text ? exr_attr_set_string(context, 0, attribute->name, attribute->text)
                               : exr_attr_set_double(context, 0, attribute->name, attribute->number);
    if (code == EXR_ERR_SUCCESS)
        return PM_OK;
    if (code == EXR_ERR_OUT_OF_MEMORY)
        return pm__fail(error, PM_ENOMEM, "no memory for an image's attributes");
    char quoted[PM__QUOTE_SIZE];
    pm__quote(attribute->name, strlen(attribute->name), quoted);
    return pm__fail(error, PM_EINVAL,
                    "an image's header takes no attribute \"%s\": a name must have 1 to 31 bytes and not be taken",
                    quoted);
}

/* The header, but for the attributes that the caller adds: windows from (0, 0), square pixels, rows from the top. */
static exr_result_t describe(exr_context_t context, const pm__image *image, bool half)
{
    int part = 0;
    exr_result_t code = exr_add_part(context, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(context, part, (int32_t)image->width, (int32_t)image->height,
                                                   EXR_COMPRESSION_ZIP);
    const char *const names = image->channels == 3 ? "BGR" : "Y";
    for (int c = 0; code == EXR_ERR_SUCCESS && c < image->channels; c++) {
        const char name[] = {names[c], '\0'};
        code = exr_add_channel(context, part, name, half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    return code;
}

static void point_to_row(exr_encode_pipeline_t *pipeline, const pm__image *image, size_t row)
{
    const size_t channels = (size_t)image->channels;
    const float *const values = image->values + row * image->width * channels;
    for (int16_t i = 0; i < pipeline->channel_count; i++) {
        exr_coding_channel_info_t *const channel = &pipeline->channels[i];
        channel->user_bytes_per_element = sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
        channel->user_pixel_stride = (int32_t)(channels * sizeof(float));
        channel->user_line_stride = (int32_t)(image->width * channels * sizeof(float));
        channel->encode_from_ptr =
            (const uint8_t *)(values + pm__exr_channel(channel->channel_name, image->channels));
    }
}

typedef exr_result_t (*compressor)(exr_encode_pipeline_t *pipeline);

/* Readers take a chunk that is as long as its pixels for the pixels themselves; the library (3.1.5) stores compressed
 * what comes to just that length. */
static exr_result_t compress_or_not(exr_encode_pipeline_t *pipeline)
{
    const compressor *const usual = pipeline->encoding_user_data;
    const exr_result_t code = (*usual)(pipeline);
    if (code == EXR_ERR_SUCCESS && pipeline->compressed_bytes == pipeline->packed_bytes)
        memcpy(pipeline->compressed_buffer, pipeline->packed_buffer, pipeline->packed_bytes);
    return code;
}

static exr_result_t encode(exr_context_t context, const pm__image *image)
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    compressor usual = NULL;
    int32_t rows = 1;
    exr_result_t code = exr_get_scanlines_per_chunk(context, 0, &rows);
    for (size_t row = 0; code == EXR_ERR_SUCCESS && row < image->height; row += (size_t)rows) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(context, 0, (int)row, &chunk);
        if (code == EXR_ERR_SUCCESS)
            code = row ? exr_encoding_update(context, 0, &chunk, &pipeline)
                       : exr_encoding_initialize(context, 0, &chunk, &pipeline);
        if (code == EXR_ERR_SUCCESS)
            point_to_row(&pipeline, image, row);
        if (code == EXR_ERR_SUCCESS && row == 0)
            code = exr_encoding_choose_default_routines(context, 0, &pipeline);
        if (code == EXR_ERR_SUCCESS && row == 0) {
            usual = pipeline.compress_fn;
            pipeline.encoding_user_data = &usual;
            pipeline.compress_fn = usual ? compress_or_not : NULL;
        }
        if (code == EXR_ERR_SUCCESS)
            code = exr_encoding_run(context, 0, &pipeline);
    }
    (void)exr_encoding_destroy(context, &pipeline);
    return code;
}

static pm_status library_error(const output *out, exr_result_t code, pm_error *error)
{
    return pm__fail(error, out->refused || code == EXR_ERR_OUT_OF_MEMORY ? PM_ENOMEM : PM_EINVAL,
                    "the image cannot be put in a file: %s", pm__exr_reason(&out->message, code));
}

static pm_status compose(output *out, const pm__image *image, bool half, const pm__attribute *attributes, size_t count,
                         pm_error *error)
{
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = pm__exr_keep_message;
    pm__exr_listen(&out->message);
    settings.user_data = out;
    settings.write_fn = append;
    exr_context_t context = NULL;
    exr_result_t code = exr_start_write(&context, "image", EXR_WRITE_FILE_DIRECTLY, &settings);
    if (code == EXR_ERR_SUCCESS)
        code = describe(context, image, half);
    pm_status status = code == EXR_ERR_SUCCESS ? PM_OK : library_error(out, code, error);
    for (size_t i = 0; status == PM_OK && i < count; i++)
        status = add_attribute(context, &attributes[i], error);
    if (status == PM_OK) {
        out->message.text[0] = '\0'; /* looking for an attribute left one */
        code = exr_write_header(context);
        if (code == EXR_ERR_SUCCESS)
            code = encode(context, image);
    }
    /* It ends the file: a failure here counts as well. */
    const exr_result_t ended = context ? exr_finish(&context) : EXR_ERR_SUCCESS;
    pm__exr_listen(NULL);
    if (code == EXR_ERR_SUCCESS)
        code = ended;
    return status == PM_OK && code != EXR_ERR_SUCCESS ? library_error(out, code, error) : status;
}

pm_status pm__exr_write(FILE *file, const pm__image *image, bool half, const pm__attribute *attributes, size_t count,
                        pm_error *error)
{
    if (!image->values)
        return pm__fail(error, PM_EINVAL, "an empty image cannot be written");
    output out = {0};
    pm_status status = compose(&out, image, half, attributes, count, error);
    errno = 0;
    if (status == PM_OK && (fwrite(out.bytes, 1, out.size, file) != out.size || fflush(file) != 0))
        status = pm__fail(error, PM_EIO, "the image cannot be written: %s", strerror(errno ? errno : EIO));
    free(out.bytes);
    return status;
}
