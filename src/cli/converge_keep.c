#include "converge_keep.h"

#include "commands.h"
#include "interrupt.h"
#include "version.h"
#include "refused.h"

#include "../base/clock.h"
#include "../search/wide.h"

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* Files that are complete need not be written more often, s. */
static const double moment = 1.0;

/* ---- What is asked for ------------------------------------------------------------------------- */

/* All that rows depend on: the order of sums is that of the search and the processor's width too. */
static json_t *asked_of(const pm__converge_task *task)
{
    json_t *const asked = pm__converge_options_of(task);
    pm_simd simd;
    const bool known = pm__choose_simd(PM_SIMD_AUTO, &simd, NULL) == PM_OK;
    (void)json_object_del(asked, "threads");
    (void)json_object_del(asked, "profile"); /* only a name for defaults */
    (void)json_object_set_new(asked, "seed", json_integer((json_int_t)task->settings->seed));
    (void)json_object_set_new(asked, "simd", known ? json_string(pm__simd_name(simd)) : json_null());
    return asked;
}

static char *text_of(const json_t *value)
{
    return json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(17));
}

/* For people: with no more digits than its numbers need. */
static char *short_text_of(const json_t *value)
{
    if (!value)
        return strdup("nothing");
    for (size_t digits = 15; digits < 17; digits++) {
        char *const text = json_dumps(value, JSON_COMPACT | JSON_ENCODE_ANY | JSON_REAL_PRECISION(digits));
        json_t *const back = text ? json_loads(text, JSON_DECODE_ANY, NULL) : NULL;
        const bool same = back && json_equal(back, value);
        json_decref(back);
        if (same)
            return text;
        free(text);
    }
    return text_of(value);
}

/* "photons_per_pass" as the user knows it. */
static void name_option(const char *key, char name[PM__QUOTE_SIZE])
{
    const bool operand = strcmp(key, "scene") == 0, width = strcmp(key, "simd") == 0;
    (void)snprintf(name, PM__QUOTE_SIZE, "%s%s", operand || width ? "" : "--", width ? "PHOTONBENCH_SIMD" : key);
    for (char *c = name; *c && !width; c++)
        *c = *c == '_' ? '-' : *c;
}

static pm_status refuse_other(const char *file, const char *key, const json_t *was, const json_t *is, pm_error *error)
{
    char name[PM__QUOTE_SIZE];
    char *const then = short_text_of(was), *const now = short_text_of(is);
    name_option(key, name);
    const pm_status status =
        pm__fail(error, PM_EINVAL, "%s: a checkpoint of other options: %s was %.100s and is %.100s now", file, name,
                 then ? then : "?", now ? now : "?");
    free(then);
    free(now);
    return status;
}

/* was: as the file has it. */
static pm_status compare_options(const char *file, const json_t *was, json_t *is, pm_error *error)
{
    const char *key;
    json_t *value;
    json_object_foreach(is, key, value) {
        const json_t *const before = json_object_get(was, key);
        if (!before || !json_equal(before, value))
            return refuse_other(file, key, before, value, error);
    }
    return pm__fail(error, PM_EINVAL, "%s: a checkpoint of other options", file);
}

/* Is it of this program, and of the same series? */
static pm_status check_same(const pm__keep *keep, const pm__checkpoint *found, json_t *asked, pm_error *error)
{
    char file[PM__NAME_SIZE], version[PM__QUOTE_SIZE];
    pm__quote_path(keep->settings->converge.resume, file);
    if (strcmp(found->version, PM_VERSION) != 0) {
        pm__quote(found->version, strlen(found->version), version);
        return pm__fail(error, PM_EINVAL, "%s: a checkpoint of photonbench %s, this is " PM_VERSION, file, version);
    }
    if (strcmp(found->asked, keep->checkpoint.asked) == 0)
        return PM_OK;
    json_t *const was = json_loads(found->asked, 0, NULL);
    const pm_status status =
        json_is_object(was) ? compare_options(file, was, asked, error)
                            : pm__fail(error, PM_EFORMAT, "%s: expected the options in effect", file);
    json_decref(was);
    return pm__refused_status(NULL) == PM_OK ? status : pm__refused_status(error);
}

/* ---- The file ---------------------------------------------------------------------------------- */

/* On the disk before it takes the place of the one before: a machine that stops has either. What cannot be synced is
 * no file on a disk. */
static pm_status sync_file(FILE *file, const char *path, pm_error *error)
{
    char name[PM__NAME_SIZE];
    if (fflush(file) == 0 && (fsync(fileno(file)) == 0 || errno == EINVAL || errno == EROFS))
        return PM_OK;
    pm__quote_path(path, name);
    return pm__fail(error, PM_EIO, "%s: cannot be written: %s", name, strerror(errno));
}

/* commit: false only sees whether it could be. */
static pm_status write_file(pm__keep *keep, bool commit, pm_error *error)
{
    pm__sink sink;
    pm_status status = pm__sink_open(keep->path, &sink, error);
    if (status != PM_OK)
        return status;
    pm__checkpoint_write(pm__sink_file(&sink), &keep->checkpoint);
    status = sync_file(pm__sink_file(&sink), keep->path, error);
    if (status == PM_OK && commit)
        return pm__sink_close(&sink, error);
    pm__sink_discard(&sink);
    return status;
}

/* What is read again, and replaced as a whole, is no device or pipe; opening the latter could wait for ever. */
static pm_status check_regular(const char *path, pm_error *error)
{
    struct stat about;
    char name[PM__NAME_SIZE];
    if (stat(path, &about) != 0 || S_ISREG(about.st_mode) || S_ISDIR(about.st_mode))
        return PM_OK; /* whatever else is wrong is seen when it is opened */
    pm__quote_path(path, name);
    return pm__fail(error, PM_EIO, "%s: cannot be written: a checkpoint is a regular file", name);
}

/* So that a path or disk that will not do shows before the work; what is there stays until there is something to
 * save. */
static pm_status try_path(pm__keep *keep, pm_error *error)
{
    const pm_status status = check_regular(keep->path, error);
    return status == PM_OK ? write_file(keep, false, error) : status;
}

/* ---- Opening ----------------------------------------------------------------------------------- */

/* Its parts become ours. */
static pm_status resume(pm__keep *keep, size_t series, json_t *asked, pm_error *error)
{
    pm__checkpoint found;
    char file[PM__NAME_SIZE];
    pm__quote_path(keep->settings->converge.resume, file);
    pm_status status = pm__checkpoint_read(keep->settings->converge.resume, &found, error);
    if (status == PM_OK)
        status = check_same(keep, &found, asked, error);
    if (status == PM_OK && found.count > series)
        status = pm__fail(error, PM_EFORMAT, "%s: expected at most %zu series, found %zu", file, series, found.count);
    keep->unreadable = status != PM_OK && status != PM_EINVAL;
    if (status == PM_OK) {
        memcpy(keep->checkpoint.parts, found.parts, found.count * sizeof *found.parts);
        keep->checkpoint.count = found.count;
        found.count = 0;
    }
    pm__checkpoint_free(&found);
    return status;
}

pm_status pm__keep_open(const pm__converge_task *task, pm__keep *keep, pm_error *error)
{
    const pm__settings *const s = task->settings;
    *keep = (pm__keep){.settings = s, .path = s->converge.checkpoint ? s->converge.checkpoint : s->converge.resume};
    if (!keep->path)
        return PM_OK;
    json_t *const asked = asked_of(task);
    keep->checkpoint.version = strdup(PM_VERSION);
    keep->checkpoint.asked = text_of(asked);
    keep->checkpoint.parts = calloc(task->count + 1, sizeof *keep->checkpoint.parts);
    pm_status status = keep->checkpoint.version && keep->checkpoint.asked && keep->checkpoint.parts
                           ? PM_OK
                           : pm__fail(error, PM_ENOMEM, "out of memory");
    if (status == PM_OK) /* options that lack some would be others, now or when it is read again */
        status = pm__refused_status(error);
    if (status == PM_OK && s->converge.resume)
        status = resume(keep, task->count, asked, error);
    if (status == PM_OK)
        status = try_path(keep, error);
    json_decref(asked);
    keep->stale = !s->converge.resume || strcmp(keep->path, s->converge.resume) != 0;
    keep->written = pm__seconds();
    return status;
}

void pm__keep_close(pm__keep *keep)
{
    pm__checkpoint_free(&keep->checkpoint);
}

/* ---- Saving ------------------------------------------------------------------------------------ */

const pm__saved *pm__keep_from(const pm__keep *keep, size_t item)
{
    const pm__checkpoint *const c = &keep->checkpoint;
    return item < c->count && c->parts[item].saved.count ? &c->parts[item].saved : NULL;
}

pm_status pm__keep_refuse(pm__keep *keep, size_t item, pm_error *error)
{
    const pm_error reason = *error;
    char name[PM__NAME_SIZE];
    pm__quote_path(keep->settings->converge.resume, name);
    keep->unreadable = true;
    return pm__fail(error, PM_EFORMAT, "%s, byte %" PRIu64 ": expected the state of series %zu: %.120s", name,
                    keep->checkpoint.parts[item].offset, item + 1, reason.text);
}

pm_status pm__keep_flush(pm__keep *keep, pm_error *error)
{
    if (!keep->path || !keep->stale)
        return PM_OK;
    const pm_status status = write_file(keep, true, error);
    keep->stale = status != PM_OK;
    keep->written = pm__seconds();
    return status;
}

static void grow_to(pm__checkpoint *c, size_t count)
{
    if (c->count < count)
        c->count = count;
}

pm_status pm__keep_take(pm__keep *keep, size_t item, const pm__saved *saved, pm_error *error)
{
    const double interval = keep->settings->converge.checkpoint_seconds;
    unsigned char *const bytes = malloc(saved->count + 1);
    if (!bytes)
        return pm__fail(error, PM_ENOMEM, "out of memory for a checkpoint of %zu bytes", saved->count);
    memcpy(bytes, saved->bytes, saved->count);
    pm__checkpoint_part *const part = &keep->checkpoint.parts[item];
    free(part->saved.bytes);
    part->saved = (pm__saved){bytes, saved->count};
    grow_to(&keep->checkpoint, item + 1);
    keep->stale = true;
    const bool soon = pm__seconds() - keep->written < (interval > 0.0 ? fmin(interval, moment) : moment);
    return soon && !pm__interrupted() ? PM_OK : pm__keep_flush(keep, error);
}

void pm__keep_done(pm__keep *keep, size_t item)
{
    if (!keep->path || (item < keep->checkpoint.count && keep->checkpoint.parts[item].done))
        return;
    keep->checkpoint.parts[item].done = keep->stale = true;
    grow_to(&keep->checkpoint, item + 1);
}

/* ---- Messages ---------------------------------------------------------------------------------- */

void pm__keep_greet(const pm__keep *keep, size_t series)
{
    const pm__checkpoint *const c = &keep->checkpoint;
    size_t done = 0, begun = 0;
    if (!keep->settings->converge.resume || keep->settings->quiet)
        return;
    for (size_t i = 0; i < c->count; i++) {
        done += c->parts[i].done;
        begun += !c->parts[i].done && c->parts[i].saved.count;
    }
    char name[PM__NAME_SIZE];
    pm__quote_path(keep->settings->converge.resume, name);
    pm__complain("converge", "resumed from %s: of %zu series %zu %s done%s", name, series, done,
                 done == 1 ? "was" : "were", begun ? ", one was in hand" : "");
}

/* What was typed, and --resume unless it says so already: of two the last one counts. */
void pm__keep_part(const pm__keep *keep)
{
    const char *const resumed = keep->settings->converge.resume;
    if (!keep->path || keep->settings->quiet)
        return;
    (void)fprintf(stderr, "photonbench converge: the state is saved; to go on: %s", keep->settings->command_line);
    if (!resumed || strcmp(resumed, keep->path) != 0) {
        (void)fputs(" --resume ", stderr);
        pm__write_word(stderr, keep->path);
    }
    (void)fputc('\n', stderr);
}
