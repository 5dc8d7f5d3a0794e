/* What `report` does: result files and images, put into one page that needs nothing but itself. */
#ifndef PM_REPORT_REPORT_H
#define PM_REPORT_REPORT_H

#include "../base/quote.h"
#include "../base/status.h"

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum {
    PM__REPORT_SIDE = 256,          /* pixels: larger images are reduced */
    PM__REPORT_PAGE_BYTES = 8000000 /* images are within the page as long as it stays below */
};

/* A result file, as it was read, but for rows that were left out. */
typedef struct pm__report_result {
    char name[PM__NAME_SIZE]; /* without its folders */
    char *text;               /* [size] */
    size_t size;
    json_t *root;             /* the same, parsed */
    const char *command;      /* into root */
    json_t *rows;             /* into root */
    size_t left_out;          /* rows that it had besides */
} pm__report_result;

/* An image, reduced and packed again. Texts are UTF-8. */
typedef struct pm__report_image {
    char name[PM__NAME_SIZE]; /* scene and estimator */
    char file[PM__NAME_SIZE]; /* the file's name without its folders, of A-Za-z0-9=._-: one image each */
    char scene[PM__NAME_SIZE], label[PM__NAME_SIZE];
    const char *kind;         /* image, truth, error, bias, noise, radius, count or other */
    size_t width, height;
    int channels;
    unsigned char *exr;       /* [exr_size]: OpenEXR of 16-bit floats */
    size_t exr_size;
    json_t *attributes;       /* of its header: an object of texts */
    bool beside;              /* in a file of its own, not in the page */
} pm__report_image;

typedef struct pm__report {
    pm__report_result *results;
    size_t result_count, result_capacity;
    pm__report_image *images;
    size_t image_count, image_capacity;
    const char *version; /* of the program */
    char date[32];       /* 2026-11-24T02:30:00Z */
} pm__report;

/* Reads a result file or an image, which its first bytes tell apart. Of several truths of a scene that are the same
 * the first is kept. EIO; EFORMAT (file, place and what was expected); EINVAL: two images of one name; ENOMEM. report:
 * zero before the first, free always. */
pm_status pm__report_add(pm__report *report, const char *path, pm_error *error);
void pm__report_free(pm__report *report);

/* The whole of a file in memory; *bytes is the caller's (free). Files that begin neither as JSON nor as OpenEXR, or are
 * endless, are refused before they are read through. */
pm_status pm__report_read_file(const char *path, char **bytes, size_t *size, bool *is_image, pm_error *error);

/* Checks and keeps what was read; takes `bytes` over, also on error. */
pm_status pm__report_add_result(pm__report *report, const char *path, char *bytes, size_t size, pm_error *error);
pm_status pm__report_add_image(pm__report *report, const char *path, char *bytes, size_t size, pm_error *error);

/* Of a long file of `stress` keeps all rows that fail, and of those that pass the one of each test and estimator that
 * came nearest to its bound. ENOMEM. */
pm_status pm__report_condense(pm__report_result *result, pm_error *error);

/* What an image shows, by its attributes and by its file's name: fills in name, scene, label and kind. */
void pm__report_describe(pm__report_image *image, const char *stem);

/* The value of a row's field, such as "estimator", with the parameters alone that are not the defaults; as it is where
 * the program does not know it. */
void pm__report_shorten(const char *field, const char *text, char shorter[PM__NAME_SIZE]);

/* The report's date: now, or that of SOURCE_DATE_EPOCH (its text; NULL: not set). EINVAL. */
pm_status pm__report_set_date(pm__report *report, const char *epoch, pm_error *error);

/* Decides which images stand beside the page. After the last is added. */
void pm__report_place(pm__report *report);

/* The page, or one made from another template: writes are unchecked, the file's owner checks them, and whether memory
 * was refused to Jansson. EBROKEN: the template has not exactly one line <!--PM-DATA-->. */
pm_status pm__report_write_page(const pm__report *report, FILE *file, pm_error *error);
pm_status pm__report_write_template(const pm__report *report, const char *template, size_t size, FILE *file,
                                    pm_error *error);

/* The script by which the page takes an image that stands beside it; as above. */
void pm__report_write_script(const pm__report_image *image, FILE *file);

/* The parts of a whole report that this one has not: an array of {part, what, how}. The caller's. */
json_t *pm__report_missing(const pm__report *report);

/* Figures for papers, one row each: a table of points and a gnuplot script. */
enum { PM__REPORT_FIGURES = 5 };
extern const char *const pm__report_figure_names[PM__REPORT_FIGURES];

/* Writes figure `index`: its points to `data`, which the script reads as `data_name`. *drawn: false where no row
 * belongs to it; then nothing is written. ENOMEM. */
pm_status pm__report_write_figure(const pm__report *report, size_t index, const char *data_name, FILE *data,
                                  FILE *script, bool *drawn, pm_error *error);

/* Writes text where JSON in a page may stand: < becomes \u003c, so that nothing ends the script. */
void pm__report_write_escaped(FILE *file, const char *text, size_t size);

/* Text from anywhere as JSON: what is not UTF-8 has ? for each byte that is not printable ASCII. */
json_t *pm__report_text(const char *text, size_t size);

#endif
