/* The header of a PLY file. */
#ifndef PM_MAP_PLY_HEADER_H
#define PM_MAP_PLY_HEADER_H

#include "ply_input.h"

enum { PM__PLY_NAME = 64, PM__PLY_ELEMENTS = 32, PM__PLY_PROPERTIES = 256, PM__PLY_HEADER = 1 << 20 };

typedef enum pm__ply_type {
    PM__PLY_INT8,
    PM__PLY_UINT8,
    PM__PLY_INT16,
    PM__PLY_UINT16,
    PM__PLY_INT32,
    PM__PLY_UINT32,
    PM__PLY_FLOAT32,
    PM__PLY_FLOAT64
} pm__ply_type;

typedef struct pm__ply_property {
    char name[PM__PLY_NAME];
    pm__ply_type type;   /* of the scalar or of the list's values */
    pm__ply_type length; /* of a list's count */
    bool list;
} pm__ply_property;

typedef struct pm__ply_element {
    char name[PM__PLY_NAME];
    uint64_t count;
    size_t first, properties; /* the range in the header's list */
} pm__ply_element;

typedef struct pm__ply_header {
    bool ascii;
    size_t element_count, property_count;
    pm__ply_element elements[PM__PLY_ELEMENTS];
    pm__ply_property properties[PM__PLY_PROPERTIES];
} pm__ply_header;

/* Bytes of a scalar. */
size_t pm__ply_size(pm__ply_type type);

/* Reads from `ply` to `end_header`. EFORMAT, EIO. Leaves the input at the first byte of the data. */
pm_status pm__ply_read_header(pm__ply_input *input, pm__ply_header *header, pm_error *error);

#endif
