#include "exr_messages.h"

/* The library calls the handler on the thread that made the error. */
static _Thread_local pm__exr_message *listener;

void pm__exr_listen(pm__exr_message *message)
{
    listener = message;
}

void pm__exr_keep_message(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)context;
    (void)code;
    if (!listener || !text || listener->text[0]) /* the first is nearest to the cause */
        return;
    size_t i = 0;
    for (; text[i] && i < PM__EXR_MESSAGE - 1; i++) /* the file's bytes may be in it */
        listener->text[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
    listener->text[i] = '\0';
}

const char *pm__exr_reason(const pm__exr_message *message, exr_result_t code)
{
    return message->text[0] ? message->text : exr_get_default_error_message(code);
}

int pm__exr_channel(const char *name, int channels)
{
    const char *const names = channels == 3 ? "RGB" : "Y";
    for (int c = 0; c < channels; c++)
        if (name[0] == names[c] && name[1] == '\0')
            return c;
    return -1;
}
