#include "quote.h"

#include <string.h>

void pm__quote(const char *bytes, size_t count, char text[PM__QUOTE_SIZE])
{
    const size_t room = PM__QUOTE_SIZE - 4;
    const size_t shown = count < room ? count : room;
    for (size_t i = 0; i < shown; i++)
        text[i] = bytes[i] >= ' ' && bytes[i] <= '~' ? bytes[i] : '?';
    memcpy(text + shown, "...", 4);
    if (shown == count)
        text[shown] = '\0';
}

void pm__quote_path(const char *path, char text[PM__NAME_SIZE])
{
    const size_t length = strlen(path);
    const size_t cut = length < PM__NAME_SIZE ? 0 : 3;
    memcpy(text, "...", cut);
    /* Of a long path the end says more than the beginning. */
    const char *const from = cut ? path + length - (PM__NAME_SIZE - 1 - cut) : path;
    size_t i = 0;
    for (; from[i]; i++) {
        const unsigned char c = (unsigned char)from[i];
        text[cut + i] = c < ' ' || c == 127 ? '?' : from[i];
    }
    text[cut + i] = '\0';
}
