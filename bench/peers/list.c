/* The list of peers as data. */
#include "list.h"

#include "../peer.h"

#include <string.h>

#define X(name) extern const pm__peer pm__peer_##name;
PM_PEER_LIST(X)
#undef X

const pm__peer *const pm__peers[] = {
#define X(name) &pm__peer_##name,
    PM_PEER_LIST(X)
#undef X
    NULL};

const pm__peer *pm__peer_find(const char *name)
{
    for (size_t i = 0; pm__peers[i]; i++)
        if (strcmp(pm__peers[i]->name, name) == 0)
            return pm__peers[i];
    return NULL;
}
