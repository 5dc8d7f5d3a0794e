/* What the files of `render` share: what is rendered, the files of it, its rows. */
#ifndef PM_CLI_RENDER_TASK_H
#define PM_CLI_RENDER_TASK_H

#include "../methods/render.h"
#include "results.h"

/* The images of a scene and an estimator, in the order of their files. */
enum { PM__RADIANCE, PM__TRUTHS, PM__ERRORS, PM__BIASES, PM__NOISES, PM__RADII, PM__COUNTS, PM__IMAGE_KINDS };

/* One run: an image of each scene with each estimator. */
typedef struct pm__render_task {
    const pm__settings *settings;
    const pm__spec *scenes, *estimators;
    size_t scene_count, estimator_count; /* 1 where the method makes no estimates */
    bool estimates;                      /* the method makes some */
    const char *search;
    pm__render_config config;            /* but for scene and view */
} pm__render_task;

typedef struct pm__render_row {
    const pm__spec *scene;
    const pm__spec *estimator; /* NULL: the method makes no estimates */
    const char *file;          /* NULL: none was written. Lives as long as the files */
    size_t passes, trials, stored;
    uint64_t emitted;
    const char *truth;         /* "exact", "reference" or NULL */
    bool misfit;               /* the reference is of another size */
    double mean_error, rms_error; /* over the mean truth; NAN where it is not known */
    double trace_s, build_s, image_s, total_s;
    const char *status;        /* "ok" or "interrupted" */
    char detail[160];
} pm__render_row;

/* ---- Files: render_files.c ---- */

typedef struct pm__render_file {
    char *path;
    pm__sink sink;
} pm__render_file;

typedef struct pm__render_files {
    pm__render_file *items; /* [images][kinds] */
    size_t images, kinds;   /* images: estimators within scenes; kinds: 1, or PM__IMAGE_KINDS with --aov */
} pm__render_files;

/* Names all files of the task and opens them, so that a bad path shows before the work. EINVAL: two of the same name,
 * several images for what holds one; EIO, ENOMEM. On error none is open; free by pm__render_files_free in any case. */
pm_status pm__render_files_open(const pm__render_task *task, pm__render_files *files, pm_error *error);

/* Is the image standard output? */
bool pm__render_to_stdout(const pm__settings *settings);

/* Writes image `index` and closes its files; each is then complete, or absent: on error, or because there is no such
 * image. row->file is set. */
pm_status pm__render_files_write(pm__render_files *files, const pm__render_task *task, size_t index,
                                 const pm__render_images *images, pm__render_row *row, pm_error *error);

/* What has not been written stays away. */
void pm__render_files_free(pm__render_files *files);

/* ---- Rows: render_rows.c ---- */

/* One image on the screen. */
void pm__render_print(FILE *file, const pm__render_task *task, const pm__render_row *row);

/* Writes the rows to all sinks and closes them. */
pm_status pm__render_write(const pm__render_task *task, const pm__render_row *rows, size_t count, double wall_s,
                           bool interrupted, pm__sinks *sinks, pm_error *error);

/* ---- Plans: render_plan.c ---- */

/* The same for plans, one of each scene; prints them too. */
pm_status pm__render_write_plans(const pm__render_task *task, const pm__plan *plans, double wall_s, pm__sinks *sinks,
                                 pm_error *error);

/* The options in effect. render_rows.c */
json_t *pm__render_options_tree(const pm__render_task *task);

#endif
