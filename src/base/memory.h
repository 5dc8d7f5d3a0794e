/* Allocation whose sizes cannot overflow. */
#ifndef PM_BASE_MEMORY_H
#define PM_BASE_MEMORY_H

#include <stddef.h>

/* count * size bytes, 64-byte aligned, uninitialised; NULL when refused or when the product overflows.
 * A product of 0 gives a valid pointer. Free with free(). */
void *pm__alloc(size_t count, size_t size);

/* The same, zeroed. */
void *pm__alloc_zero(size_t count, size_t size);

/* Grows an array to hold at least `wanted` elements, doubling; *capacity follows. 0 done, -1 refused
 * (array and capacity are then as before). The element size must divide by nothing in particular, but the
 * array must come from malloc, not pm__alloc. */
int pm__grow(void **array, size_t *capacity, size_t wanted, size_t size);

#endif
