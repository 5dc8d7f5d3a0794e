#include "ply_header.h"

#include <inttypes.h>
#include <string.h>

enum { MAX_WORDS = 6 };

typedef struct parser {
    pm__ply_input *input;
    pm__ply_header *header;
    pm_error *error;
    char line[PM__PLY_LINE + 1];
    char *words[MAX_WORDS];
    size_t word_count; /* up to MAX_WORDS; further ones are only seen as too many */
    bool formatted;    /* the format line was seen */
    bool ended;
} parser;

static const struct {
    const char *names[2];
    size_t size;
} types[] = {
    [PM__PLY_INT8] = {{"char", "int8"}, 1},       [PM__PLY_UINT8] = {{"uchar", "uint8"}, 1},
    [PM__PLY_INT16] = {{"short", "int16"}, 2},    [PM__PLY_UINT16] = {{"ushort", "uint16"}, 2},
    [PM__PLY_INT32] = {{"int", "int32"}, 4},      [PM__PLY_UINT32] = {{"uint", "uint32"}, 4},
    [PM__PLY_FLOAT32] = {{"float", "float32"}, 4}, [PM__PLY_FLOAT64] = {{"double", "float64"}, 8},
};

size_t pm__ply_size(pm__ply_type type)
{
    return types[type].size;
}

/* About the line just read. */
static pm_status expected(const parser *p, const char *what, const char *found)
{
    char text[PM__QUOTE_SIZE];
    pm__quote(found, strlen(found), text);
    return pm__fail(p->error, PM_EFORMAT, "%s, line %" PRIu64 ": expected %s, found \"%s\"", p->input->name,
                    p->input->line - 1, what, text);
}

static pm_status twice(const parser *p, const char *what)
{
    char text[PM__QUOTE_SIZE];
    pm__quote(what, strlen(what), text);
    return pm__fail(p->error, PM_EFORMAT, "%s, line %" PRIu64 ": expected every name once, found \"%s\" again",
                    p->input->name, p->input->line - 1, text);
}

static void split(parser *p)
{
    p->word_count = 0;
    char *state = NULL;
    for (char *word = strtok_r(p->line, " \t", &state); word && p->word_count < MAX_WORDS;
         word = strtok_r(NULL, " \t", &state))
        p->words[p->word_count++] = word;
}

/* The last word where the count of words is at fault, so that the message shows something of the line. */
static const char *last_word(const parser *p)
{
    return p->words[p->word_count - 1];
}

static pm_status copy_name(const parser *p, const char *word, char name[PM__PLY_NAME])
{
    const size_t length = strlen(word);
    if (length >= PM__PLY_NAME)
        return expected(p, "a name of less than 64 characters", word);
    memcpy(name, word, length + 1);
    return PM_OK;
}

static pm_status parse_format(parser *p)
{
    static const char supported[] = "\"format ascii 1.0\" or \"format binary_little_endian 1.0\"";
    if (p->formatted)
        return twice(p, "format");
    if (p->word_count != 3)
        return expected(p, supported, last_word(p));
    p->header->ascii = strcmp(p->words[1], "ascii") == 0;
    if (!p->header->ascii && strcmp(p->words[1], "binary_little_endian") != 0)
        return expected(p, supported, p->words[1]);
    if (strcmp(p->words[2], "1.0") != 0)
        return expected(p, supported, p->words[2]);
    p->formatted = true;
    return PM_OK;
}

/* Decimal digits only; 0, or -1 also where 64 bits do not hold it. */
static int parse_count(const char *text, uint64_t *count)
{
    *count = 0;
    for (const char *c = text; *c; c++) {
        const uint64_t digit = (uint64_t)(unsigned char)*c - '0';
        if (digit > 9 || *count > (UINT64_MAX - digit) / 10)
            return -1;
        *count = *count * 10 + digit;
    }
    return *text ? 0 : -1;
}

static pm_status parse_element(parser *p)
{
    pm__ply_header *const header = p->header;
    if (!p->formatted)
        return expected(p, "a format line before the first element", p->words[0]);
    if (p->word_count != 3)
        return expected(p, "\"element NAME COUNT\"", last_word(p));
    if (header->element_count == PM__PLY_ELEMENTS)
        return expected(p, "at most 32 elements", p->words[1]);
    pm__ply_element *const element = &header->elements[header->element_count];
    const pm_status status = copy_name(p, p->words[1], element->name);
    if (status != PM_OK)
        return status;
    for (size_t i = 0; i < header->element_count; i++)
        if (strcmp(header->elements[i].name, element->name) == 0)
            return twice(p, element->name);
    if (parse_count(p->words[2], &element->count) != 0)
        return expected(p, "a whole number of elements", p->words[2]);
    element->first = header->property_count;
    element->properties = 0;
    header->element_count++;
    return PM_OK;
}

static pm_status parse_type(const parser *p, const char *word, pm__ply_type *type)
{
    for (size_t i = 0; i < sizeof types / sizeof *types; i++)
        if (strcmp(word, types[i].names[0]) == 0 || strcmp(word, types[i].names[1]) == 0) {
            *type = (pm__ply_type)i;
            return PM_OK;
        }
    return expected(p, "a type (char, uchar, short, ushort, int, uint, float, double)", word);
}

static pm_status parse_list_types(const parser *p, pm__ply_property *property)
{
    const pm_status status = parse_type(p, p->words[2], &property->length);
    if (status != PM_OK)
        return status;
    if (property->length >= PM__PLY_FLOAT32)
        return expected(p, "an integer type for a list's count", p->words[2]);
    return parse_type(p, p->words[3], &property->type);
}

static pm_status parse_property(parser *p)
{
    pm__ply_header *const header = p->header;
    if (header->element_count == 0)
        return expected(p, "an element before its first property", p->words[0]);
    const bool list = p->word_count > 1 && strcmp(p->words[1], "list") == 0;
    if (p->word_count != (list ? 5 : 3))
        return expected(p, "\"property TYPE NAME\" or \"property list TYPE TYPE NAME\"", last_word(p));
    if (header->property_count == PM__PLY_PROPERTIES)
        return expected(p, "at most 256 properties", last_word(p));
    pm__ply_property *const property = &header->properties[header->property_count];
    pm__ply_element *const element = &header->elements[header->element_count - 1];
    property->list = list;
    pm_status status = list ? parse_list_types(p, property) : parse_type(p, p->words[1], &property->type);
    if (status == PM_OK)
        status = copy_name(p, last_word(p), property->name);
    if (status != PM_OK)
        return status;
    for (size_t i = 0; i < element->properties; i++)
        if (strcmp(header->properties[element->first + i].name, property->name) == 0)
            return twice(p, property->name);
    element->properties++;
    header->property_count++;
    return PM_OK;
}

static pm_status parse_end(parser *p)
{
    if (p->word_count != 1)
        return expected(p, "\"end_header\" alone", last_word(p));
    if (!p->formatted)
        return expected(p, "a format line in the header", p->words[0]);
    p->ended = true;
    return PM_OK;
}

static pm_status parse_line(parser *p)
{
    static const struct {
        const char *word;
        pm_status (*parse)(parser *);
    } statements[] = {{"format", parse_format},
                      {"element", parse_element},
                      {"property", parse_property},
                      {"end_header", parse_end},
                      {"comment", NULL},
                      {"obj_info", NULL}};
    const pm_status status = pm__ply_line(p->input, p->line, p->error);
    if (status != PM_OK)
        return status;
    split(p);
    if (p->input->offset + p->input->at > PM__PLY_HEADER)
        return expected(p, "end_header within the first 1048576 bytes", p->word_count ? p->words[0] : "");
    for (size_t i = 0; p->word_count && i < sizeof statements / sizeof *statements; i++)
        if (strcmp(p->words[0], statements[i].word) == 0)
            return statements[i].parse ? statements[i].parse(p) : PM_OK;
    return expected(p, "format, comment, obj_info, element, property or end_header",
                    p->word_count ? p->words[0] : "");
}

/* The first line is looked at before it is read as a line: a file of another kind need not have any. */
static pm_status parse_magic(parser *p)
{
    pm__ply_input *const input = p->input;
    const size_t available = pm__ply_available(input, 5);
    const char *const start = input->buffer;
    if (available < 4 || memcmp(start, "ply", 3) != 0 || (start[3] != '\n' && memcmp(start + 3, "\r\n", 2) != 0))
        return pm__ply_expected(input, "\"ply\"", p->error);
    return pm__ply_line(input, p->line, p->error);
}

pm_status pm__ply_read_header(pm__ply_input *input, pm__ply_header *header, pm_error *error)
{
    parser p = {.input = input, .header = header, .error = error};
    header->element_count = header->property_count = 0;
    pm_status status = parse_magic(&p);
    while (status == PM_OK && !p.ended)
        status = parse_line(&p);
    input->binary = status == PM_OK && !header->ascii;
    return status;
}
