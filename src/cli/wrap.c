#include "wrap.h"

#include <string.h>

void pm__wrap(FILE *file, const char *text, int column, int indent)
{
    const char *gap = "";
    while (*(text += strspn(text, " "))) {
        const int length = (int)strcspn(text, " ");
        if (column + (int)strlen(gap) + length > PM__SCREEN_WIDTH && column > indent) {
            (void)fprintf(file, "\n%*s", indent, "");
            column = indent;
            gap = "";
        }
        (void)fprintf(file, "%s%.*s", gap, length, text);
        column += (int)strlen(gap) + length;
        gap = " ";
        text += length;
    }
    (void)fputc('\n', file);
}
