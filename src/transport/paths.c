/* Light-path expressions, by the automaton of Glushkov (1961): its states are the letters of the expression (and one
 * for the start), so a set of states is a word of bits, and which letter can follow which is found while parsing. Exact
 * about what can still match, which a matcher for whole strings cannot tell. The part of POSIX's extended syntax that
 * means something for paths is taken: L S D . [..] ( ) | * + ? {n} {n,} {n,m}. */
#include "paths.h"

#include "../base/memory.h"
#include "../base/status.h"

#include <stdlib.h>
#include <string.h>

enum { LETTERS = 3, PLACES = 64, NESTING = 32, ALL_LETTERS = (1 << LETTERS) - 1 };

struct pm__paths {
    pm__places at[LETTERS];    /* the places that each letter can stand at */
    pm__places follow[PLACES]; /* where the next letter can be; [0]: before the first */
    pm__places last;           /* where a match can end */
    pm__places alive;          /* from where a path can be stored, now or later: see find_alive */
    pm__places lit;            /* where the first letter behind L can be */
    pm__places reached;        /* and any later one, of a photon's path */
};

/* A part of the expression, parsed. */
typedef struct part {
    pm__places first, last;
    bool empty; /* may match nothing */
} part;

typedef struct parser {
    pm__paths *paths;
    const char *text;
    size_t next;
    int count; /* places so far */
    int depth;
    pm_status status;
    pm_error *error;
} parser;

static part refuse(parser *p, size_t where, const char *why)
{
    if (!p->status)
        p->status = pm__fail(p->error, PM_EINVAL, "light paths: character %zu of '%.60s': %s", where + 1, p->text, why);
    return (part){0, 0, true};
}

static int letter_index(char c)
{
    return c == 'L' ? 0 : c == 'S' ? 1 : c == 'D' ? 2 : -1;
}

static pm__places following(const pm__paths *paths, pm__places places)
{
    pm__places next = 0;
    for (int i = 0; i < PLACES && places >> i; i++)
        if (places >> i & 1)
            next |= paths->follow[i];
    return next;
}

static void join(parser *p, pm__places last, pm__places first)
{
    for (int i = 0; i < p->count; i++)
        if (last >> i & 1)
            p->paths->follow[i] |= first;
}

static part concatenate(parser *p, part a, part b)
{
    join(p, a.last, b.first);
    return (part){a.first | (a.empty ? b.first : 0), b.last | (b.empty ? a.last : 0), a.empty && b.empty};
}

static part place(parser *p, int letters)
{
    if (p->count == PLACES)
        return refuse(p, p->next - 1, "more than 63 letters, repeats written out");
    const pm__places bit = (pm__places)1 << p->count++;
    for (int i = 0; i < LETTERS; i++)
        if (letters >> i & 1)
            p->paths->at[i] |= bit;
    return (part){bit, bit, false};
}

static part parse_set(parser *p)
{
    const size_t open = p->next - 1;
    int letters = 0;
    const bool other = p->text[p->next] == '^';
    p->next += other;
    for (char c; (c = p->text[p->next]) != ']'; p->next++) {
        const int index = letter_index(c);
        if (index < 0)
            return refuse(p, c ? p->next : open, c ? "within [ ] only L, S and D stand" : "a [ without its ]");
        letters |= 1 << index;
    }
    p->next++;
    letters = other ? ALL_LETTERS & ~letters : letters;
    return letters ? place(p, letters) : refuse(p, open, "no letter is left to stand here");
}

static part parse_choice(parser *p);

static part parse_group(parser *p)
{
    const size_t open = p->next - 1;
    if (++p->depth > NESTING)
        return refuse(p, open, "parentheses nested more than 32 deep");
    const part inner = parse_choice(p);
    if (!p->status && p->text[p->next] != ')')
        return refuse(p, open, "a ( without its )");
    p->next++;
    p->depth--;
    return inner;
}

static part parse_atom(parser *p)
{
    const char c = p->text[p->next];
    const int index = letter_index(c);
    if (index < 0 && c != '.' && c != '[' && c != '(')
        return refuse(p, p->next, "L, S, D, ., [ or ( must stand here");
    p->next++;
    return c == '(' ? parse_group(p) : c == '[' ? parse_set(p) : place(p, c == '.' ? ALL_LETTERS : 1 << index);
}

static int parse_number(parser *p)
{
    int number = -1;
    for (char c; (c = p->text[p->next]) >= '0' && c <= '9' && number < PLACES; p->next++)
        number = 10 * (number < 0 ? 0 : number) + (c - '0');
    return number;
}

enum { UNBOUNDED = -1 };

/* What stands behind an atom, if anything. false: refused. */
static bool parse_repeat(parser *p, int *least, int *most)
{
    const size_t where = p->next;
    const char c = p->text[where];
    *least = c == '*' || c == '?' ? 0 : 1;
    *most = c == '*' || c == '+' ? UNBOUNDED : 1;
    p->next += c == '*' || c == '?' || c == '+';
    if (c == '{') {
        p->next++;
        *most = *least = parse_number(p);
        if (p->text[p->next] == ',') {
            p->next++;
            *most = parse_number(p);
        }
        if (*least < 0 || *most == 0 || (*most != UNBOUNDED && *most < *least) || p->text[p->next++] != '}')
            return refuse(p, where, "a repeat is {n}, {n,} or {n,m} with m >= n, m > 0"), false;
    }
    if (p->next > where && p->text[p->next] && strchr("*+?{", p->text[p->next]))
        return refuse(p, p->next, "a repeat of a repeat: put the inner one in parentheses"), false;
    return true;
}

static part parse_again(parser *p, size_t start)
{
    p->next = start;
    return parse_atom(p);
}

/* An atom and its repeat. Counted repeats write the atom out: it is parsed once for each. */
static part parse_piece(parser *p)
{
    const size_t start = p->next;
    int least, most;
    part one = parse_atom(p);
    if (p->status || !parse_repeat(p, &least, &most))
        return one;
    const size_t end = p->next;
    const int copies = most == UNBOUNDED ? (least > 1 ? least : 1) : most;
    part whole = {0, 0, true};
    for (int i = 1; !p->status; i++) {
        if (i == copies && most == UNBOUNDED)
            join(p, one.last, one.first);
        one.empty = one.empty || i > least;
        whole = concatenate(p, whole, one);
        if (i == copies)
            break;
        one = parse_again(p, start);
    }
    p->next = end;
    return whole;
}

static part parse_sequence(parser *p)
{
    part whole = {0, 0, true};
    do
        whole = concatenate(p, whole, parse_piece(p));
    while (!p->status && p->text[p->next] && p->text[p->next] != '|' && p->text[p->next] != ')');
    return whole;
}

static part parse_choice(parser *p)
{
    part whole = parse_sequence(p);
    while (!p->status && p->text[p->next] == '|') {
        p->next++;
        const part other = parse_sequence(p);
        whole = (part){whole.first | other.first, whole.last | other.last, whole.empty || other.empty};
    }
    return whole;
}

/* Behind its first letter a photon's path has only S and D, and it is stored at a D: the places from where such a path
 * can end well, found backwards. */
static void find_alive(pm__paths *paths)
{
    const pm__places surfaces = paths->at[1] | paths->at[2];
    pm__places alive = paths->last & paths->at[2], before;
    do {
        before = alive;
        for (int i = 1; i < PLACES; i++)
            if (surfaces >> i & 1 && paths->follow[i] & alive)
                alive |= (pm__places)1 << i;
    } while (alive != before);
    paths->alive = alive;
}

/* The same forwards, from the light. */
static void find_reached(pm__paths *paths)
{
    const pm__places surfaces = paths->at[1] | paths->at[2];
    pm__places before;
    paths->lit = following(paths, paths->follow[0] & paths->at[0]) & surfaces;
    paths->reached = paths->lit;
    do {
        before = paths->reached;
        paths->reached |= following(paths, before) & surfaces;
    } while (paths->reached != before);
}

pm_status pm__paths_create(const char *expression, pm__paths **paths, pm_error *error)
{
    *paths = NULL;
    if (!expression)
        return pm__fail(error, PM_EINVAL, "light paths: no expression");
    pm__paths *const made = pm__alloc_zero(1, sizeof *made);
    if (!made)
        return pm__fail(error, PM_ENOMEM, "no memory for light paths");
    parser p = {.paths = made, .text = expression, .count = 1, .error = error};
    const part whole = parse_choice(&p);
    if (!p.status && expression[p.next])
        refuse(&p, p.next, "a ) without its (");
    made->follow[0] = whole.first;
    made->last = whole.last | (whole.empty ? 1 : 0);
    find_alive(made);
    find_reached(made);
    if (!p.status && pm__paths_dead(made, pm__paths_step(made, pm__paths_begin(), 'L')))
        p.status = pm__fail(error, PM_EINVAL, "light paths: no photon's path matches '%.60s': they begin with L, go on "
                            "with S and D, and are stored at a D", expression);
    if (p.status)
        free(made);
    else
        *paths = made;
    return p.status;
}

void pm__paths_destroy(pm__paths *paths)
{
    free(paths);
}

pm__places pm__paths_begin(void)
{
    return 1;
}

pm__places pm__paths_step(const pm__paths *paths, pm__places places, char letter)
{
    const int index = letter_index(letter);
    return index < 0 ? 0 : following(paths, places) & paths->at[index];
}

bool pm__paths_accept(const pm__paths *paths, pm__places places)
{
    return places & paths->last;
}

bool pm__paths_dead(const pm__paths *paths, pm__places places)
{
    if (places & 1) /* before the first letter, which is L */
        places = paths->follow[0] & paths->at[0];
    return !(following(paths, places) & paths->alive);
}

pm__places pm__paths_from_end(const pm__paths *paths)
{
    return paths->last & paths->at[2];
}

static pm__places preceding(const pm__paths *paths, pm__places places)
{
    pm__places previous = 0;
    for (int i = 0; i < PLACES; i++)
        if (paths->follow[i] & places)
            previous |= (pm__places)1 << i;
    return previous;
}

pm__places pm__paths_step_back(const pm__paths *paths, pm__places places, char letter)
{
    const int index = letter_index(letter);
    return index < 0 ? 0 : preceding(paths, places) & paths->at[index];
}

bool pm__paths_whole(const pm__paths *paths, pm__places places)
{
    return places & paths->lit;
}

bool pm__paths_grow(const pm__paths *paths, pm__places places)
{
    return preceding(paths, places) & paths->reached;
}

static pm__places walk(const pm__paths *paths, const char *path)
{
    pm__places places = pm__paths_begin();
    for (; *path && places; path++)
        places = pm__paths_step(paths, places, *path);
    return places;
}

bool pm__paths_match(const pm__paths *paths, const char *path)
{
    return pm__paths_accept(paths, walk(paths, path));
}

bool pm__paths_end(const pm__paths *paths, const char *path)
{
    return pm__paths_dead(paths, walk(paths, path));
}
