/* What the files of `storage` share: its scenes, their rows, the screen, image files. */
#ifndef PM_CLI_STORAGE_TASK_H
#define PM_CLI_STORAGE_TASK_H

#include "../storage/storage.h"
#include "results.h"

/* One scene, and what was found. */
typedef struct pm__storage_scene {
    const pm__spec *scene;
    const char *status; /* "ok", "interrupted", "unsupported"; NULL: not begun */
    char detail[PM__STORAGE_DETAIL];
    pm__storage_result result;
} pm__storage_scene;

typedef struct pm__storage_task {
    const pm__settings *settings;
    pm__storage_scene *scenes;
    size_t count;
    pm__storage_wish wish; /* but for the scene */
} pm__storage_task;

/* The screen table, 100 columns. storage_table.c */
void pm__storage_print(FILE *file, const pm__storage_task *task);

/* Writes rows and fronts to all sinks and closes them. storage_rows.c */
pm_status pm__storage_write(const pm__storage_task *task, double wall_s, bool interrupted, pm__sinks *sinks,
                            pm_error *error);

/* storage_files.c: is there a place for images? Before the work; EIO names the file. */
pm_status pm__storage_files_check(const pm__storage_task *task, pm_error *error);
/* Writes those of a scene: each is then complete, or absent. EIO, ENOMEM. */
pm_status pm__storage_files_write(const pm__storage_task *task, const pm__storage_scene *scene, pm_error *error);

#endif
