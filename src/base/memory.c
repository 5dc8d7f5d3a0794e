#include "memory.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef __linux__
#include <sys/mman.h>
#endif

enum { ALIGNMENT = 64, HUGE_PAGE = 2 << 20 };

static void *alloc_aligned(size_t alignment, size_t bytes)
{
    return aligned_alloc(alignment, (bytes + alignment - 1) / alignment * alignment);
}

/* Large arrays are read in an order that no translation buffer holds in pages of 4 KB. */
static void *alloc_large(size_t bytes)
{
    void *const memory = alloc_aligned(HUGE_PAGE, bytes);
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    if (memory)
        (void)madvise(memory, bytes, MADV_HUGEPAGE); /* a hint: without it all is the same but slower */
#endif
    return memory;
}

void *pm__alloc(size_t count, size_t size)
{
    if (size && count > (SIZE_MAX - HUGE_PAGE) / size)
        return NULL;
    const size_t bytes = count * size;
    if (bytes >= 4 * (size_t)HUGE_PAGE)
        return alloc_large(bytes);
    return alloc_aligned(ALIGNMENT, bytes ? bytes : ALIGNMENT);
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
