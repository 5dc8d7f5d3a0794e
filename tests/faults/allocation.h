/* Allocations that fail when they are told to. The programs in tests/faults are linked with --wrap (Makefile), so that
 * every allocation of the library, the program and Jansson comes through here, and Embree is asked to report its own.
 *
 *     pm__each_refusal("a map", build, &context);
 *
 * calls build with the first allocation refused, then with the second, and so on until none is left to refuse. Each
 * time the result must be PM_ENOMEM with a sentence, or, where it can be had with less memory, the same as ever; and
 * all that was allocated meanwhile must have been freed.
 *
 * Not refused: what the C library allocates for itself, and OpenEXR, Embree and libpng but where they tell us. */
#ifndef PM_TESTS_FAULTS_ALLOCATION_H
#define PM_TESTS_FAULTS_ALLOCATION_H

#include "../../src/base/status.h"
#include "../test.h"

#include <embree3/rtcore.h>
#include <errno.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

/* Of allocations while `on`: how many there were, which is refused (from 1; 0: none), and all after it if
 * `from_then_on`. live: those not yet freed, by address. */
enum { PM__LIVE_MOST = 1 << 16 };
typedef struct pm__heap {
    pthread_mutex_t lock;
    bool on, from_then_on, hit;
    uint64_t count, refused;
    void *live[PM__LIVE_MOST];
    size_t live_count;
} pm__heap;

static pm__heap pm__the_heap = {.lock = PTHREAD_MUTEX_INITIALIZER};

static size_t pm__live_slot(const void *memory)
{
    size_t slot = (size_t)(((uintptr_t)memory >> 4) * 0x9e3779b97f4a7c15u >> 48) % PM__LIVE_MOST;
    while (pm__the_heap.live[slot] && pm__the_heap.live[slot] != memory)
        slot = (slot + 1) % PM__LIVE_MOST;
    return slot;
}

static void pm__live_add(void *memory)
{
    if (pm__the_heap.live_count + 1 >= PM__LIVE_MOST)
        abort();
    pm__the_heap.live_count++;
    pm__the_heap.live[pm__live_slot(memory)] = memory;
}

/* Those behind it that probed past the slot move up. */
static void pm__live_remove(const void *memory)
{
    size_t slot = pm__live_slot(memory);
    if (!pm__the_heap.live[slot])
        return;
    pm__the_heap.live_count--;
    pm__the_heap.live[slot] = NULL;
    for (slot = (slot + 1) % PM__LIVE_MOST; pm__the_heap.live[slot]; slot = (slot + 1) % PM__LIVE_MOST) {
        void *const moved = pm__the_heap.live[slot];
        pm__the_heap.live[slot] = NULL;
        pm__the_heap.live[pm__live_slot(moved)] = moved;
    }
}

/* Is this one refused? */
static bool pm__refuse(void)
{
    pm__heap *const h = &pm__the_heap;
    (void)pthread_mutex_lock(&h->lock);
    const bool refused = h->on && h->refused &&
                         (++h->count == h->refused || (h->from_then_on && h->count > h->refused));
    h->hit = h->hit || refused;
    (void)pthread_mutex_unlock(&h->lock);
    if (refused)
        errno = ENOMEM;
    return refused;
}

static void *pm__made(void *memory)
{
    pm__heap *const h = &pm__the_heap;
    (void)pthread_mutex_lock(&h->lock);
    if (h->on && memory)
        pm__live_add(memory);
    (void)pthread_mutex_unlock(&h->lock);
    return memory;
}

static void pm__gone(const void *memory)
{
    (void)pthread_mutex_lock(&pm__the_heap.lock);
    if (memory)
        pm__live_remove(memory);
    (void)pthread_mutex_unlock(&pm__the_heap.lock);
}

/* ---- What the linker puts in place ------------------------------------------------------------- */

void *__real_malloc(size_t size);
void *__real_calloc(size_t count, size_t size);
void *__real_realloc(void *memory, size_t size);
void *__real_aligned_alloc(size_t alignment, size_t size);
void __real_free(void *memory);
char *__real_strdup(const char *text);
char *__real_strndup(const char *text, size_t size);
FILE *__real_fopen(const char *path, const char *mode);
FILE *__real_fdopen(int fd, const char *mode);
FILE *__real_open_memstream(char **text, size_t *size);
RTCDevice __real_rtcNewDevice(const char *config);

void *__wrap_malloc(size_t size);
void *__wrap_calloc(size_t count, size_t size);
void *__wrap_realloc(void *memory, size_t size);
void *__wrap_aligned_alloc(size_t alignment, size_t size);
void __wrap_free(void *memory);
char *__wrap_strdup(const char *text);
char *__wrap_strndup(const char *text, size_t size);
int __wrap_asprintf(char **text, const char *format, ...);
FILE *__wrap_fopen(const char *path, const char *mode);
FILE *__wrap_fdopen(int fd, const char *mode);
FILE *__wrap_open_memstream(char **text, size_t *size);
RTCDevice __wrap_rtcNewDevice(const char *config);

void *__wrap_malloc(size_t size)
{
    return pm__refuse() ? NULL : pm__made(__real_malloc(size));
}

void *__wrap_calloc(size_t count, size_t size)
{
    return pm__refuse() ? NULL : pm__made(__real_calloc(count, size));
}

void *__wrap_aligned_alloc(size_t alignment, size_t size)
{
    return pm__refuse() ? NULL : pm__made(__real_aligned_alloc(alignment, size));
}

/* What is refused stays where and as it was. */
void *__wrap_realloc(void *memory, size_t size)
{
    if (pm__refuse())
        return NULL;
    pm__gone(memory);
    return pm__made(__real_realloc(memory, size));
}

void __wrap_free(void *memory)
{
    pm__gone(memory);
    __real_free(memory);
}

char *__wrap_strdup(const char *text)
{
    return pm__refuse() ? NULL : pm__made(__real_strdup(text));
}

char *__wrap_strndup(const char *text, size_t size)
{
    return pm__refuse() ? NULL : pm__made(__real_strndup(text, size));
}

int __wrap_asprintf(char **text, const char *format, ...)
{
    va_list arguments;
    if (pm__refuse())
        return -1;
    va_start(arguments, format);
    const int length = vasprintf(text, format, arguments);
    va_end(arguments);
    if (length >= 0)
        (void)pm__made(*text);
    return length;
}

FILE *__wrap_fopen(const char *path, const char *mode)
{
    return pm__refuse() ? NULL : __real_fopen(path, mode);
}

FILE *__wrap_fdopen(int fd, const char *mode)
{
    return pm__refuse() ? NULL : __real_fdopen(fd, mode);
}

FILE *__wrap_open_memstream(char **text, size_t *size)
{
    return pm__refuse() ? NULL : __real_open_memstream(text, size);
}

/* Embree asks before it allocates (bytes > 0) for structures; what it frees it only tells. */
static bool pm__embree_asks(void *context, ssize_t bytes, bool after)
{
    (void)context;
    return after || bytes <= 0 || !pm__refuse();
}

RTCDevice __wrap_rtcNewDevice(const char *config)
{
    const RTCDevice device = pm__refuse() ? NULL : __real_rtcNewDevice(config);
    if (device)
        rtcSetDeviceMemoryMonitorFunction(device, pm__embree_asks, NULL);
    return device;
}

/* ---- Trying ------------------------------------------------------------------------------------ */

/* From here on the nth allocation is refused (0: none), and so are all after it where asked. */
static inline void pm__refuse_from(uint64_t n, bool from_then_on)
{
    pm__heap *const h = &pm__the_heap;
    memset(h->live, 0, sizeof h->live);
    h->live_count = 0;
    h->count = 0;
    h->refused = n;
    h->from_then_on = from_then_on;
    h->hit = false;
    h->on = true;
}

/* Ends it: was any refused? */
static inline bool pm__refuse_none(void)
{
    pm__the_heap.on = false;
    return pm__the_heap.hit;
}

/* In place of ck_assert in what is tried: Check allocates too. */
#define PM_MUST(condition)                                \
    do {                                                  \
        if (!(condition)) {                               \
            (void)pm__refuse_none();                      \
            ck_abort_msg("does not hold: %s", #condition); \
        }                                                 \
    } while (0)

/* What is tried: leaves nothing behind, and in *digest what stands for its result (pm__digest). */
typedef pm_status (*pm__try)(void *context, uint64_t *digest, pm_error *error);

/* FNV-1a, 64 bit, of what was digested before and these bytes. */
static inline void pm__digest(uint64_t *digest, const void *bytes, size_t size)
{
    const unsigned char *const from = bytes;
    for (size_t i = 0; i < size; i++)
        *digest = (*digest ^ from[i]) * 1099511628211u;
}

/* Each of the first pm__all_below allocations, then steps of a pm__each_part-th of n; with PM_FULL=1 in the environment
 * all, or, for what allocates so often that all would take hours, pm__full_below and pm__full_part likewise. Returns
 * how many there were. */
static uint64_t pm__all_below = 250, pm__each_part = 80;
static uint64_t pm__full_below = UINT64_MAX, pm__full_part = 1;
static inline uint64_t pm__refuse_each(const char *name, pm__try attempt, void *context, bool from_then_on)
{
    uint64_t want = 0;
    pm_error error = {""};
    ck_assert_msg(attempt(context, &want, &error) == PM_OK, "%s: %s", name, error.text);
    const bool full = getenv("PM_FULL") != NULL;
    const uint64_t below = full ? pm__full_below : pm__all_below, part = full ? pm__full_part : pm__each_part;
    for (uint64_t n = 1;; n += n < below ? 1 : 1 + n / part) {
        uint64_t got = 0;
        *error.text = '\0';
        pm__refuse_from(n, from_then_on);
        const pm_status status = attempt(context, &got, &error);
        const bool hit = pm__refuse_none();
        ck_assert_msg(pm__the_heap.live_count == 0, "%s: %zu allocations are left when the one numbered %ju fails",
                      name, pm__the_heap.live_count, (uintmax_t)n);
        ck_assert_msg(status == PM_OK || (hit && status == PM_ENOMEM), "%s: allocation %ju fails: status %d, '%s'",
                      name, (uintmax_t)n, (int)status, error.text);
        ck_assert_msg(status == PM_OK || *error.text, "%s: allocation %ju fails: no sentence", name, (uintmax_t)n);
        ck_assert_msg(status != PM_OK || got == want, "%s: allocation %ju fails: another result", name, (uintmax_t)n);
        if (!hit)
            return pm__the_heap.count;
    }
}

/* One allocation alone, and that and all after it. */
static inline void pm__each_refusal(const char *name, pm__try attempt, void *context)
{
    const clock_t start = clock();
    const uint64_t count = pm__refuse_each(name, attempt, context, false);
    ck_assert_msg(count > 0, "%s: nothing was allocated", name);
    (void)pm__refuse_each(name, attempt, context, true);
    if (getenv("PM_COUNTS"))
        (void)fprintf(stderr, "%s: %ju allocations, %.2f s\n", name, (uintmax_t)count,
                      (double)(clock() - start) / CLOCKS_PER_SEC);
}

#endif
