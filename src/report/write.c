/* Texts and bytes in the forms that a page takes. */
#include "report.h"

#include <string.h>

void pm__report_write_escaped(FILE *file, const char *text, size_t size)
{
    while (size > 0) {
        const char *const at = memchr(text, '<', size);
        const size_t plain = at ? (size_t)(at - text) : size;
        (void)fwrite(text, 1, plain, file);
        if (!at)
            return;
        (void)fputs("\\u003c", file);
        text += plain + 1;
        size -= plain + 1;
    }
}

json_t *pm__report_text(const char *text, size_t size)
{
    char plain[512];
    json_t *const whole = json_stringn(text, size);
    if (whole)
        return whole;
    size = size < sizeof plain ? size : sizeof plain;
    for (size_t i = 0; i < size; i++)
        plain[i] = (char)(text[i] < ' ' || text[i] > '~' ? '?' : text[i]);
    return json_stringn(plain, size);
}
