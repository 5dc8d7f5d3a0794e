/* A series to bytes and back. The same function walks the fields both ways, so that they cannot differ. */
#include "measuring.h"

#include "../base/clock.h"
#include "../base/memory.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What fields are copied to (bytes NULL: they are counted) or from. */
typedef struct tape {
    unsigned char *bytes;
    size_t at, count;
    bool reading, short_of; /* short_of: fields go on where the bytes end */
} tape;

static void pass_bytes(tape *t, void *field, size_t size)
{
    if (t->reading && size > t->count - t->at) {
        t->short_of = true;
        t->at = t->count;
        return;
    }
    if (t->reading && size)
        memcpy(field, t->bytes + t->at, size);
    else if (t->bytes && size)
        memcpy(t->bytes + t->at, field, size);
    t->at += size;
}

/* A number that must be what it was: which series it is. */
static bool pass_same(tape *t, uint64_t value)
{
    uint64_t saved = value;
    pass_bytes(t, &saved, sizeof saved);
    return saved == value;
}

static bool pass_identity(tape *t, const pm__measuring *m)
{
    uint64_t wanted; /* what is estimated depends on it, and where the first run ends */
    memcpy(&wanted, &m->config->error, sizeof wanted);
    const pm__progressive *const method = (const pm__progressive *)(const void *)m->config->progressive.method->entry;
    return pass_same(t, m->progression.points) && pass_same(t, m->yardstick.values) && pass_same(t, method->fields) &&
           pass_same(t, m->room) && pass_same(t, m->config->trials) && pass_same(t, m->config->watched_count) &&
           pass_same(t, m->config->progressive.seed) && pass_same(t, m->config->progressive.photons) &&
           pass_same(t, wanted);
}

static void pass_count(tape *t, size_t *count)
{
    uint64_t wide = *count;
    pass_bytes(t, &wide, sizeof wide);
    *count = (size_t)wide;
}

/* What the first run said of itself. */
static void pass_row(tape *t, pm__converge_row *row)
{
    if (t->reading) /* the rest is not of the run: as it is before it is worked out */
        *row = (pm__converge_row){
            .predicted_rel_bias = NAN, .predicted_rms_bias = NAN, .predicted_rel_noise = NAN};
    pass_bytes(t, &row->pass, sizeof row->pass);
    pass_bytes(t, &row->photons, sizeof row->photons);
    pass_bytes(t, &row->seconds, sizeof row->seconds);
}

/* The counts by which all the rest is sized: they are looked at before that is touched. */
static bool pass_counts(tape *t, pm__measuring *m, double *gone, unsigned char *running)
{
    unsigned char reached = m->series->reached;
    pass_bytes(t, gone, sizeof *gone);
    pass_count(t, &m->records);
    pass_count(t, &m->series->trials);
    pass_count(t, &m->record);
    pass_bytes(t, running, sizeof *running);
    pass_bytes(t, &reached, sizeof reached);
    m->series->reached = reached == 1;
    return !t->short_of && reached <= 1 && m->records >= 1 && m->records <= m->room &&
           m->series->trials <= m->config->trials && m->record <= m->records && *running <= 1 &&
           (!*running || m->series->trials < m->config->trials) && (*running || m->record == 0) && isfinite(*gone) &&
           *gone >= 0.0;
}

/* Passes that are read after, as set_records makes them: ascending, and none beyond what was planned. */
static bool are_passes(const pm__measuring *m, uint32_t planned)
{
    bool ascending = m->passes[0] >= 1 && m->passes[m->records - 1] <= planned;
    for (size_t r = 1; r < m->records; r++)
        ascending = ascending && m->passes[r] > m->passes[r - 1];
    return ascending;
}

static size_t state_count(const pm__measuring *m)
{
    return pm__run_state_count(&m->progression);
}

static void pass_run(tape *t, pm__run *run, double *state, size_t count)
{
    pass_bytes(t, &run->passes, sizeof run->passes);
    pass_bytes(t, &run->emitted, sizeof run->emitted);
    pass_bytes(t, &run->stored, sizeof run->stored);
    pass_bytes(t, state, count * sizeof *state);
}

static void pass_errors(tape *t, pm__measuring *m)
{
    const size_t values = 3 * m->yardstick.values;
    for (size_t trial = 0; trial <= m->series->trials && trial < m->config->trials; trial++) {
        const size_t done = trial < m->series->trials ? m->records : m->record;
        pass_bytes(t, m->errors + trial * m->room * values, done * values * sizeof *m->errors);
        if (m->estimated) {
            pass_bytes(t, m->estimated + trial * m->room, done * sizeof *m->estimated);
            pass_bytes(t, m->right + trial * m->room, done * sizeof *m->right);
        }
    }
}

static void pass_readings(tape *t, pm__measuring *m)
{
    const size_t done = m->series->trials ? m->records : m->record;
    pass_bytes(t, m->passes, m->records * sizeof *m->passes);
    for (size_t r = 0; r < done; r++)
        pass_row(t, &m->series->rows[r]);
    pass_bytes(t, m->series->watched, done * m->config->watched_count * sizeof *m->series->watched);
    pass_errors(t, m);
}

static void write_all(tape *t, pm__measuring *m)
{
    double gone = pm__seconds() - m->start;
    unsigned char running = m->run.of != NULL;
    (void)pass_identity(t, m);
    (void)pass_counts(t, m, &gone, &running);
    pass_readings(t, m);
    if (running)
        pass_run(t, &m->run, m->run.state, state_count(m));
}

pm_status pm__measuring_save(const pm__measuring *m, pm__saved *saved, pm_error *error)
{
    pm__measuring copy = *m; /* fields are walked by pointers that could write; none is written */
    tape counting = {.bytes = NULL};
    write_all(&counting, &copy);
    *saved = (pm__saved){pm__alloc(counting.at, 1), counting.at};
    if (!saved->bytes)
        return pm__fail(error, PM_ENOMEM, "out of memory for a checkpoint of %zu bytes", counting.at);
    tape writing = {.bytes = saved->bytes, .count = saved->count};
    write_all(&writing, &copy);
    return PM_OK;
}

static pm_status damaged(pm_error *error)
{
    return pm__fail(error, PM_EFORMAT, "what was saved of the series is damaged");
}

/* Is the run behind the reading before, and not beyond the next one? */
static bool is_between(const pm__measuring *m)
{
    const uint32_t passes = m->run.passes, next = m->record < m->records ? m->passes[m->record] : passes;
    return passes <= next && (m->record == 0 || passes >= m->passes[m->record - 1]);
}

static pm_status restore_run(tape *t, pm__measuring *m, pm_error *error)
{
    pm_status status = pm__run_begin(&m->progression, (uint32_t)m->series->trials, &m->run, error);
    double *const state = pm__alloc(state_count(m), sizeof *state);
    if (status == PM_OK && !state)
        status = pm__fail(error, PM_ENOMEM, "out of memory for %zu points", m->progression.points);
    if (status == PM_OK) {
        pass_run(t, &m->run, state, state_count(m));
        status = t->short_of || !is_between(m) ? damaged(error)
                                               : pm__run_resume(&m->run, state, m->run.passes, error);
    }
    free(state);
    return status;
}

pm_status pm__measuring_restore(pm__measuring *m, const pm__saved *saved, pm_error *error)
{
    tape t = {.bytes = saved->bytes, .count = saved->count, .reading = true};
    double gone = 0.0;
    unsigned char running = 0;
    const uint32_t planned = m->passes[m->room - 1];
    if (!pass_identity(&t, m))
        return pm__fail(error, PM_EFORMAT, "what was saved is of another series");
    if (!pass_counts(&t, m, &gone, &running))
        return damaged(error);
    pass_readings(&t, m);
    if (t.short_of || !are_passes(m, planned))
        return damaged(error);
    m->start = pm__seconds() - gone;
    const pm_status status = running ? restore_run(&t, m, error) : PM_OK;
    return status == PM_OK && t.at != t.count ? damaged(error) : status;
}
