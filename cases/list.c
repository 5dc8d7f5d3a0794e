/* The list of cases as data. */
#include "list.h"

#include "case.h"
#include "scenes/list.h"

#define X(name) extern const pm__case pm__case_##name;
PM_CASE_LIST(X)
#undef X

static const pm__entry *const entries[] = {
#define X(name) &pm__case_##name.entry,
    PM_CASE_LIST(X)
#undef X
};

const pm__catalogue pm__cases = {"case", entries, sizeof entries / sizeof *entries};

static const pm__entry *const all_entries[] = {
#define X(name) &pm__case_##name.entry,
    PM_CASE_LIST(X)
#undef X
#define X(name) &pm__case_scene_##name.entry,
    PM_SCENE_LIST(X)
#undef X
};

const pm__catalogue pm__all_cases = {"case", all_entries, sizeof all_entries / sizeof *all_entries};
