#include "progress.h"

#include "../base/clock.h"

#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

enum { BAR = 30, NARROWEST = 60 };

static bool is_dumb(void)
{
    const char *const term = getenv("TERM");
    return !term || !*term || strcmp(term, "dumb") == 0;
}

bool pm__colourful(FILE *file)
{
    const char *const no_colour = getenv("NO_COLOR");
    return isatty(fileno(file)) && !is_dumb() && !(no_colour && *no_colour);
}

static int terminal_width(void)
{
    struct winsize size;
    return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col ? size.ws_col : 80;
}

void pm__progress_start(pm__progress *progress, bool quiet)
{
    progress->shown = !quiet && isatty(STDERR_FILENO) && !is_dumb();
    progress->start = pm__seconds();
    progress->last = progress->before = 0.0;
    progress->width = progress->shown ? terminal_width() : 0;
}

/* "12 s left", "3 min left"; nothing while it is too early to tell. */
static void time_left(double elapsed, double before, double fraction, char *text, size_t size)
{
    const double done = fraction - before, left = done > 0.0 ? elapsed * (1.0 - fraction) / done : 0.0;
    if (elapsed < 1.0 || done < 0.01 * (1.0 - before))
        *text = '\0';
    else if (left < 100.0)
        (void)snprintf(text, size, "%.0f s left", left);
    else
        (void)snprintf(text, size, "%.0f min left", left / 60.0);
}

void pm__progress_resume(pm__progress *progress, double fraction)
{
    progress->start = pm__seconds();
    progress->before = fraction;
}

void pm__progress_update(pm__progress *progress, double fraction, const char *what)
{
    const double now = progress->shown ? pm__seconds() : 0.0;
    if (!progress->shown || now - progress->last < 0.1)
        return;
    progress->last = now;
    const double clamped = fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction;
    char left[32], bar[BAR + 1], line[256];
    time_left(now - progress->start, progress->before, clamped, left, sizeof left);
    const size_t full = (size_t)(clamped * BAR);
    memset(bar, '.', BAR);
    memset(bar, '#', full);
    bar[BAR] = '\0';
    if (progress->width < NARROWEST)
        (void)snprintf(line, sizeof line, "%3.0f %%  %s", 100.0 * clamped, left);
    else
        (void)snprintf(line, sizeof line, "[%s] %3.0f %%  %-12s %s", bar, 100.0 * clamped, left, what);
    (void)fprintf(stderr, "\r%.*s\033[K", progress->width - 1, line);
    (void)fflush(stderr);
}

void pm__progress_end(pm__progress *progress)
{
    if (progress->shown && progress->last > 0.0)
        (void)fputs("\r\033[K", stderr);
    progress->shown = false;
}
