/* `photonbench converge` as a user runs it: tiny sizes; how far the numbers are right is for the tests of what lies
 * below. */
#include "../program.h"
#include "../rows.h"

#include <stdbool.h>
#include <time.h>

#define TINY "--trials 3 --passes 6 --photons-per-pass 2000 --size 8x8 --k 20 "

static const char row_keys[] =
    "scene paths method estimator alpha pass photons seconds rel_bias rel_noise rel_rmse rel_rmse_ci95 points trials "
    "truth truth_mean rel_bias_ci95 rms_bias rms_bias_ci95 rel_noise_ci95 predicted_rel_bias predicted_rms_bias "
    "predicted_rel_noise estimated_rel_rmse estimated_rel_rmse_mean estimate_right status detail";
static const char fit_keys[] = "scene method estimator alpha quantity first_pass last_pass slope slope_ci95 predicted "
                               "asymptote status detail";
static const char point_keys[] = "scene method estimator alpha x y pass radius count radiance truth";

START_TEST(rows_have_the_contract)
{
    json_t *const root = pm__expect_json("converge plate " TINY "--json -");
    static const int passes[] = {1, 2, 4, 6};
    pm__check_keys(root, "schema command version options seed machine wall_s rows fits points");
    ck_assert_str_eq(pm__text_of(root, "command"), "converge");
    ck_assert_uint_eq(pm__items(root, "rows"), 4);
    for (size_t i = 0; i < 4; i++) {
        json_t *const row = pm__item(root, "rows", i);
        pm__check_keys(row, row_keys);
        ck_assert_str_eq(pm__text_of(row, "scene"), "scene:plate:ior=1.5,thickness=0.2");
        ck_assert_str_eq(pm__text_of(row, "paths"), "LSSD");
        ck_assert_str_eq(pm__text_of(row, "method"), "ppm:flux=corrected,start=zero");
        ck_assert_str_eq(pm__text_of(row, "estimator"), "disc:last=full");
        ck_assert_str_eq(pm__text_of(row, "truth"), "exact");
        ck_assert_str_eq(pm__text_of(row, "status"), "ok");
        PM_CHECK_NEAR(pm__number_of(row, "alpha"), 0.667, 1e-15);
        ck_assert_int_eq((int)pm__number_of(row, "pass"), passes[i]);
        ck_assert_int_eq((int)pm__number_of(row, "photons"), 2000 * passes[i]);
        ck_assert_int_eq((int)pm__number_of(row, "trials"), 3);
        ck_assert_double_gt(pm__number_of(row, "points"), 0.0);
        ck_assert_double_le(pm__number_of(row, "points"), 64.0);
        ck_assert_double_gt(pm__number_of(row, "truth_mean"), 0.0);
        ck_assert_double_gt(pm__number_of(row, "rel_noise"), 0.0);
        ck_assert_double_gt(pm__number_of(row, "predicted_rel_noise"), 0.0);
        ck_assert_uint_eq(json_array_size(json_object_get(row, "rel_rmse_ci95")), 2);
        /* The mean square splits into bias and noise: rel_rmse is at least either part of it. */
        ck_assert_double_ge(pm__number_of(row, "rel_rmse"), fabs(pm__number_of(row, "rel_bias")));
        ck_assert_double_ge(pm__number_of(row, "rel_rmse"), sqrt(2.0 / 3.0) * pm__number_of(row, "rel_noise"));
    }
    json_decref(root);
}
END_TEST

START_TEST(fits_stand_beside_rows)
{
    static const char *const quantities[] = {"variance", "bias", "rmse"};
    json_t *const root = pm__expect_json("converge plate " TINY "--alpha 0.5,0.8 --json -");
    ck_assert_uint_eq(pm__items(root, "fits"), 6);
    for (size_t i = 0; i < 6; i++) {
        json_t *const fit = pm__item(root, "fits", i);
        const double alpha = i < 3 ? 0.5 : 0.8;
        const bool fits = strcmp(pm__text_of(fit, "status"), "ok") == 0;
        pm__check_keys(fit, fit_keys);
        ck_assert_str_eq(pm__text_of(fit, "quantity"), quantities[i % 3]);
        PM_CHECK_NEAR(pm__number_of(fit, "alpha"), alpha, 1e-15);
        /* Errata 7: variance falls as i^-alpha, bias as i^(alpha - 1), the error as the slower of them. */
        const double want[] = {-alpha, alpha - 1.0, fmax(-alpha / 2.0, alpha - 1.0)};
        PM_CHECK_NEAR(pm__number_of(fit, "asymptote"), want[i % 3], 1e-12);
        ck_assert(fits || strcmp(pm__text_of(fit, "status"), "unfit") == 0);
        ck_assert(pm__is_null(fit, "slope") == !fits && pm__is_null(fit, "first_pass") == !fits);
        ck_assert(fits || *pm__text_of(fit, "detail"));
    }
    ck_assert_str_eq(pm__text_of(pm__item(root, "fits", 0), "status"), "ok"); /* noise is always clear */
    ck_assert_double_lt(pm__number_of(pm__item(root, "fits", 0), "slope"), 0.0);
    json_decref(root);
}
END_TEST

/* The talk's three graphs: what has been found, how far lookups reach, the estimate. */
START_TEST(watched_pixels)
{
    json_t *root = pm__expect_json("converge plate " TINY "--at 3,4 --at 5,2 --at 3,4 --json -");
    ck_assert_uint_eq(pm__items(root, "points"), 8);
    for (size_t i = 0; i < 8; i++) {
        json_t *const point = pm__item(root, "points", i);
        pm__check_keys(point, point_keys);
        ck_assert_int_eq((int)pm__number_of(point, "x"), i < 4 ? 3 : 5);
        ck_assert_int_eq((int)pm__number_of(point, "y"), i < 4 ? 4 : 2);
        ck_assert_int_eq((int)pm__number_of(point, "pass"), (int)pm__number_of(pm__item(root, "rows", i % 4), "pass"));
        ck_assert_uint_eq(json_array_size(json_object_get(point, "radiance")), 3);
        ck_assert_uint_eq(json_array_size(json_object_get(point, "truth")), 3);
        if (i % 4) { /* radii shrink, photons gather */
            ck_assert_double_lt(pm__number_of(point, "radius"),
                                pm__number_of(pm__item(root, "points", i - 1), "radius"));
            ck_assert_double_gt(pm__number_of(point, "count"), pm__number_of(pm__item(root, "points", i - 1), "count"));
        }
    }
    json_decref(root);
    root = pm__expect_json("converge plate " TINY "--json -");
    ck_assert_uint_eq(pm__items(root, "points"), 0);
    json_decref(root);
}
END_TEST

START_TEST(options_are_echoed)
{
    json_t *const root = pm__expect_json(
        "converge plate water:ior=1.4 " TINY "--method ppm,pppm --estimator disc,cone --alpha 0.5,0.8 --photons=3000 "
        "--radius=0.25 --at=1,2 --sampler=sobol --search=grid --front=off --seconds=1000 --threads=2 --seed=7 "
        "--json=-");
    static const struct {
        const char *name, *text; /* as JSON */
    } want[] = {
        {"scene", "[\"scene:plate:ior=1.5,thickness=0.2\",\"scene:water:ior=1.4\"]"},
        {"method", "[\"ppm:flux=corrected,start=zero\",\"pppm\"]"},
        {"estimator", "[\"disc:last=full\",\"cone:k=1.1,last=full\"]"},
        {"alpha", "[0.5,0.8]"}, {"trials", "3"},      {"passes", "6"},          {"photons_per_pass", "2000"},
        {"photons", "3000"},    {"radius", "0.25"},   {"k", "20"},              {"size", "\"8x8\""},
        {"seconds", "1000.0"},  {"error", "null"},  {"at", "[[1,2]]"},    {"sampler", "[\"sobol\"]"},
        {"search", "\"grid\""},
        {"front", "\"off\""},   {"profile", "\"quick\""}, {"threads", "2"},
    };
    json_t *const options = json_object_get(root, "options");
    ck_assert_uint_eq(json_object_size(options), sizeof want / sizeof *want);
    for (size_t i = 0; i < sizeof want / sizeof *want; i++) {
        char *const got = json_dumps(json_object_get(options, want[i].name),
                                     JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(15));
        ck_assert_ptr_nonnull(got);
        ck_assert_msg(strncmp(got, want[i].text, strlen(want[i].text)) == 0, "%s: %s, not %s", want[i].name, got,
                      want[i].text);
        free(got);
    }
    ck_assert_int_eq((int)pm__number_of(root, "seed"), 7);
    /* --photons ends a run after the pass that reaches it: the second. */
    ck_assert_uint_eq(pm__items(root, "rows"), 2 * 2 * 2 * 2 * 2);
    ck_assert_int_eq((int)pm__number_of(pm__item(root, "rows", 1), "photons"), 4000);
    json_decref(root);
}
END_TEST

/* By itself each method does as is fastest; a search that is named does it all. Sums are the same but for rounding. */
START_TEST(a_search_where_one_is_named)
{
    json_t *const own = pm__expect_json("converge plate " TINY "--json -");
    ck_assert_str_eq(pm__text_of(json_object_get(own, "options"), "search"), "auto");
    static const char *const searches[] = {"grid", "wide"};
    for (size_t s = 0; s < 2; s++) {
        char arguments[200];
        (void)snprintf(arguments, sizeof arguments, "converge plate " TINY "--search %s --json -", searches[s]);
        json_t *const named = pm__expect_json(arguments);
        ck_assert_str_eq(pm__text_of(json_object_get(named, "options"), "search"), searches[s]);
        for (size_t i = 0; i < 4; i++) {
            const double want = pm__number_of(pm__item(own, "rows", i), "rel_rmse");
            PM_CHECK_NEAR(pm__number_of(pm__item(named, "rows", i), "rel_rmse"), want, 1e-9 * want);
        }
        json_decref(named);
    }
    json_decref(own);
}
END_TEST

/* One for each scene, method, estimator and alpha, in this order. */
START_TEST(series_are_all_combinations)
{
    json_t *const root = pm__expect_json(
        "converge plate water --trials 2 --passes 1 --photons-per-pass 500 --size 4x4 --k 10 --method ppm,pppm "
        "--estimator disc,cone:k=2 --alpha 0.5 --alpha 0.8,0.5 --json -");
    ck_assert_uint_eq(pm__items(root, "rows"), 16);
    for (size_t i = 0; i < 16; i++) {
        const json_t *const row = pm__item(root, "rows", i);
        ck_assert_int_eq(pm__text_of(row, "scene")[6], i < 8 ? 'p' : 'w');
        ck_assert_int_eq(pm__text_of(row, "method")[1] == pm__text_of(row, "method")[2], i / 4 % 2); /* pPPm */
        ck_assert_int_eq(pm__text_of(row, "estimator")[0], i / 2 % 2 ? 'c' : 'd');
        PM_CHECK_NEAR(pm__number_of(row, "alpha"), i % 2 ? 0.8 : 0.5, 1e-15);
    }
    json_decref(root);
}
END_TEST

/* Rows, fits and points but for times. */
static char *comparable(json_t *root)
{
    for (size_t i = 0; i < pm__items(root, "rows"); i++)
        (void)json_object_del(pm__item(root, "rows", i), "seconds");
    json_t *const kept = json_pack("[O, O, O]", json_object_get(root, "rows"), json_object_get(root, "fits"),
                                   json_object_get(root, "points"));
    char *const text = json_dumps(kept, JSON_COMPACT | JSON_REAL_PRECISION(17));
    ck_assert_ptr_nonnull(text);
    json_decref(kept);
    json_decref(root);
    return text;
}

START_TEST(threads_do_not_matter)
{
    char *const one =
        comparable(pm__expect_json("converge glass-sphere " TINY "--method all --at 4,4 --threads 1 --json -"));
    char *const two =
        comparable(pm__expect_json("converge glass-sphere " TINY "--method all --at 4,4 --threads 2 --json -"));
    char *const other =
        comparable(pm__expect_json("converge glass-sphere " TINY "--method all --at 4,4 --seed 2 --json -"));
    ck_assert_str_eq(one, two);
    ck_assert_str_ne(one, other);
    free(one);
    free(two);
    free(other);
}
END_TEST

static void check_width(const char *text)
{
    for (const char *line = text; *line;) {
        const size_t length = strcspn(line, "\n");
        ck_assert_msg(length <= 100, "%zu columns: %.*s", length, (int)length, line);
        line += length + (line[length] == '\n');
    }
}

START_TEST(screen_is_100_columns)
{
    const pm__run *const run = pm__expect("converge plate scene:water " TINY "--at 3,4 --quiet", 0, NULL);
    static const char *const parts[] = {
        "scene:plate:ior=1.5,thickness=0.2: ppm by disc, alpha 0.667; ", "exact truth, mean", "paths LSSD",
        "   pass   photons seconds    bias    95 % interval predicted noise predicted   rmse    95 % interval\n",
        "\n      6     12000 ", "\n  variance ", "\n  bias ", "\n  rmse ", "\n  at 3,4\n", "bias, noise, rmse: in %"};
    for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
        ck_assert_msg(strstr(run->out, parts[i]) != NULL, "no '%s' in %s", parts[i], run->out);
    check_width(run->out);
    check_width(pm__expect("help converge", 0, NULL)->out);
}
END_TEST

START_TEST(rows_as_tables)
{
    static const char head[] = "scene,paths,method,estimator,alpha,pass,photons,seconds,rel_bias,rel_noise,rel_rmse,"
                               "rel_rmse_ci95_low,rel_rmse_ci95_high,points,trials,truth,";
    const char *out = pm__expect("converge plate " TINY "--csv -", 0, NULL)->out;
    ck_assert(strncmp(out, head, sizeof head - 1) == 0);
    ck_assert_ptr_nonnull(strstr(out, "\n\"scene:plate:ior=1.5,thickness=0.2\",LSSD,"));
    out = pm__expect("converge plate " TINY "--markdown -", 0, NULL)->out;
    ck_assert(strncmp(out, "| scene | paths | method | estimator | alpha | pass | ", 50) == 0);
}
END_TEST

/* What one kernel cannot do is a row that says why; where none can, nothing was done. */
START_TEST(what_cannot_be_measured)
{
    json_t *const root = pm__expect_json("converge plate " TINY "--estimator combined,disc --json -");
    ck_assert_uint_eq(pm__items(root, "rows"), 5);
    ck_assert_uint_eq(pm__items(root, "fits"), 3);
    const json_t *const row = pm__item(root, "rows", 0);
    ck_assert_str_eq(pm__text_of(row, "status"), "unsupported");
    ck_assert_ptr_nonnull(strstr(pm__text_of(row, "detail"), "combined"));
    ck_assert(pm__is_null(row, "pass") && pm__is_null(row, "rel_rmse"));
    ck_assert(pm__is_null(row, "points") && pm__is_null(row, "truth"));
    ck_assert_str_eq(pm__text_of(pm__item(root, "rows", 1), "status"), "ok");
    json_decref(root);
    const pm__run *const run = pm__expect("converge plate " TINY "--estimator combined,disc", 0, NULL);
    ck_assert_ptr_nonnull(strstr(run->out, "\n  unsupported: combined"));
    check_width(run->out);
    ck_assert_str_eq(pm__expect("converge plate " TINY "--estimator combined", 2, "combined")->out, "");
    (void)pm__expect("converge plate " TINY "--method ppm:flux=printed --error 3%", 2,
                     "ppm:flux=printed cannot estimate its own error: that takes a mean of passes in which noise");
    (void)pm__expect("converge wall " TINY, 2, "is black where its truth is known: there is no relative error");
    (void)pm__expect("converge cornell:albedo=0.5 " TINY, 2,
                     "the stored reference of scene:cornell is of its defaults");
    ck_assert_str_eq(pm__expect("converge corner wall " TINY "--estimator hull,combined", 2, "hull")->out, "");
}
END_TEST

static const struct {
    const char *arguments, *message;
} usage_errors[] = {
    {"converge", "a scene is needed"},
    {"converge plat", "unknown scene 'plat'; did you mean 'plate'?"},
    {"converge square", "unknown scene 'square'"},
    {"converge plate:iro=2", "did you mean 'ior'?"},
    {"converge plate --method sppmm", "--method: unknown progressive method 'sppmm'; did you mean 'sppm'?"},
    {"converge plate --method visualize", "--method: unknown progressive method 'visualize'; there are: "},
    {"converge plate --method ppm:flux=new", "expected one of corrected|printed"},
    {"converge plate --estimator dsic", "--estimator: unknown estimator 'dsic'; did you mean 'disc'?"},
    {"converge plate --alpha 0", "--alpha: '0' is not a number above 0 and below 1"},
    {"converge plate --alpha 1", "--alpha: '1' is not a number above 0 and below 1"},
    {"converge plate --alpha 0.5,,0.8", "--alpha: '' is not a number"},
    {"converge plate --alpha 0.5,nan", "--alpha: 'nan' is not a number"},
    {"converge plate --alpha -0.5", "--alpha: '-0.5' is not a number"},
    {"converge plate --trials 1", "--trials: '1' is not an integer from 2"},
    {"converge plate --passes 0", "--passes: '0' is not an integer from 1"},
    {"converge plate --passes 1.5", "--passes: '1.5' is not an integer from 1"},
    {"converge plate --photons-per-pass 0", "--photons-per-pass: '0' is not an integer from 1"},
    {"converge plate --photons 0", "--photons: '0' is not an integer from 1"},
    {"converge plate --radius -1", "--radius: '-1' is not a number above 0"},
    {"converge plate --radius 0", "--radius: '0' is not a number above 0"},
    {"converge plate --k 0", "--k: '0' is not an integer from 1"},
    {"converge plate --k 5,10", "--k: '5,10' is not an integer"},
    {"converge plate --k 60 --photons-per-pass 50", "--k 60 is more than --photons-per-pass 50"},
    {"converge plate --photons-per-pass 40", "--k 50 (the default) is more than --photons-per-pass 40"},
    {"converge plate --size 32", "--size: '32': expected WIDTHxHEIGHT"},
    {"converge plate --seconds 0", "--seconds: '0' is not a number above 0"},
    {"converge plate --error 0", "--error: '0' is neither a percentage nor a number, above 0, as 2% or 0.02"},
    {"converge plate --error 0%", "--error: '0%' is neither a percentage"},
    {"converge plate --error -2%", "--error: '-2%' is neither a percentage"},
    {"converge plate --error 2%%", "--error: '2%%' is neither a percentage"},
    {"converge plate --error %", "--error: '%' is neither a percentage"},
    {"converge plate --sampler poisson,sobol", "one sampler at a time"},
    {"converge plate --front maybe", "--front: 'maybe': expected on or off"},
    {"converge plate --profile slow", "--profile: 'slow': expected full or quick"},
    {"converge plate --at 3", "--at: '3': expected a pixel X,Y"},
    {"converge plate --at 1,2,3", "--at: '1,2,3': expected a pixel X,Y"},
    {"converge plate --at -1,2", "--at: '-1,2': expected a pixel X,Y"},
    {"converge plate --at 32,0", "--at 32,0 lies outside the image of 32x32 pixels"},
    {"converge plate --size 8x4 --at 3,4", "--at 3,4 lies outside the image of 8x4 pixels"},
    {"converge plate --spp 4", "unknown option '--spp'"},
    {"converge plate --json - --csv -", "--json and --csv both write to '-'"},
};

START_TEST(every_usage_error)
{
    for (size_t i = 0; i < sizeof usage_errors / sizeof *usage_errors; i++)
        ck_assert_str_eq(pm__expect(usage_errors[i].arguments, 2, usage_errors[i].message)->out, "");
}
END_TEST

START_TEST(complete_or_absent)
{
    (void)pm__expect("converge plate " TINY "--json /dev/full", 4, "/dev/full: cannot be written");
    /* A bad path shows before the work, which here would take days. */
    (void)pm__expect("converge plate --size 1024x1024 --trials 1000 --csv /nonexistent/a.csv", 4,
                     "/nonexistent/a.csv: cannot be opened");
}
END_TEST

/* A radius given is that of the first lookup, so that no k is needed. */
START_TEST(a_first_radius)
{
    json_t *const root = pm__expect_json("converge plate --trials 2 --passes 2 --photons-per-pass 40 --size 4x4 "
                                         "--radius 0.015625 --at 2,2 --json -");
    ck_assert_double_le(pm__number_of(pm__item(root, "points", 0), "radius"), 0.015625);
    json_decref(root);
}
END_TEST

/* A time that is over at once leaves the first pass of each run. */
START_TEST(seconds_end_it)
{
    const time_t start = time(NULL);
    json_t *const root = pm__expect_json("converge plate --trials 2 --passes 1000000 --photons-per-pass 2000 "
                                         "--size 8x8 --k 20 --seconds 0.2 --json -");
    const size_t rows = pm__items(root, "rows");
    ck_assert_uint_ge(rows, 1);
    ck_assert_double_lt(pm__number_of(pm__item(root, "rows", rows - 1), "pass"), 1000000.0);
    ck_assert_int_le(time(NULL) - start, 60);
    json_decref(root);
}
END_TEST

/* No limit on photons ends what emits none: what does must be asked for. */
START_TEST(photons_end_what_emits_them)
{
    json_t *const root = pm__expect_json("converge furnace " TINY
                                         "--passes 5 --photons 4000 --method path,light --json -");
    ck_assert_uint_eq(pm__items(root, "rows"), 4 + 2);
    ck_assert(pm__is_null(pm__item(root, "rows", 3), "photons"));
    ck_assert_double_eq(pm__number_of(pm__item(root, "rows", 3), "pass"), 5.0);
    ck_assert_double_eq(pm__number_of(pm__item(root, "rows", 5), "pass"), 2.0);
    ck_assert_double_eq(pm__number_of(pm__item(root, "rows", 5), "photons"), 4000.0);
    json_decref(root);
    ck_assert_ptr_nonnull(strstr(pm__expect("converge furnace " TINY "--method path", 0, NULL)->out,
                                 "\n      1         - "));
    (void)pm__expect("converge furnace --photons 4000 --method ppm,path", 2, "--photons does not end path, which emits "
                     "none: it needs --passes, --seconds or --error too");
    (void)pm__expect("converge furnace --photons 4000 --size 2x2 --trials 2 --method path --seconds 0.01 --quiet", 0,
                     NULL);
}
END_TEST

/* Two alphas that differ look different. */
START_TEST(alpha_in_full)
{
    const char *const out = pm__expect("converge plate " TINY "--alpha 0.66666666666666663,0.667", 0, NULL)->out;
    ck_assert_ptr_nonnull(strstr(out, ", alpha 0.6666666666666666;"));
    ck_assert_ptr_nonnull(strstr(out, ", alpha 0.667;"));
    ck_assert_ptr_nonnull(strstr(out, "after 1 pass the bias is not"));
}
END_TEST

/* In percent or not it is the same error; rows and table say what came of it. A method that cannot is a row that says
 * so. */
START_TEST(an_error_ends_it)
{
    json_t *const root = pm__expect_json("converge plate " TINY "--passes 1000 --error 25% --method ppm,pm --json -");
    const size_t rows = pm__items(root, "rows") - 1;
    const json_t *const first = pm__item(root, "rows", 0), *const row = pm__item(root, "rows", rows - 1);
    ck_assert_double_eq(pm__number_of(json_object_get(root, "options"), "error"), 0.25);
    ck_assert(pm__is_null(first, "estimated_rel_rmse") && pm__is_null(first, "estimate_right")); /* one pass */
    ck_assert_double_lt(pm__number_of(row, "pass"), 1000.0);
    ck_assert_double_ge(pm__number_of(row, "pass"), 8.0);
    ck_assert_double_le(pm__number_of(row, "estimated_rel_rmse"), 0.25);
    ck_assert_double_gt(pm__number_of(row, "estimated_rel_rmse_mean"), 0.0);
    ck_assert_double_gt(pm__number_of(row, "estimate_right"), 0.5);
    ck_assert_str_eq(pm__text_of(pm__item(root, "rows", rows), "status"), "unsupported");
    ck_assert_ptr_nonnull(strstr(pm__text_of(pm__item(root, "rows", rows), "detail"), "cannot estimate its own error"));
    json_decref(root);
    const char *const out = pm__expect("converge plate " TINY "--passes 1000 --error 0.25", 0, "")->out;
    ck_assert_ptr_nonnull(strstr(out, "   pass  first run  mean of runs   rmse  right points\n"));
    ck_assert_ptr_nonnull(strstr(out, "\n  25 % ended the first run\n"));
    check_width(out);
    ck_assert_ptr_nonnull(strstr(pm__expect("converge plate " TINY "--error 1%", 0, "")->out,
                                 "\n  1 % was not reached: passes, photons or time ended it\n"));
}
END_TEST

static void pause_ms(long ms)
{
    const struct timespec t = {ms / 1000, ms % 1000 * 1000000};
    (void)nanosleep(&t, NULL);
}

/* The series that was complete is there, and of the one in hand the trials that were. */
START_TEST(interrupted)
{
    const pm__test_directory place = pm__test_directory_create();
    char json[PM__TEST_PATH], out[PM__TEST_PATH], err[PM__TEST_PATH], text[1000];
    char arguments[2 * PM__TEST_PATH];
    (void)snprintf(arguments, sizeof arguments,
                   "converge plate water --trials 100000 --passes 3 --photons-per-pass 500 --size 4x4 --k 20 --json %s",
                   pm__test_path(&place, "a.json", json));
    const pid_t child = pm__start(arguments, pm__test_path(&place, "out", out), pm__test_path(&place, "err", err));
    for (int i = 0; i < 2000 && pm__test_directory_entries(&place, 0) < 3; i++)
        pause_ms(5);
    pause_ms(1500); /* into the trials */
    ck_assert_int_eq(kill(child, SIGINT), 0);
    ck_assert_int_eq(pm__wait(child), 130);
    ck_assert_int_gt(pm__test_read(err, text, sizeof text), 0);
    ck_assert_ptr_nonnull(strstr(text, "converge: interrupted: "));
    json_t *const root = json_load_file(json, 0, NULL);
    ck_assert_ptr_nonnull(root);
    ck_assert(json_is_true(json_object_get(root, "interrupted")));
    ck_assert_uint_eq(pm__items(root, "rows"), 3); /* after passes 1, 2, 3 of the first scene */
    const json_t *const row = pm__item(root, "rows", 0);
    ck_assert_str_eq(pm__text_of(row, "status"), "interrupted");
    ck_assert_ptr_nonnull(strstr(pm__text_of(row, "detail"), " of 100000 trials"));
    ck_assert_double_ge(pm__number_of(row, "trials"), 2.0);
    ck_assert_double_lt(pm__number_of(row, "trials"), 100000.0);
    ck_assert_double_gt(pm__number_of(row, "rel_rmse"), 0.0);
    json_decref(root);
    pm__test_directory_remove(&place);
}
END_TEST

PM_TEST_MAIN("cli converge", rows_have_the_contract, fits_stand_beside_rows, watched_pixels, options_are_echoed,
             series_are_all_combinations, threads_do_not_matter, screen_is_100_columns, rows_as_tables,
             what_cannot_be_measured, every_usage_error, complete_or_absent, a_first_radius, seconds_end_it,
             photons_end_what_emits_them, alpha_in_full, a_search_where_one_is_named, an_error_ends_it, interrupted)
