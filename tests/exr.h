/* OpenEXR files of kinds that the program itself does not write, made by the format's own library. */
#ifndef PM_TESTS_EXR_H
#define PM_TESTS_EXR_H

#include <OpenEXR/openexr.h>
#include <check.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

typedef struct sample_exr {
    const char *channels; /* a letter each, sorted */
    exr_pixel_type_t type;
    exr_compression_t compression;
    int width, height;
    int x, y;        /* the data window's corner */
    int subsampling; /* of the last channel, across; 0: none */
    bool from_below; /* the header says so; this library's chunks come from the top all the same */
    bool tiled;
    int parts; /* 0: one */
} sample_exr;

/* The value of a pixel's channel: a whole number below 2048, which all types hold. */
static inline unsigned sample_value(char channel, int x, int y)
{
    return (unsigned)(channel * 7 + 31 * x + 97 * y) % 2048;
}

static inline uint16_t half_of_whole(unsigned n)
{
    if (n == 0)
        return 0;
    unsigned exponent = 25; /* of 2^10 */
    for (; n < 1024; exponent--)
        n *= 2;
    return (uint16_t)(exponent * 1024 + (n - 1024));
}

static inline void put_sample(unsigned char *to, exr_pixel_type_t type, unsigned value)
{
    const uint16_t half = half_of_whole(value);
    const float number = (float)value;
    const uint32_t whole = value;
    memcpy(to, type == EXR_PIXEL_HALF ? (const void *)&half : type == EXR_PIXEL_FLOAT ? (const void *)&number : &whole,
           type == EXR_PIXEL_HALF ? 2 : 4);
}

static inline void silent(exr_const_context_t context, exr_result_t code, const char *message)
{
    (void)context;
    (void)code;
    (void)message;
}

#define SAMPLE_OK(call) ck_assert_int_eq((call), EXR_ERR_SUCCESS)

static inline void describe_sample(exr_context_t context, const sample_exr *s, int part)
{
    const exr_attr_box2i_t window = {.min = {.x = s->x, .y = s->y},
                                     .max = {.x = s->x + s->width - 1, .y = s->y + s->height - 1}};
    const exr_attr_v2f_t centre = {.x = 0.0F, .y = 0.0F};
    SAMPLE_OK(exr_initialize_required_attr(context, part, &window, &window, 1.0F, &centre, 1.0F,
                                           s->from_below ? EXR_LINEORDER_DECREASING_Y : EXR_LINEORDER_INCREASING_Y,
                                           s->compression));
    for (const char *c = s->channels; *c; c++) {
        const char name[] = {*c, '\0'};
        SAMPLE_OK(exr_add_channel(context, part, name, s->type, EXR_PERCEPTUALLY_LOGARITHMIC,
                                  !c[1] && s->subsampling ? s->subsampling : 1, 1));
    }
    if (s->tiled)
        SAMPLE_OK(exr_set_tile_descriptor(context, part, 16, 16, EXR_TILE_ONE_LEVEL, EXR_TILE_ROUND_DOWN));
}

static inline void encode_sample(exr_context_t context, const sample_exr *s, int part, exr_chunk_info_t *chunk)
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    SAMPLE_OK(exr_encoding_initialize(context, part, chunk, &pipeline));
    unsigned char *buffers[16];
    ck_assert_int_le(pipeline.channel_count, 16);
    for (int i = 0; i < pipeline.channel_count; i++) {
        exr_coding_channel_info_t *const channel = &pipeline.channels[i];
        const int bytes = s->type == EXR_PIXEL_HALF ? 2 : 4;
        buffers[i] = malloc((size_t)(bytes * chunk->width * chunk->height));
        ck_assert_ptr_nonnull(buffers[i]);
        for (int y = 0; y < chunk->height; y++)
            for (int x = 0; x < chunk->width; x++)
                put_sample(buffers[i] + (y * chunk->width + x) * bytes, s->type,
                           sample_value(channel->channel_name[0], x, chunk->start_y - s->y + y));
        channel->encode_from_ptr = buffers[i];
        channel->user_pixel_stride = bytes;
        channel->user_line_stride = bytes * chunk->width;
    }
    SAMPLE_OK(exr_encoding_choose_default_routines(context, part, &pipeline));
    SAMPLE_OK(exr_encoding_run(context, part, &pipeline));
    for (int i = 0; i < pipeline.channel_count; i++)
        free(buffers[i]);
    SAMPLE_OK(exr_encoding_destroy(context, &pipeline));
}

static inline void encode_rows(exr_context_t context, const sample_exr *s, int part)
{
    int32_t rows;
    SAMPLE_OK(exr_get_scanlines_per_chunk(context, part, &rows));
    const int chunks = (s->height + rows - 1) / rows;
    for (int i = 0; i < chunks; i++) {
        exr_chunk_info_t chunk;
        SAMPLE_OK(exr_write_scanline_chunk_info(context, part, s->y + rows * i,
                                                &chunk));
        encode_sample(context, s, part, &chunk);
    }
}

static inline void encode_tiles(exr_context_t context, const sample_exr *s, int part)
{
    for (int y = 0; y * 16 < s->height; y++)
        for (int x = 0; x * 16 < s->width; x++) {
            exr_chunk_info_t chunk;
            SAMPLE_OK(exr_write_tile_chunk_info(context, part, x, y, 0, 0, &chunk));
            encode_sample(context, s, part, &chunk);
        }
}

static inline void write_sample(const char *path, const sample_exr *s)
{
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = silent;
    exr_context_t context;
    SAMPLE_OK(exr_start_write(&context, path, EXR_WRITE_FILE_DIRECTLY, &settings));
    const int parts = s->parts ? s->parts : 1;
    for (int part = 0; part < parts; part++) {
        int index;
        SAMPLE_OK(exr_add_part(context, parts > 1 ? (part ? "b" : "a") : NULL,
                               s->tiled ? EXR_STORAGE_TILED : EXR_STORAGE_SCANLINE, &index));
        describe_sample(context, s, index);
    }
    SAMPLE_OK(exr_write_header(context));
    for (int part = 0; part < parts; part++)
        (s->tiled ? encode_tiles : encode_rows)(context, s, part);
    SAMPLE_OK(exr_finish(&context));
}

#endif
