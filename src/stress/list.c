/* The list of tests as data. */
#include "list.h"

#include "test.h"

#define X(name) extern const pm__stress_test pm__stress_test_##name;
PM_STRESS_LIST(X)
#undef X

const pm__stress_test *const pm__stress_tests[] = {
#define X(name) &pm__stress_test_##name,
    PM_STRESS_LIST(X)
#undef X
};

size_t pm__stress_test_count(void)
{
    return sizeof pm__stress_tests / sizeof *pm__stress_tests;
}

const char *pm__stress_test_name(size_t test)
{
    return pm__stress_tests[test]->name;
}

const char *pm__stress_test_summary(size_t test)
{
    return pm__stress_tests[test]->summary;
}
