#include "ply_reader.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* ---- One value ---------------------------------------------------------------------------------- */

static inline uint64_t load(const char *bytes, size_t size)
{
    uint64_t bits = 0;
    for (size_t i = 0; i < size; i++)
        bits |= (uint64_t)(unsigned char)bytes[i] << (8 * i);
    return bits;
}

static inline double decode(pm__ply_type type, const char *bytes)
{
    switch (type) {
    case PM__PLY_INT8:
        return (double)(int8_t)load(bytes, 1);
    case PM__PLY_UINT8:
        return (double)load(bytes, 1);
    case PM__PLY_INT16:
        return (double)(int16_t)load(bytes, 2);
    case PM__PLY_UINT16:
        return (double)load(bytes, 2);
    case PM__PLY_INT32:
        return (double)(int32_t)load(bytes, 4);
    case PM__PLY_UINT32:
        return (double)load(bytes, 4);
    case PM__PLY_FLOAT32: {
        const uint32_t bits = (uint32_t)load(bytes, 4);
        float value;
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    }
    case PM__PLY_FLOAT64: {
        const uint64_t bits = load(bytes, 8);
        double value;
        memcpy(&value, &bits, sizeof value);
        return value;
    }
    }
    return 0.0;
}

/* "x of vertex 7", for messages. */
enum { WHERE = 2 * PM__PLY_NAME + 48 };
static void describe(const pm__ply *ply, const pm__ply_element *element, const char *property, char text[WHERE])
{
    char name[PM__QUOTE_SIZE], of[PM__QUOTE_SIZE];
    pm__quote(property, strlen(property), name);
    pm__quote(element->name, strlen(element->name), of);
    (void)snprintf(text, WHERE, "%s of %s %" PRIu64, name, of, ply->index);
}

static pm_status missing_value(const pm__ply *ply, const pm__ply_element *element, const char *property,
                               pm_error *error)
{
    char where[WHERE], what[WHERE + 16];
    describe(ply, element, property, where);
    (void)snprintf(what, sizeof what, "a number for %s", where);
    return pm__ply_expected(&ply->input, what, error);
}

static inline pm_status read_value(pm__ply *ply, const pm__ply_element *element, const pm__ply_property *property,
                                   pm__ply_type type, bool across_lines, double *value, pm_error *error)
{
    pm__ply_input *const input = &ply->input;
    if (ply->header.ascii) {
        if (!pm__ply_number(input, across_lines, value))
            return missing_value(ply, element, property->name, error);
        return PM_OK;
    }
    const size_t size = pm__ply_size(type);
    if (pm__ply_available(input, size) < size)
        return missing_value(ply, element, property->name, error);
    *value = decode(type, input->buffer + input->at);
    input->at += size;
    return PM_OK;
}

/* ---- What is not wanted ------------------------------------------------------------------------- */

/* Binary data only. */
static pm_status skip_bytes(pm__ply *ply, const pm__ply_element *element, const pm__ply_property *property,
                            uint64_t bytes, pm_error *error)
{
    while (bytes > 0) {
        const size_t available = pm__ply_available(&ply->input, 1);
        if (available == 0)
            return missing_value(ply, element, property->name, error);
        const size_t step = bytes < available ? (size_t)bytes : available;
        ply->input.at += step;
        bytes -= step;
    }
    return PM_OK;
}

/* Each vertex has a line of its own, so its numbers are not looked for on the next; other elements may be broken
 * over lines as their writer liked. */
static pm_status skip_list(pm__ply *ply, const pm__ply_element *element, const pm__ply_property *property,
                           bool across_lines, pm_error *error)
{
    double length, ignored;
    pm_status status = read_value(ply, element, property, property->length, across_lines, &length, error);
    if (status != PM_OK)
        return status;
    if (!(length >= 0.0 && length <= (double)UINT32_MAX && length == floor(length))) {
        char place[PM__PLY_PLACE], where[WHERE];
        pm__ply_place(&ply->input, place);
        describe(ply, element, property->name, where);
        return pm__fail(error, PM_EFORMAT, "%s: expected a list's length for %s, found %g", place, where, length);
    }
    const uint64_t count = (uint64_t)length;
    if (!ply->header.ascii)
        return skip_bytes(ply, element, property, count * pm__ply_size(property->type), error);
    for (uint64_t i = 0; status == PM_OK && i < count; i++)
        status = read_value(ply, element, property, property->type, element != ply->vertex, &ignored, error);
    return status;
}

static pm_status skip_record(pm__ply *ply, const pm__ply_element *element, pm_error *error)
{
    double ignored;
    pm_status status = PM_OK;
    for (size_t i = 0; status == PM_OK && i < element->properties; i++) {
        const pm__ply_property *const property = &ply->header.properties[element->first + i];
        status = property->list ? skip_list(ply, element, property, true, error)
                                : read_value(ply, element, property, property->type, true, &ignored, error);
    }
    return status;
}

/* The fewest bytes that a record of the element can have; 0 where it has no properties. */
static uint64_t least_size(const pm__ply *ply, const pm__ply_element *element)
{
    uint64_t size = 0;
    for (size_t i = 0; i < element->properties; i++) {
        const pm__ply_property *const property = &ply->header.properties[element->first + i];
        const size_t binary = pm__ply_size(property->list ? property->length : property->type);
        size += ply->header.ascii ? 2 : binary; /* a digit and what parts it from the next */
    }
    return size;
}

/* Refuses at once what the file is too short to hold, so that a false count costs neither time nor memory. */
static pm_status check_size(const pm__ply *ply, const pm__ply_element *element, pm_error *error)
{
    const uint64_t size = least_size(ply, element);
    const uint64_t remaining = pm__ply_remaining(&ply->input);
    const uint64_t lacking = ply->header.ascii ? 1 : 0; /* the last line's end */
    if (size == 0 || remaining == UINT64_MAX || element->count <= (remaining + lacking) / size)
        return PM_OK;
    char place[PM__PLY_PLACE], name[PM__QUOTE_SIZE];
    pm__ply_place(&ply->input, place);
    pm__quote(element->name, strlen(element->name), name);
    return pm__fail(error, PM_EFORMAT,
                    "%s: expected %" PRIu64 " %s records of at least %" PRIu64 " bytes, found the last %" PRIu64
                    " bytes of the file",
                    place, element->count, name, size, remaining);
}

static pm_status skip_element(pm__ply *ply, const pm__ply_element *element, pm_error *error)
{
    pm_status status = check_size(ply, element, error);
    if (element->properties == 0)
        return status;
    for (ply->index = 0; status == PM_OK && ply->index < element->count; ply->index++)
        status = skip_record(ply, element, error);
    return status;
}

/* ---- The vertices ------------------------------------------------------------------------------- */

pm_status pm__ply_open(const char *path, pm__ply *ply, pm_error *error)
{
    memset(ply, 0, sizeof *ply);
    pm_status status = pm__ply_input_open(path, &ply->input, error);
    if (status != PM_OK)
        return status;
    status = pm__ply_read_header(&ply->input, &ply->header, error);
    for (size_t i = 0; status == PM_OK && i < ply->header.element_count; i++)
        if (strcmp(ply->header.elements[i].name, "vertex") == 0)
            ply->vertex = &ply->header.elements[i];
    if (status == PM_OK && !ply->vertex)
        status = pm__fail(error, PM_EFORMAT,
                          "%s, line %" PRIu64 ": expected an element vertex in the header, found none",
                          ply->input.name, ply->input.line - 1);
    else if (status == PM_OK && ply->vertex->count > PM_MAX_PHOTONS)
        status = pm__fail(error, PM_EFORMAT, "%s: header: expected at most %zu vertices, found %" PRIu64,
                          ply->input.name, PM_MAX_PHOTONS, ply->vertex->count);
    if (status != PM_OK)
        pm__ply_close(ply);
    return status;
}

void pm__ply_close(pm__ply *ply)
{
    pm__ply_input_close(&ply->input);
}

/* The vertex's property of that name, or -1. */
static int find(const pm__ply *ply, const char *name)
{
    const pm__ply_property *const properties = ply->header.properties + ply->vertex->first;
    for (size_t i = 0; name && i < ply->vertex->properties; i++)
        if (strcmp(properties[i].name, name) == 0)
            return (int)i;
    return -1;
}

bool pm__ply_has(const pm__ply *ply, const char *name)
{
    return find(ply, name) >= 0;
}

static pm_status bind(pm__ply *ply, const pm__ply_field *field, int slot, pm_error *error)
{
    const int named = find(ply, field->name), aliased = find(ply, field->alias);
    const int found = named >= 0 ? named : aliased;
    if (found < 0)
        return pm__fail(error, PM_EFORMAT, "%s: header: expected a property %s%s%s of element vertex, found none",
                        ply->input.name, field->name, field->alias ? " or " : "", field->alias ? field->alias : "");
    if (named >= 0 && aliased >= 0)
        return pm__fail(error, PM_EFORMAT, "%s: header: expected either %s or %s of element vertex, found both",
                        ply->input.name, field->name, field->alias);
    if (ply->header.properties[ply->vertex->first + (size_t)found].list)
        return pm__fail(error, PM_EFORMAT, "%s: header: expected a number for property %s, found a list",
                        ply->input.name, field->name);
    ply->slot[found] = slot;
    return PM_OK;
}

pm_status pm__ply_start(pm__ply *ply, const pm__ply_field *fields, size_t count, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < ply->vertex->properties; i++)
        ply->slot[i] = -1;
    for (size_t i = 0; status == PM_OK && i < count; i++)
        status = bind(ply, &fields[i], (int)i, error);
    for (const pm__ply_element *e = ply->header.elements; status == PM_OK && e < ply->vertex; e++)
        status = skip_element(ply, e, error);
    if (status == PM_OK)
        status = check_size(ply, ply->vertex, error);
    ply->index = 0;
    return status;
}

static pm_status not_finite(const pm__ply *ply, const pm__ply_property *property, double value, pm_error *error)
{
    char place[PM__PLY_PLACE], where[WHERE];
    pm__ply_place(&ply->input, place);
    describe(ply, ply->vertex, property->name, where);
    return pm__fail(error, PM_ENONFINITE, "%s: expected a finite float for %s, found %g", place, where, value);
}

void pm__ply_vertex_place(const pm__ply *ply, char place[PM__PLY_PLACE])
{
    if (ply->header.ascii)
        (void)snprintf(place, PM__PLY_PLACE, "%s, line %" PRIu64, ply->input.name, ply->line);
    else
        (void)snprintf(place, PM__PLY_PLACE, "%s, byte %" PRIu64, ply->input.name, ply->offset);
}

pm_status pm__ply_next(pm__ply *ply, double *values, pm_error *error)
{
    const pm__ply_element *const vertex = ply->vertex;
    ply->offset = ply->input.offset + ply->input.at;
    for (size_t i = 0; i < vertex->properties; i++) {
        const pm__ply_property *const property = &ply->header.properties[vertex->first + i];
        double value;
        const pm_status status = property->list
                                     ? skip_list(ply, vertex, property, i == 0, error)
                                     : read_value(ply, vertex, property, property->type, i == 0, &value, error);
        if (status != PM_OK)
            return status;
        if (ply->slot[i] < 0)
            continue;
        if (!(fabs(value) <= (double)FLT_MAX))
            return not_finite(ply, property, value, error);
        values[ply->slot[i]] = value;
    }
    ply->index++;
    ply->line = ply->input.line;
    return ply->header.ascii ? pm__ply_end_of_line(&ply->input, error) : PM_OK;
}
