/* What the two sides of OpenEXR files share: the library's own words caught for an error's text, never printed. */
#ifndef PM_IMAGE_EXR_MESSAGES_H
#define PM_IMAGE_EXR_MESSAGES_H

#include <OpenEXR/openexr.h>

enum { PM__EXR_MESSAGE = 128 };

typedef struct pm__exr_message {
    char text[PM__EXR_MESSAGE]; /* the first since it was emptied, printable; "" where there was none */
} pm__exr_message;

/* Contexts that use the handler below keep their messages there, on this thread, until the next call; NULL: nowhere.
 * A handler cannot ask its context for the user data: some functions call it while they hold the lock for that. */
void pm__exr_listen(pm__exr_message *message);

/* For error_handler_fn. */
void pm__exr_keep_message(exr_const_context_t context, exr_result_t code, const char *text);

/* What went wrong: the message caught, or else the library's sentence for the code. */
const char *pm__exr_reason(const pm__exr_message *message, exr_result_t code);

/* The channel of an image of so many that a file's channel stands for; -1: none. */
int pm__exr_channel(const char *name, int channels);

#endif
