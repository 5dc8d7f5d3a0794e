/* What `compare` does: two result files of one command, row by row. */
#ifndef PM_CLI_COMPARE_H
#define PM_CLI_COMPARE_H

#include "../base/quote.h"
#include "../base/status.h"
#include "../stats/stats.h"

#include <jansson.h>

/* A file of results, and what its rows are about. */
typedef struct pm__result_file {
    char name[PM__NAME_SIZE];
    json_t *root;
    const char *command; /* into root */
    json_t *rows;        /* into root */
    size_t count;
    char **labels;       /* [count]: printable; rows of two files match where these are equal */
} pm__result_file;

/* Reads and checks. EIO: cannot be read; EFORMAT: not photonbench/1, or a row that is not as it should be (the error
 * names file, place and what was expected); EINVAL: a file that is well formed but cannot be compared; ENOMEM. *file:
 * free always. */
pm_status pm__result_file_load(const char *path, pm__result_file *file, pm_error *error);
void pm__result_file_free(pm__result_file *file);

/* Fields of row `index`. A field that is absent or null gives *there = false. EFORMAT. */
pm_status pm__result_number(const pm__result_file *file, size_t index, const char *field, double *value, bool *there,
                            pm_error *error);
pm_status pm__result_interval(const pm__result_file *file, size_t index, const char *field, pm__interval *value,
                              bool *there, pm_error *error);

/* The logarithms of an array of numbers above 0; *values is the caller's (free), NULL where there are none. */
pm_status pm__result_logs(const pm__result_file *file, size_t index, const char *field, double **values, size_t *count,
                          pm_error *error);

typedef enum pm__verdict {
    PM__IMPROVED,
    PM__REGRESSED,
    PM__SAME,
    PM__ONLY_A,
    PM__ONLY_B,
    PM__VERDICT_COUNT
} pm__verdict;

/* One quantity of one pair of rows, or a row that is there only once. NAN: does not exist. */
typedef struct pm__comparison {
    const char *label;    /* the row's, into the file */
    const char *quantity; /* NULL: the row as a whole */
    size_t row_a, row_b;
    bool tested;          /* by statistics: counts in the family */
    bool factor;          /* change is b / a; else a difference */
    double a, b, change;
    pm__interval change_ci95; /* family-wise */
    double p, p_family;   /* as tested, and times the number of tests */
    size_t samples_a, samples_b;
    pm__verdict verdict;
} pm__comparison;

typedef struct pm__comparisons {
    pm__comparison *items;
    size_t count, capacity;
    size_t tests;         /* the family */
    size_t verdicts[PM__VERDICT_COUNT];
} pm__comparisons;

/* EFORMAT names file and row; ENOMEM. list: zero before, free items always. Both files are of the same command. */
pm_status pm__compare(const pm__result_file *a, const pm__result_file *b, pm__comparisons *list, pm_error *error);

const char *pm__verdict_text(pm__verdict verdict);

/* A ratio that changed by less than this part is the same: two runs of one program differ by about that much, from
 * where the system happened to put their memory, which the samples within a run cannot show. */
#define PM__RATIO_TOLERANCE 0.01

#endif
