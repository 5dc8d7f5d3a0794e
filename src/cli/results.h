/* Rows as data, and the files that they go to. */
#ifndef PM_CLI_RESULTS_H
#define PM_CLI_RESULTS_H

#include "../base/output.h"
#include "../stats/stats.h"
#include "options.h"

#include <jansson.h>

enum { PM__MAX_FIELDS = 48 };

/* One value of a row. A number or interval that is not finite is the absent value: null, or nothing in CSV. */
typedef enum pm__cell_type {
    PM__ABSENT,
    PM__TEXT,
    PM__FLAG,
    PM__COUNT,
    PM__NUMBER,
    PM__INTERVAL_OF, /* [number, high]; the name of its field ends in _ci95 */
    PM__TREE
} pm__cell_type;

typedef struct pm__cell {
    pm__cell_type type;
    const char *text; /* PM__TEXT; PM__TREE: its form in CSV. Lives until the next row */
    bool flag;
    size_t count;
    double number, high;
    json_t *tree; /* PM__TREE: the writer's from then on (json_decref) */
} pm__cell;

static inline pm__cell pm__text_cell(const char *text)
{
    return (pm__cell){.type = text ? PM__TEXT : PM__ABSENT, .text = text};
}

static inline pm__cell pm__flag_cell(bool flag)
{
    return (pm__cell){.type = PM__FLAG, .flag = flag};
}

static inline pm__cell pm__count_cell(size_t count)
{
    return (pm__cell){.type = PM__COUNT, .count = count};
}

/* 0 says that there is none. */
static inline pm__cell pm__positive_cell(size_t count)
{
    return (pm__cell){.type = count ? PM__COUNT : PM__ABSENT, .count = count};
}

static inline pm__cell pm__number_cell(double number)
{
    return (pm__cell){.type = PM__NUMBER, .number = number};
}

static inline pm__cell pm__interval_cell(pm__interval interval)
{
    return (pm__cell){.type = PM__INTERVAL_OF, .number = interval.low, .high = interval.high};
}

/* Further rows, of another kind: they stand beside "rows" in JSON, and there only. */
typedef struct pm__side_rows {
    const char *name;
    const char *const *fields;
    size_t field_count, row_count;
    void (*row)(void *context, size_t index, pm__cell *cells); /* as below */
    void *context;
} pm__side_rows;

/* What a command found. */
typedef struct pm__results {
    const char *command;
    json_t *options;           /* borrowed: the options in effect */
    const pm__settings *settings;
    bool seeded;               /* the command draws random numbers */
    double wall_s;
    bool interrupted;          /* not all of it was done */
    const char *const *fields; /* field_count names; the first plain_count go to CSV and Markdown */
    size_t field_count, plain_count;
    size_t row_count;
    /* Fills in the cells of a row (field_count, absent before). */
    void (*row)(void *context, size_t index, pm__cell *cells);
    void *context;
    const pm__side_rows *beside; /* [beside_count] */
    size_t beside_count;
} pm__results;

/* One writer a format. Writes are unchecked: the file's owner checks it. */
void pm__write_json(FILE *file, const pm__results *results);
void pm__write_csv(FILE *file, const pm__results *results);
void pm__write_markdown(FILE *file, const pm__results *results);

/* Lists for "options": canonical names; whole numbers. write_json.c */
json_t *pm__spec_names(const pm__spec *specs, size_t count);
json_t *pm__number_list(const size_t *values, size_t count);

/* The "machine" object; NULL if out of memory. machine.c */
json_t *pm__machine(void);

/* Bytes that may still be taken, by the system's word and the control group's; 0 where neither says. machine.c */
double pm__free_memory(void);

/* Where one kind of output goes. */
typedef struct pm__sink {
    bool wanted, is_stdout;
    int held; /* for pm__interrupt_release */
    pm__output output;
} pm__sink;

typedef struct pm__sinks {
    pm__sink json, csv, markdown, screen; /* screen: standard output, or -o FILE */
} pm__sinks;

/* One sink. path: "-" is standard output; NULL opens nothing, and the others then do nothing. A file that is not yet
 * finished is gone when a signal ends the process. EIO, ENOMEM. */
pm_status pm__sink_open(const char *path, pm__sink *sink, pm_error *error);
FILE *pm__sink_file(const pm__sink *sink); /* NULL where not open */
pm_status pm__sink_close(pm__sink *sink, pm_error *error); /* complete, or absent on error */
void pm__sink_discard(pm__sink *sink);

/* Opens all that is asked for, so that a bad path shows before the work. The screen form is wanted if `screen` says so
 * and neither -o - nor a data format claims standard output. On error all are closed. */
pm_status pm__sinks_open(const pm__settings *settings, bool screen, pm__sinks *sinks, pm_error *error);

/* The file to print the screen form to, or NULL. */
FILE *pm__sinks_screen(const pm__sinks *sinks);

/* Writes the data formats and closes everything: files are then complete, or absent on error. EIO, ENOMEM
 * (refused.h). */
pm_status pm__sinks_finish(pm__sinks *sinks, const pm__results *results, pm_error *error);

void pm__sinks_discard(pm__sinks *sinks);

#endif
