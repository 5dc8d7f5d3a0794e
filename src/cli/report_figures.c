/* Figures for papers: tables and scripts, and what gnuplot draws by them. */
#include "commands.h"
#include "interrupt.h"
#include "refused.h"
#include "report_files.h"
#include "results.h"

#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { NOT_FOUND = 127, COMMAND = 200 };

/* The child: only what is safe after a fork. */
static void become_gnuplot(const char *folder, const char *settings, const char *script)
{
    const int null = open("/dev/null", O_RDWR);
    if (chdir(folder) != 0 || null < 0 || dup2(null, STDIN_FILENO) < 0 || dup2(null, STDOUT_FILENO) < 0 ||
        dup2(null, STDERR_FILENO) < 0)
        _exit(1);
    (void)execlp("gnuplot", "gnuplot", "-e", settings, script, (char *)NULL);
    _exit(errno == ENOENT ? NOT_FOUND : 1);
}

/* Its exit status; -1: it was ended, or could not be started. */
static int run_gnuplot(const char *folder, const char *settings, const char *script)
{
    int status;
    const pid_t child = fork();
    if (child == 0)
        become_gnuplot(folder, settings, script);
    while (child > 0 && waitpid(child, &status, 0) < 0)
        if (errno != EINTR)
            return -1;
    return child > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/* One figure in one format: drawn under another name, so that it is complete or absent. *there: gnuplot is. */
static pm_status draw(const char *folder, const char *name, const char *format, bool *there, pm_error *error)
{
    char settings[COMMAND], target[80], script[40], *from = NULL, *to = NULL;
    (void)snprintf(target, sizeof target, ".%s.%ld.tmp", name, (long)getpid());
    (void)snprintf(settings, sizeof settings, "format='%s'; target='%s'", format, target);
    (void)snprintf(script, sizeof script, "%s.gp", name);
    from = pm__path_in(folder, target, "");
    (void)snprintf(target, sizeof target, "%s.%s", name, format);
    to = pm__path_in(folder, target, "");
    pm_status status = from && to ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK) {
        const int held = pm__interrupt_hold(from), code = run_gnuplot(folder, settings, script);
        *there = code != NOT_FOUND;
        if (*there && (code != 0 || rename(from, to) != 0))
            status = pm__fail(error, PM_EIO, "%s: gnuplot could not draw it: status %d", target, code);
        (void)unlink(from);
        pm__interrupt_release(held);
    }
    free(from);
    free(to);
    return status;
}

static pm_status finish(pm__sink *sink, bool wanted, pm_error *error)
{
    if (wanted)
        return pm__sink_close(sink, error);
    pm__sink_discard(sink);
    return PM_OK;
}

/* Table and script of one figure. *drawn: it has rows. */
static pm_status write_sources(const pm__report *report, size_t index, const char *folder, bool *drawn,
                               pm_error *error)
{
    const char *const name = pm__report_figure_names[index];
    char data_name[40];
    pm__sink data = {.wanted = false}, script = {.wanted = false};
    char *const data_path = pm__path_in(folder, name, ".csv"), *const script_path = pm__path_in(folder, name, ".gp");
    (void)snprintf(data_name, sizeof data_name, "%s.csv", name);
    pm_status status = data_path && script_path ? PM_OK : pm__fail(error, PM_ENOMEM, "out of memory");
    *drawn = false;
    if (status == PM_OK)
        status = pm__sink_open(data_path, &data, error);
    if (status == PM_OK)
        status = pm__sink_open(script_path, &script, error);
    if (status == PM_OK)
        status = pm__report_write_figure(report, index, data_name, pm__sink_file(&data), pm__sink_file(&script), drawn,
                                         error);
    if (status == PM_OK)
        status = finish(&data, *drawn, error);
    if (status == PM_OK)
        status = finish(&script, *drawn, error);
    pm__sink_discard(&data);
    pm__sink_discard(&script);
    free(data_path);
    free(script_path);
    return status;
}

pm_status pm__report_figures_write(const pm__report *report, const char *folder, bool quiet, pm_error *error)
{
    static const char *const formats[] = {"svg", "pdf"};
    bool there = true, drawn;
    pm_status status = pm__make_folder(folder, error);
    for (size_t i = 0; status == PM_OK && i < PM__REPORT_FIGURES; i++) {
        status = write_sources(report, i, folder, &drawn, error);
        for (size_t f = 0; status == PM_OK && drawn && there && f < 2; f++)
            status = draw(folder, pm__report_figure_names[i], formats[f], &there, error);
    }
    if (status == PM_OK && !there && !quiet)
        pm__complain("report", "gnuplot is not installed (Debian: gnuplot-nox): figures have tables and scripts alone");
    return status;
}
