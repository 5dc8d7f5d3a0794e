#include "exr_input.h"

#include "../base/memory.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { START = 8, FIRST_CAPACITY = 1 << 16 }; /* bytes: the magic number, the version and its flags; of a first look */

static int64_t copy_bytes(exr_const_context_t context, void *user, void *to, uint64_t count, uint64_t offset,
                          exr_stream_error_func_ptr_t fail)
{
    (void)context;
    (void)fail;
    const pm__exr_input *const in = user;
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
    return (int64_t)((const pm__exr_input *)user)->size;
}

/* Fails before the first chunk is read where a file does not begin as it should: it may have no end. */
static pm_status check_start(const pm__exr_input *in, pm_error *error)
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

static pm_status io_error(const pm__exr_input *in, int number, pm_error *error)
{
    return pm__fail(error, number == ENOMEM ? PM_ENOMEM : PM_EIO, "%s: cannot be read: %s", in->name,
                    strerror(number ? number : EIO));
}

static pm_status read_all(FILE *file, pm__exr_input *in, pm_error *error)
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

pm_status pm__exr_load(const char *path, pm__exr_input *in, pm_error *error)
{
    *in = (pm__exr_input){0};
    pm__quote_path(path, in->name);
    FILE *const file = fopen(path, "rbe");
    if (!file)
        return io_error(in, errno, error);
    const pm_status status = read_all(file, in, error);
    (void)fclose(file);
    return status;
}

/* Since the last file was opened on this thread. */
static _Thread_local bool exhausted;

/* Data that are damaged must not show what was there before. */
static void *zeroed(size_t size)
{
    void *const memory = calloc(1, size ? size : 1);
    exhausted = exhausted || !memory;
    return memory;
}

pm_status pm__exr_library_error(const pm__exr_input *in, exr_result_t code, pm_error *error)
{
    if (exhausted) /* the code says so for some damaged files too */
        return pm__fail(error, PM_ENOMEM, "%s: no memory to read it", in->name);
    return pm__fail(error, PM_EFORMAT, "%s: expected a whole OpenEXR file: %s", in->name,
                    pm__exr_reason(&in->message, code));
}

void pm__exr_close(exr_context_t *context)
{
    if (*context)
        (void)exr_finish(context);
    pm__exr_listen(NULL);
}

pm_status pm__exr_open(pm__exr_input *in, exr_context_t *context, pm_error *error)
{
    const pm_status status = check_start(in, error);
    if (status != PM_OK)
        return status;
    exr_context_initializer_t settings = EXR_DEFAULT_CONTEXT_INITIALIZER;
    settings.error_handler_fn = pm__exr_keep_message;
    pm__exr_listen(&in->message);
    settings.user_data = in;
    exhausted = false;
    settings.alloc_fn = zeroed;
    settings.free_fn = free;
    settings.read_fn = copy_bytes;
    settings.size_fn = tell_size;
    /* A damaged table of offsets, or attribute, is an error: else the library goes by a guess. */
    settings.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION | EXR_CONTEXT_FLAG_STRICT_HEADER;
    const exr_result_t code = exr_start_read(context, "image", &settings);
    if (code == EXR_ERR_SUCCESS)
        return PM_OK;
    pm__exr_close(context);
    return pm__exr_library_error(in, code, error);
}

