/* Plans of `render --plan`: on the screen, and as rows. */
#include "render_task.h"
#include "wrap.h"

#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

enum { STEP_COLUMN = 2, STATE_COLUMN = 28, WHY_COLUMN = 37 };

static const char *const fields[] = {"scene", "method", "step", "done", "why"};
enum { FIELD_COUNT = sizeof fields / sizeof *fields };

/* A step and whose it is. */
typedef struct item {
    const pm__spec *scene;
    const pm__step *step;
} item;

typedef struct listing {
    const pm__render_task *task;
    item *items;
    char scene[PM__MAX_SPEC], method[PM__MAX_SPEC];
} listing;

static void fill_row(void *context, size_t index, pm__cell *cells)
{
    listing *const list = context;
    const item *const row = &list->items[index];
    pm__spec_format(row->scene, list->scene, PM__MAX_SPEC);
    pm__spec_format(list->task->config.method, list->method, PM__MAX_SPEC);
    cells[0] = pm__text_cell(list->scene);
    cells[1] = pm__text_cell(list->method);
    cells[2] = pm__text_cell(row->step->name);
    cells[3] = pm__flag_cell(row->step->done);
    cells[4] = pm__text_cell(row->step->why);
}

static void print_plan(FILE *file, const pm__render_task *task, const pm__spec *scene, const pm__plan *plan)
{
    char name[PM__MAX_SPEC], method[PM__MAX_SPEC];
    pm__spec_format(scene, name, sizeof name);
    pm__spec_format(task->config.method, method, sizeof method);
    (void)fprintf(file, "%s, method %s\n", name, method);
    for (size_t i = 0; i < plan->count; i++) {
        const pm__step *const step = &plan->steps[i];
        (void)fprintf(file, "%*s%-*s%-*s", STEP_COLUMN, "", STATE_COLUMN - STEP_COLUMN - 1, step->name,
                      WHY_COLUMN - STATE_COLUMN, step->done ? " done" : " skipped");
        pm__wrap(file, step->why, WHY_COLUMN - 1, WHY_COLUMN);
    }
}

pm_status pm__render_write_plans(const pm__render_task *task, const pm__plan *plans, double wall_s, pm__sinks *sinks,
                                 pm_error *error)
{
    FILE *const screen = pm__sinks_screen(sinks);
    listing list = {.task = task, .items = calloc(task->scene_count * PM__MOST_STEPS, sizeof *list.items)};
    size_t count = 0;
    if (!list.items) {
        pm__sinks_discard(sinks);
        return pm__fail(error, PM_ENOMEM, "out of memory");
    }
    for (size_t i = 0; i < task->scene_count; i++) {
        if (screen)
            print_plan(screen, task, &task->scenes[i], &plans[i]);
        for (size_t j = 0; j < plans[i].count; j++)
            list.items[count++] = (item){&task->scenes[i], &plans[i].steps[j]};
    }
    json_t *const options = pm__render_options_tree(task);
    const pm__results results = {.command = "render",
                                 .options = options,
                                 .settings = task->settings,
                                 .seeded = true,
                                 .wall_s = wall_s,
                                 .fields = fields,
                                 .field_count = FIELD_COUNT,
                                 .plain_count = FIELD_COUNT,
                                 .row_count = count,
                                 .row = fill_row,
                                 .context = &list};
    const pm_status status = pm__sinks_finish(sinks, &results, error);
    json_decref(options);
    free(list.items);
    return status;
}
