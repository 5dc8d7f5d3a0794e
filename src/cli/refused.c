#include "refused.h"

#include <jansson.h>
#include <stdatomic.h>
#include <stdlib.h>

static atomic_bool refused;

void pm__refused_note(void)
{
    atomic_store(&refused, true);
}

void *pm__refused_if_null(void *memory)
{
    if (!memory)
        pm__refused_note();
    return memory;
}

static void *allocate(size_t size)
{
    return pm__refused_if_null(malloc(size));
}

static void release(void *memory)
{
    free(memory);
}

void pm__refused_watch(void)
{
    atomic_store(&refused, false);
    json_set_alloc_funcs(allocate, release);
}

pm_status pm__refused_status(pm_error *error)
{
    return atomic_load(&refused) ? pm__fail(error, PM_ENOMEM, "out of memory for the rows") : PM_OK;
}
