#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { ALIGNMENT = 64 };

void *pm__alloc(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - ALIGNMENT) / size)
        return NULL;
    size_t bytes = count * size;
    bytes = (bytes + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT;
    return aligned_alloc(ALIGNMENT, bytes ? bytes : ALIGNMENT);
}

void *pm__alloc_zero(size_t count, size_t size)
{
    void *memory = pm__alloc(count, size);
    if (memory)
        memset(memory, 0, count * size);
    return memory;
}

int pm__grow(void **array, size_t *capacity, size_t wanted, size_t size)
{
    if (wanted <= *capacity)
        return 0;
    size_t grown = *capacity < SIZE_MAX / 2 ? *capacity * 2 : SIZE_MAX;
    if (grown < wanted)
        grown = wanted;
    if (size && grown > SIZE_MAX / size)
        return -1;
    void *memory = realloc(*array, grown * size);
    if (!memory)
        return -1;
    *array = memory;
    *capacity = grown;
    return 0;
}
