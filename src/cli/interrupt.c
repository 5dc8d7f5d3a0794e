#include "interrupt.h"

#include "commands.h"

#include <limits.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <string.h>
#include <unistd.h>

enum { MOST_HELD = PM__MOST_HELD };

static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
enum { SIGNALS = sizeof signals / sizeof *signals };

static atomic_bool interrupted;

/* Copies, so that the handler reads nothing that its owner may be freeing. */
static char held[MOST_HELD][PATH_MAX];
static atomic_bool is_held[MOST_HELD];

/* Only what is safe in a handler, on whatever thread: unlink and _exit. A name that has been renamed away meanwhile
 * is just not there. */
static void end(int number)
{
    (void)number;
    for (size_t i = 0; i < MOST_HELD; i++)
        if (atomic_load_explicit(&is_held[i], memory_order_acquire))
            (void)unlink(held[i]);
    _exit(PM__EXIT_INTERRUPTED);
}

static void note(int number)
{
    if (atomic_exchange(&interrupted, true))
        end(number);
}

static void handle(void (*handler)(int number))
{
    for (size_t i = 0; i < SIGNALS; i++) {
        struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART}, before;
        (void)sigemptyset(&action.sa_mask);
        if (sigaction(signals[i], NULL, &before) == 0 && before.sa_handler != SIG_IGN)
            (void)sigaction(signals[i], &action, NULL);
    }
}

void pm__interrupt_obey(void)
{
    handle(end);
    /* What these say, the write that they come from says too; by default they would end the program with files half
     * written. */
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
}

void pm__interrupt_watch(void)
{
    handle(note);
}

bool pm__interrupted(void)
{
    return atomic_load(&interrupted);
}

int pm__interrupt_hold(const char *path)
{
    if (!path || strlen(path) >= PATH_MAX)
        return -1;
    for (int i = 0; i < MOST_HELD; i++)
        if (!atomic_load(&is_held[i])) {
            memcpy(held[i], path, strlen(path) + 1);
            atomic_store_explicit(&is_held[i], true, memory_order_release);
            return i;
        }
    return -1;
}

void pm__interrupt_release(int number)
{
    if (number >= 0)
        atomic_store(&is_held[number], false);
}

static void mask(int how)
{
    sigset_t set;
    (void)sigemptyset(&set);
    for (size_t i = 0; i < SIGNALS; i++)
        (void)sigaddset(&set, signals[i]);
    (void)pthread_sigmask(how, &set, NULL);
}

void pm__interrupt_block(void)
{
    mask(SIG_BLOCK);
}

void pm__interrupt_unblock(void)
{
    mask(SIG_UNBLOCK);
}
