/* The list of searches as data. */
#include "list.h"

#include "search.h"

#include <string.h>

#define X(name) extern const pm_search pm__search_##name;
PM_SEARCH_LIST(X)
#undef X

static const pm__entry *const entries[] = {
#define X(name) &pm__search_##name.entry,
    PM_SEARCH_LIST(X)
#undef X
};

const pm__catalogue pm__searches = {"search", entries, sizeof entries / sizeof *entries};

const pm_search *pm_search_find(const char *name)
{
#define X(row)                                               \
    if (name && !strcmp(name, pm__search_##row.entry.name))  \
        return &pm__search_##row;
    PM_SEARCH_LIST(X)
#undef X
    return NULL;
}
