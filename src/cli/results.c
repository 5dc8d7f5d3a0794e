/* Sinks: standard output or files that are complete or absent. */
#include "results.h"
#include "interrupt.h"
#include "refused.h"

#include "../base/status.h"

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

/* What is there and no regular file is written in place. To open it may take as long as a pipe has no reader. */
static bool is_in_place(const char *path)
{
    struct stat status;
    return stat(path, &status) == 0 && !S_ISREG(status.st_mode);
}

pm_status pm__sink_open(const char *path, pm__sink *sink, pm_error *error)
{
    sink->wanted = path != NULL;
    sink->is_stdout = path && strcmp(path, "-") == 0;
    sink->held = -1;
    if (!path || sink->is_stdout)
        return PM_OK;
    if (is_in_place(path))
        return pm__output_open(path, &sink->output, error);
    pm__interrupt_block();
    const pm_status status = pm__output_open(path, &sink->output, error);
    if (status == PM_OK)
        sink->held = pm__interrupt_hold(sink->output.temporary);
    pm__interrupt_unblock();
    return status;
}

FILE *pm__sink_file(const pm__sink *sink)
{
    if (!sink->wanted)
        return NULL;
    return sink->is_stdout ? stdout : sink->output.file;
}

pm_status pm__sinks_open(const pm__settings *settings, bool screen, pm__sinks *sinks, pm_error *error)
{
    memset(sinks, 0, sizeof *sinks);
    pm_status status = pm__sink_open(settings->json, &sinks->json, error);
    if (status == PM_OK)
        status = pm__sink_open(settings->csv, &sinks->csv, error);
    if (status == PM_OK)
        status = pm__sink_open(settings->markdown, &sinks->markdown, error);
    const bool claimed = sinks->json.is_stdout || sinks->csv.is_stdout || sinks->markdown.is_stdout;
    const char *const to = settings->output ? settings->output : screen && !claimed ? "-" : NULL;
    if (status == PM_OK)
        status = pm__sink_open(to, &sinks->screen, error);
    if (status != PM_OK)
        pm__sinks_discard(sinks);
    return status;
}

FILE *pm__sinks_screen(const pm__sinks *sinks)
{
    return pm__sink_file(&sinks->screen);
}

pm_status pm__sink_close(pm__sink *sink, pm_error *error)
{
    if (!sink->wanted)
        return PM_OK;
    sink->wanted = false;
    if (!sink->is_stdout) {
        const pm_status status = pm__output_commit(&sink->output, error);
        pm__interrupt_release(sink->held);
        return status;
    }
    if (fflush(stdout) != 0 || ferror(stdout))
        return pm__fail(error, PM_EIO, "standard output: %s", strerror(errno));
    return PM_OK;
}

void pm__sink_discard(pm__sink *sink)
{
    if (sink->wanted && !sink->is_stdout) {
        pm__output_discard(&sink->output);
        pm__interrupt_release(sink->held);
    }
    sink->wanted = false;
}

static pm_status finish_sink(pm__sink *sink, void (*write)(FILE *file, const pm__results *results),
                             const pm__results *results, pm_error *error)
{
    if (sink->wanted) {
        write(pm__sink_file(sink), results);
        const pm_status status = pm__refused_status(error);
        if (status != PM_OK)
            return status; /* the caller discards it */
    }
    return pm__sink_close(sink, error);
}

pm_status pm__sinks_finish(pm__sinks *sinks, const pm__results *results, pm_error *error)
{
    pm_status status = pm__refused_status(error);
    if (status == PM_OK)
        status = finish_sink(&sinks->json, pm__write_json, results, error);
    if (status == PM_OK)
        status = finish_sink(&sinks->csv, pm__write_csv, results, error);
    if (status == PM_OK)
        status = finish_sink(&sinks->markdown, pm__write_markdown, results, error);
    if (status == PM_OK)
        status = pm__sink_close(&sinks->screen, error);
    if (status != PM_OK)
        pm__sinks_discard(sinks);
    return status;
}

void pm__sinks_discard(pm__sinks *sinks)
{
    pm__sink_discard(&sinks->json);
    pm__sink_discard(&sinks->csv);
    pm__sink_discard(&sinks->markdown);
    pm__sink_discard(&sinks->screen);
}
