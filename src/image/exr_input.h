/* An OpenEXR file in memory, and the library's view of it. */
#ifndef PM_IMAGE_EXR_INPUT_H
#define PM_IMAGE_EXR_INPUT_H

#include "../base/quote.h"
#include "../base/status.h"
#include "exr_messages.h"

typedef struct pm__exr_input {
    pm__exr_message message;
    char name[PM__NAME_SIZE]; /* for messages */
    const unsigned char *bytes;
    size_t size;
} pm__exr_input;

/* The whole file; a pipe will do. EIO, ENOMEM, EFORMAT where it does not begin as an image of scanlines in one part
 * does (soon: it may have no end). Free in->bytes. */
pm_status pm__exr_load(const char *path, pm__exr_input *in, pm_error *error);

/* Reads the header: the context refers to *in. EFORMAT, ENOMEM; *context is then NULL. One may be open on a thread. */
pm_status pm__exr_open(pm__exr_input *in, exr_context_t *context, pm_error *error);
void pm__exr_close(exr_context_t *context); /* NULL is allowed */

/* The status and sentence for a failure of the library's. */
pm_status pm__exr_library_error(const pm__exr_input *in, exr_result_t code, pm_error *error);

#endif
