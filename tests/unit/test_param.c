/* Specs, numbers and name suggestions. */
#include "../../src/base/param.h"

#include "../test.h"

#include <stdint.h>
#include <string.h>

static const pm__param cone_params[] = {
    {"k", PM__REAL, 1.1, 1.0, 100.0, "", NULL, "filter constant"},
    {"last", PM__CHOICE, 0, 0, 0, "", "full|half|none", "share"},
};
static const pm__param maps_params[] = {{"maps", PM__INTEGER, 4, 1, 64, "", NULL, "maps"}};

/* `far` follows `near` unless it is given. */
static pm_status resolve_range(double *values, pm_error *error)
{
    if (values[1] == 0.0)
        values[1] = 2.0 * values[0];
    if (values[1] < values[0])
        return pm__fail(error, PM_EINVAL, "range: far is nearer than near");
    return PM_OK;
}

static const pm__param range_params[] = {{"near", PM__REAL, 1.0, 0.0, 10.0, "m", NULL, ""},
                                         {"far", PM__REAL, 0.0, 0.0, 100.0, "m", NULL, ""}};

static const pm__entry disc = {"disc", "a disc", "", NULL, 0, NULL};
static const pm__entry cone = {"cone", "a cone", "", cone_params, 2, NULL};
static const pm__entry combined = {"combined", "maps", "", maps_params, 1, NULL};
static const pm__entry range = {"range", "a range", "", range_params, 2, resolve_range};
static const pm__entry *const entries[] = {&disc, &cone, &combined, &range};
static const pm__catalogue things = {"thing", entries, 4};

static void check_canonical(const char *text, const char *want, const char *want_short)
{
    pm__spec spec;
    pm_error error = {""};
    char got[PM__MAX_SPEC];
    PM_CHECK_OK(pm__spec_parse(&things, text, &spec, &error), error);
    pm__spec_format(&spec, got, sizeof got);
    ck_assert_str_eq(got, want);
    pm__spec_format_short(&spec, got, sizeof got);
    ck_assert_str_eq(got, want_short);
}

START_TEST(one_spec)
{
    check_canonical("disc", "disc", "disc");
    check_canonical("cone", "cone:k=1.1,last=full", "cone");
    check_canonical("cone:last=none", "cone:k=1.1,last=none", "cone:last=none");
    check_canonical("cone:last=half,k=2", "cone:k=2,last=half", "cone:k=2,last=half");
    check_canonical("cone:k=1.10", "cone:k=1.1,last=full", "cone");
    check_canonical("combined:maps=1e1", "combined:maps=10", "combined:maps=10");
    check_canonical("range", "range:near=1,far=2", "range");
    check_canonical("range:near=3", "range:near=3,far=6", "range:near=3");
    check_canonical("range:near=3,far=7", "range:near=3,far=7", "range:near=3,far=7");
    check_canonical("range:far=2", "range:near=1,far=2", "range");
    check_canonical("range:near=-0,far=7", "range:near=0,far=7", "range:near=0,far=7");
}
END_TEST

static void check_refused(const char *text, pm_status want, const char *part)
{
    pm__spec spec;
    pm_error error = {""};
    const pm_status status = pm__spec_parse(&things, text, &spec, &error);
    ck_assert_msg(status == want, "'%s': status %d", text, (int)status);
    ck_assert_msg(strstr(error.text, part) != NULL, "'%s': '%s' lacks '%s'", text, error.text, part);
}

START_TEST(bad_specs)
{
    check_refused("", PM_ENAME, "unknown thing");
    check_refused("cobe", PM_ENAME, "unknown thing 'cobe'; did you mean 'cone'?");
    check_refused("zzzzzz", PM_ENAME, "there are: disc, cone, combined, range");
    check_refused("disc:", PM_EINVAL, "key=value");
    check_refused("disc:k=1", PM_ENAME, "no parameter 'k'; there are none");
    check_refused("cone:lost=full", PM_ENAME, "did you mean 'last'?");
    check_refused("cone:last=ful", PM_EINVAL, "full|half|none");
    check_refused("cone:last", PM_EINVAL, "key=value");
    check_refused("cone:k=1,k=2", PM_EINVAL, "twice");
    check_refused("cone:k=0.5", PM_EINVAL, "k=0.5: expected a number from 1 to 100");
    check_refused("cone:k=nan", PM_EINVAL, "from 1 to 100");
    check_refused("cone:k=", PM_EINVAL, "from 1 to 100");
    check_refused("cone:k=2x", PM_EINVAL, "from 1 to 100");
    check_refused("cone:k=2,,last=full", PM_EINVAL, "key=value");
    check_refused("combined:maps=2.5", PM_EINVAL, "an integer from 1 to 64");
    check_refused("disc,cone", PM_EINVAL, "key=value");
    check_refused("range:near=3,far=2", PM_EINVAL, "nearer");
}
END_TEST

static void check_list(const char *text, const char *want)
{
    pm__spec *specs = NULL;
    size_t count = 0;
    pm_error error = {""};
    char got[1000] = "", one[PM__MAX_SPEC];
    PM_CHECK_OK(pm__spec_parse_list(&things, text, &specs, &count, &error), error);
    for (size_t i = 0; i < count; i++) {
        pm__spec_format_short(&specs[i], one, sizeof one);
        strcat(strcat(got, i ? " " : ""), one);
    }
    free(specs);
    ck_assert_str_eq(got, want);
}

START_TEST(lists)
{
    check_list("disc", "disc");
    check_list("disc,cone:k=1.2,last=half,combined", "disc cone:k=1.2,last=half combined");
    check_list("cone,k=3,disc", "cone:k=3 disc");
    check_list("all", "disc cone combined range");
    check_list("disc,all", "disc disc cone combined range");
}
END_TEST

static void check_bad_list(const char *text, const char *part)
{
    pm__spec *specs = NULL;
    size_t count = 0;
    pm_error error = {""};
    const pm_status status = pm__spec_parse_list(&things, text, &specs, &count, &error);
    ck_assert_msg(status == PM_EINVAL || status == PM_ENAME, "'%s': status %d", text, (int)status);
    ck_assert_msg(strstr(error.text, part) != NULL, "'%s': '%s' lacks '%s'", text, error.text, part);
    free(specs);
}

START_TEST(bad_lists)
{
    check_bad_list("", "empty name");
    check_bad_list("disc,", "empty name");
    check_bad_list("disc,,cone", "empty name");
    check_bad_list("k=1,cone", "'k=1' follows no thing");
    check_bad_list("disc,cobe:k=1", "did you mean 'cone'?");
    check_bad_list("all:k=1", "no parameters");
    check_bad_list("all,k=1", "no parameters");
    check_bad_list("disc,cone:k=7,k=8", "twice");
}
END_TEST

START_TEST(lists_are_appended)
{
    pm__spec *specs = NULL;
    size_t count = 0;
    PM_CHECK_OK(pm__spec_parse_list(&things, "cone", &specs, &count, NULL), (pm_error){""});
    PM_CHECK_OK(pm__spec_parse_list(&things, "disc", &specs, &count, NULL), (pm_error){""});
    ck_assert_uint_eq(count, 2);
    ck_assert_ptr_eq(specs[0].entry, &cone);
    ck_assert_ptr_eq(specs[1].entry, &disc);
    free(specs);
}
END_TEST

START_TEST(truncated_output)
{
    pm__spec spec;
    char text[32];
    PM_CHECK_OK(pm__spec_parse(&things, "cone:last=half", &spec, NULL), (pm_error){""});
    for (size_t size = 1; size <= sizeof text; size++) {
        memset(text, 'x', sizeof text);
        pm__spec_format(&spec, text, size);
        const size_t length = size - 1 < strlen("cone:k=1.1,last=half") ? size - 1 : strlen("cone:k=1.1,last=half");
        ck_assert_uint_eq(strlen(text), length);
        ck_assert(memcmp(text, "cone:k=1.1,last=half", length) == 0);
    }
}
END_TEST

START_TEST(numbers_in)
{
    const struct {
        const char *text;
        double value;
    } good[] = {{"0", 0},        {"-1.5", -1.5}, {"+2", 2},        {".5", 0.5},           {"5.", 5},
                {"1e3", 1000.0}, {"1E-2", 0.01}, {"4.9e-324", 0x1p-1074}, {"0.1", 0.1}};
    const char *const bad[] = {"",    " 1",  "1 ",  "1,5",    "0x10", "inf", "-infinity", "nan", "1e",
                               "e5",  ".",   "-",   "1e400",  "1..2", "1e+", "--1",       "1d5", "٣"};
    double value;
    for (size_t i = 0; i < sizeof good / sizeof *good; i++) {
        ck_assert_msg(pm__parse_double(good[i].text, &value) == 0, "'%s' was refused", good[i].text);
        ck_assert(value == good[i].value);
    }
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++)
        ck_assert_msg(pm__parse_double(bad[i], &value) != 0, "'%s' was taken", bad[i]);
}
END_TEST

START_TEST(numbers_out)
{
    const struct {
        double value;
        const char *text;
    } exact[] = {{0.1, "0.1"},     {40000, "40000"}, {1.0 / 3.0, "0.3333333333333333"}, {-2.5, "-2.5"},
                 {1e-7, "1e-07"},  {0, "0"},         {1e300, "1e+300"},                 {123456789, "123456789"},
                 {1e6, "1000000"}, {5e-324, "5e-324"}};
    char text[32];
    for (size_t i = 0; i < sizeof exact / sizeof *exact; i++) {
        pm__format_double(exact[i].value, text);
        ck_assert_str_eq(text, exact[i].text);
    }
}
END_TEST

START_TEST(numbers_read_back)
{
    uint64_t state = 88172645463325252ULL;
    for (int i = 0; i < 20000; i++) {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        double value, back;
        char text[32];
        memcpy(&value, &state, sizeof value);
        if (!isfinite(value))
            continue;
        pm__format_double(value, text);
        ck_assert_msg(pm__parse_double(text, &back) == 0 && back == value, "%a as '%s'", value, text);
    }
}
END_TEST

START_TEST(nearest_names)
{
    const char *const names[] = {"disc", "cone", "gaussian", "epanechnikov", "biweight", "hull"};
    const struct {
        const char *name, *nearest;
    } pairs[] = {{"dsic", "disc"},   {"disk", "disc"},         {"Cone", "cone"},  {"guassian", "gaussian"},
                 {"gausian", "gaussian"}, {"epan", "epanechnikov"}, {"hulll", "hull"}, {"bi", "biweight"}};
    const char *const scenes[] = {"corner", "cornell"}; /* an edit away both: what is left out is typed least */
    ck_assert_str_eq(pm__nearest_name("cornel", scenes, 2), "cornell");
    const char *const far[] = {"", "x", "qqqq", "radiance", "completely-different-and-long"};
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        const char *const got = pm__nearest_name(pairs[i].name, names, 6);
        ck_assert_msg(got && strcmp(got, pairs[i].nearest) == 0, "%s: %s", pairs[i].name, got ? got : "none");
    }
    for (size_t i = 0; i < sizeof far / sizeof *far; i++)
        ck_assert_ptr_null(pm__nearest_name(far[i], names, 6));
}
END_TEST

START_TEST(decimals_of_floats)
{
    static const double decimals[] = {0.04, 0.1, 0.0625, 1e-30, 123456.7, 3.4028235e38, 1e-45, 16777216.0};
    for (size_t i = 0; i < sizeof decimals / sizeof *decimals; i++)
        ck_assert(pm__decimal_of_float((float)decimals[i]) == decimals[i]);
    ck_assert(pm__decimal_of_float(0.0f) == 0.0);
    ck_assert(isinf(pm__decimal_of_float(INFINITY)));
    for (uint32_t bits = 1; bits < 0x7f800000U; bits += 99991) { /* every scale */
        float value;
        memcpy(&value, &bits, sizeof value);
        ck_assert((float)pm__decimal_of_float(value) == value);
    }
}
END_TEST

PM_TEST_MAIN("param", one_spec, bad_specs, lists, bad_lists, lists_are_appended, truncated_output, numbers_in,
             numbers_out, numbers_read_back, decimals_of_floats, nearest_names)
