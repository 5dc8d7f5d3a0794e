/* The list of scenes as data. */
#include "list.h"

static const pm__entry *const entries[] = {
#define X(name) &pm__case_scene_##name.entry,
    PM_SCENE_LIST(X)
#undef X
};

const pm__catalogue pm__scene_cases = {"scene", entries, sizeof entries / sizeof *entries};
