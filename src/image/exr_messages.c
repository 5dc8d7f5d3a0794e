#include "exr_messages.h"

void pm__exr_keep_message(exr_const_context_t context, exr_result_t code, const char *text)
{
    (void)code;
    void *user = NULL;
    if (!context || !text || exr_get_user_data(context, &user) != EXR_ERR_SUCCESS || !user)
        return;
    pm__exr_message *const message = user;
    if (message->text[0]) /* the first is nearest to the cause */
        return;
    size_t i = 0;
    for (; text[i] && i < PM__EXR_MESSAGE - 1; i++) /* the file's bytes may be in it */
        message->text[i] = text[i] >= ' ' && text[i] <= '~' ? text[i] : '?';
    message->text[i] = '\0';
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
