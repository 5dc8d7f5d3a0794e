/* Numbers as text and back, and names that were nearly right. The C locale throughout, whatever the caller's is. */
#include "param.h"

#include <ctype.h>
#include <errno.h>
#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { LONGEST_NAME = 63 };

/* Decimal digits with an optional sign, point and exponent: strtod alone would also take blanks, hex and "inf". */
static bool is_decimal(const char *text)
{
    const char *p = text + (*text == '+' || *text == '-');
    const size_t whole = strspn(p, "0123456789");
    p += whole;
    size_t fraction = 0;
    if (*p == '.') {
        fraction = strspn(++p, "0123456789");
        p += fraction;
    }
    if (!whole && !fraction)
        return false;
    if (*p == 'e' || *p == 'E') {
        p++;
        p += *p == '+' || *p == '-';
        const size_t digits = strspn(p, "0123456789");
        if (!digits)
            return false;
        p += digits;
    }
    return !*p;
}

int pm__parse_double(const char *text, double *value)
{
    if (!is_decimal(text))
        return -1;
    const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c)
        return -1;
    const double parsed = strtod_l(text, NULL, c);
    freelocale(c);
    if (!isfinite(parsed))
        return -1;
    *value = parsed;
    return 0;
}

void pm__format_double(double value, char text[32])
{
    const locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    const locale_t before = c ? uselocale(c) : (locale_t)0;
    for (int precision = 1; precision <= 17; precision++) {
        (void)snprintf(text, 32, "%.*g", precision, value);
        /* A whole number keeps its digits: 40000, not 4e+04. */
        if (strtod(text, NULL) == value && !(strchr(text, 'e') && fabs(value) < 1e15 && fabs(value) >= 1.0))
            break;
    }
    if (c) {
        (void)uselocale(before);
        freelocale(c);
    }
}

double pm__decimal_of_float(float value)
{
    double decimal = (double)value;
    char text[32];
    for (int precision = 1; precision <= 9; precision++) {
        (void)snprintf(text, sizeof text, "%.*g", precision, (double)value);
        if (pm__parse_double(text, &decimal) == 0 && (float)decimal == value)
            return decimal;
    }
    return (double)value; /* not finite, or in a locale whose point is none */
}

static size_t min3(size_t a, size_t b, size_t c)
{
    const size_t ab = a < b ? a : b;
    return ab < c ? ab : c;
}

static bool same_letter(char a, char b)
{
    return tolower((unsigned char)a) == tolower((unsigned char)b);
}

/* Edits (insert, delete, replace, swap neighbours) from a to b: optimal string alignment. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t rows[3][LONGEST_NAME + 1];
    const size_t length = strlen(b);
    for (size_t j = 0; j <= length; j++)
        rows[0][j] = j;
    for (size_t i = 1; a[i - 1]; i++) {
        size_t *const row = rows[i % 3];
        const size_t *const above = rows[(i + 2) % 3], *const two_above = rows[(i + 1) % 3];
        row[0] = i;
        for (size_t j = 1; j <= length; j++) {
            const size_t replaced = above[j - 1] + !same_letter(a[i - 1], b[j - 1]);
            row[j] = min3(above[j] + 1, row[j - 1] + 1, replaced);
            if (i > 1 && j > 1 && same_letter(a[i - 1], b[j - 2]) && same_letter(a[i - 2], b[j - 1]) &&
                two_above[j - 2] + 1 < row[j])
                row[j] = two_above[j - 2] + 1;
        }
    }
    return rows[strlen(a) % 3][length];
}

/* The one candidate that `name` abbreviates, if it is the only one. */
static const char *completed_name(const char *name, const char *const *candidates, size_t count)
{
    const char *found = NULL;
    const size_t length = strlen(name);
    for (size_t i = 0; i < count && length > 1; i++)
        if (strncasecmp(candidates[i], name, length) == 0) {
            if (found)
                return NULL;
            found = candidates[i];
        }
    return found;
}

const char *pm__nearest_name(const char *name, const char *const *candidates, size_t count)
{
    const size_t length = strlen(name);
    if (!length || length > LONGEST_NAME)
        return NULL;
    const char *nearest = NULL;
    /* A slip in three letters or so. Fewer edits win, then what the name begins, then the earlier candidate. */
    size_t least = (length + 2) / 3;
    bool begun = false;
    for (size_t i = 0; i < count; i++) {
        if (strlen(candidates[i]) > LONGEST_NAME)
            continue;
        const size_t distance = edit_distance(name, candidates[i]);
        const bool begins = strncasecmp(candidates[i], name, length) == 0;
        if (distance <= least && distance < length && (!nearest || distance < least || (begins && !begun))) {
            nearest = candidates[i];
            least = distance;
            begun = begins;
        }
    }
    return nearest ? nearest : completed_name(name, candidates, count);
}
