/* Figures for papers: rows of results as series of points in panels, and the gnuplot scripts that draw them. */
#include "report.h"

#include "../base/memory.h"
#include "../image/embed.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_FIELDS = 4, MOST_PANELS = 12 };

/* What a figure shows: of rows of `command` where `where` is `is`, y against x; a panel for each value of the fields
 * `panel`, in it a series for each of `series`. */
typedef struct figure {
    const char *command, *where, *is;
    const char *panel[MOST_FIELDS], *series[MOST_FIELDS];
    const char *x, *y, *interval;
    const unsigned char *script, *script_end;
} figure;

PM__EMBED(pm__figure_front, "reports/figures/front.gp");
PM__EMBED(pm__figure_rmse, "reports/figures/rmse.gp");
PM__EMBED(pm__figure_search, "reports/figures/search.gp");
PM__EMBED(pm__figure_storage, "reports/figures/storage.gp");
PM__EMBED(pm__figure_converge, "reports/figures/converge.gp");

const char *const pm__report_figure_names[PM__REPORT_FIGURES] = {"front", "rmse", "search", "storage", "converge"};

static const figure figures[PM__REPORT_FIGURES] = {
    {"accuracy", "region", "all", {"case", "photons", "sampler"}, {"estimator"}, "cost_s", "rel_rmse", "rel_rmse_ci95",
     pm__figure_front, pm__figure_front_end},
    {"accuracy", "region", "all", {"case", "photons", "sampler"}, {"estimator"}, "k", "rel_rmse", "rel_rmse_ci95",
     pm__figure_rmse, pm__figure_rmse_end},
    {"search", "kind", "knn", {"case", "photons", "order"}, {"search", "batch"}, "k", "ns_per_query",
     "ns_per_query_ci95", pm__figure_search, pm__figure_search_end},
    {"storage", NULL, NULL, {"scene", "map"}, {"policy"}, "stored", "rel_rmse", "rel_rmse_ci95", pm__figure_storage,
     pm__figure_storage_end},
    {"converge", NULL, NULL, {"scene"}, {"method", "estimator", "alpha"}, "pass", "rel_rmse", "rel_rmse_ci95",
     pm__figure_converge, pm__figure_converge_end},
};

/* Names are numbered as they come. */
typedef struct point {
    size_t panel, series, order;
    double x, y, low, high;
} point;

typedef char label[80];

typedef struct plot {
    point *points;
    size_t count, capacity;
    label *panels, *series;
    size_t panel_count, panel_capacity, series_count, series_capacity;
} plot;

/* The values of the fields, with blanks between, in characters that mean nothing to gnuplot. */
static void name_by(const json_t *row, const char *const fields[MOST_FIELDS], label name)
{
    size_t used = 0;
    *name = '\0';
    for (int i = 0; i < MOST_FIELDS && fields[i]; i++) {
        const json_t *const value = json_object_get(row, fields[i]);
        const char *const gap = used ? " " : "";
        char text[PM__NAME_SIZE] = "";
        if (json_is_string(value))
            pm__report_shorten(fields[i], json_string_value(value), text);
        else if (json_is_number(value))
            (void)snprintf(text, sizeof text, "%s %.6g", fields[i], json_number_value(value));
        if (*text)
            used += (size_t)snprintf(name + used, sizeof(label) - used, "%s%s", gap, text);
        used = used < sizeof(label) ? used : sizeof(label) - 1;
    }
    for (char *p = name; *p; p++)
        if (*p < ' ' || *p > '~' || strchr("\"'`\\%", *p))
            *p = '-';
}

/* The number of a name; a new one where it is not there yet. */
static pm_status number_of(const label name, label **names, size_t *count, size_t *capacity, size_t *number,
                           pm_error *error)
{
    void *list = *names;
    for (*number = 0; *number < *count; ++*number)
        if (strcmp((*names)[*number], name) == 0)
            return PM_OK;
    if (pm__grow(&list, capacity, *count + 1, sizeof(label)) != 0)
        return pm__fail(error, PM_ENOMEM, "out of memory for a figure");
    *names = list;
    memcpy((*names)[(*count)++], name, sizeof(label));
    return PM_OK;
}

/* Axes are logarithmic: what is not above 0 cannot be shown. */
static bool read_point(const json_t *row, const figure *f, point *p)
{
    const json_t *const interval = json_object_get(row, f->interval), *const where =
        f->where ? json_object_get(row, f->where) : NULL;
    if (f->where && (!json_is_string(where) || strcmp(json_string_value(where), f->is) != 0))
        return false;
    p->x = json_number_value(json_object_get(row, f->x));
    p->y = json_number_value(json_object_get(row, f->y));
    p->low = json_number_value(json_array_get(interval, 0));
    p->high = json_number_value(json_array_get(interval, 1));
    if (!(p->low > 0.0 && p->low <= p->y && p->high >= p->y))
        p->low = p->high = p->y;
    return p->x > 0.0 && p->y > 0.0;
}

static pm_status add_row(plot *all, const figure *f, const json_t *row, pm_error *error)
{
    point p = {.order = all->count};
    label name;
    if (!read_point(row, f, &p))
        return PM_OK;
    name_by(row, f->panel, name);
    pm_status status = number_of(name, &all->panels, &all->panel_count, &all->panel_capacity, &p.panel, error);
    if (status == PM_OK) {
        name_by(row, f->series, name);
        status = number_of(name, &all->series, &all->series_count, &all->series_capacity, &p.series, error);
    }
    void *points = all->points;
    if (status == PM_OK && pm__grow(&points, &all->capacity, all->count + 1, sizeof p) != 0)
        status = pm__fail(error, PM_ENOMEM, "out of memory for a figure");
    all->points = points;
    if (status == PM_OK)
        all->points[all->count++] = p;
    return status;
}

static pm_status collect(const pm__report *report, const figure *f, plot *all, pm_error *error)
{
    pm_status status = PM_OK;
    for (size_t i = 0; i < report->result_count; i++) {
        const pm__report_result *const result = &report->results[i];
        for (size_t j = 0; strcmp(result->command, f->command) == 0 && j < json_array_size(result->rows); j++)
            if (status == PM_OK)
                status = add_row(all, f, json_array_get(result->rows, j), error);
    }
    return status;
}

static int compare_sizes(size_t a, size_t b)
{
    return (a > b) - (a < b);
}

static int compare_points(const void *left, const void *right)
{
    const point *const a = left, *const b = right;
    const int panel = compare_sizes(a->panel, b->panel), series = compare_sizes(a->series, b->series);
    return panel ? panel : series ? series : a->x != b->x ? (a->x > b->x) - (a->x < b->x)
                                                          : compare_sizes(a->order, b->order);
}

static bool begins_series(const plot *all, size_t i)
{
    const point *const p = &all->points[i];
    return i == 0 || p->panel != p[-1].panel || p->series != p[-1].series;
}

/* One block a series, as gnuplot counts them: two empty lines between. */
static void write_points(const plot *all, size_t panels, FILE *file)
{
    for (size_t i = 0; i < all->count && all->points[i].panel < panels; i++) {
        const point *const p = &all->points[i];
        if (begins_series(all, i))
            (void)fprintf(file, "%s\"%s\",y,low,high,\"%s\"\n", i ? "\n\n" : "", all->series[p->series],
                          all->panels[p->panel]);
        (void)fprintf(file, "%.9g,%.9g,%.9g,%.9g\n", p->x, p->y, p->low, p->high);
    }
}

/* The last block of a panel, from 0. */
static size_t last_block(const plot *all, size_t panel)
{
    size_t blocks = 0;
    for (size_t i = 0; i < all->count && all->points[i].panel <= panel; i++)
        blocks += begins_series(all, i);
    return blocks - 1;
}

/* What the script does not know: its panels' names and blocks, and in which colour each block is, so that a series has
 * one in all panels. */
static void write_head(const plot *all, size_t panels, const char *data_name, FILE *file)
{
    (void)fprintf(file, "data = '%s'\npanels = %zu\narray titles[%zu]\narray last[%zu]\n", data_name, panels, panels,
                  panels);
    (void)fprintf(file, "array style[%zu]\n", last_block(all, panels - 1) + 1);
    for (size_t i = 0, block = 0; i < all->count && all->points[i].panel < panels; i++)
        if (begins_series(all, i))
            (void)fprintf(file, "style[%zu] = %zu\n", ++block, all->points[i].series + 1);
    for (size_t p = 0; p < panels; p++)
        (void)fprintf(file, "titles[%zu] = '%s'\nlast[%zu] = %zu\n", p + 1, all->panels[p], p + 1, last_block(all, p));
}

pm_status pm__report_write_figure(const pm__report *report, size_t index, const char *data_name, FILE *data,
                                  FILE *script, bool *drawn, pm_error *error)
{
    const figure *const f = &figures[index];
    plot all = {0};
    const pm_status status = collect(report, f, &all, error);
    *drawn = status == PM_OK && all.count > 0;
    if (*drawn) {
        const size_t panels = all.panel_count < MOST_PANELS ? all.panel_count : MOST_PANELS;
        qsort(all.points, all.count, sizeof *all.points, compare_points);
        write_points(&all, panels, data);
        write_head(&all, panels, data_name, script);
        (void)fwrite(f->script, 1, (size_t)((uintptr_t)f->script_end - (uintptr_t)f->script), script);
    }
    free(all.points);
    free(all.panels);
    free(all.series);
    return status;
}
