/* Options: one row each, the same meaning in every command that takes them. */
#ifndef PM_CLI_OPTIONS_H
#define PM_CLI_OPTIONS_H

#include "../../cases/case.h"
#include "../base/sampler.h"

#include <stdio.h>

enum { PM__MAX_OPTIONS = 40, PM__MAX_OPERANDS = 1024, PM__MAX_SHAPES = 8, PM__MAX_ALPHAS = 32, PM__MAX_WATCHED = 64 };

/* A list of specs or numbers, as options append to it. */
typedef struct pm__specs {
    pm__spec *items;
    size_t count;
} pm__specs;

typedef struct pm__counts {
    size_t *items;
    size_t count;
} pm__counts;

/* What `render` alone asks. */
typedef struct pm__render_options {
    pm__spec method;            /* entry NULL: not given */
    size_t width, height, spp;
    bool aov, plan, no_skip, half;
    bool eye, at, up, angle;    /* which of the view's members were given */
    pm__view view;
} pm__render_options;

/* What `converge` alone asks. */
typedef struct pm__converge_options {
    pm__specs methods;
    double alphas[PM__MAX_ALPHAS];
    size_t alpha_count;
    size_t passes, photons_per_pass, photons; /* photons: emitted by a run, at most */
    double error;                             /* relative, by which runs end */
    size_t at[PM__MAX_WATCHED][2];            /* pixels x, y */
    size_t at_count;
    const char *checkpoint, *resume;          /* files */
    double checkpoint_seconds;                /* between two */
} pm__converge_options;
/* What `advise` alone asks. */
typedef struct pm__advise_options {
    pm__specs methods;
    double error; /* relative; 0: not given */
    bool verify;
} pm__advise_options;

/* What `storage` alone asks. */
typedef struct pm__storage_options {
    pm__specs policies;
    pm__counts stored;
    bool maps[2];           /* by pm__map_kind; neither: not given */
    size_t paths;           /* eye paths of importance */
    const char *importance; /* NULL: not given; else measure is its pm__measure */
    int measure;
    double share;           /* of importons; 0: not given */
} pm__storage_options;

/* What the options said. Empty lists, NULL and 0 mean: not given, the command's default. */
typedef struct pm__settings {
    uint64_t seed;  /* 1 unless given */
    size_t threads; /* 0: all that the process may use */
    bool quiet, help, full;
    const char *json, *csv, *markdown, *output; /* "-": standard output */
    pm__specs cases, estimators, samplers;
    pm__counts ks, photons;
    size_t trials, probes;
    double radius;         /* m */
    double auto_threshold; /* W/(m2 sr): the radius follows from it */
    const char *search;
    pm__shape lookup;      /* sphere, front only, unless given */
    const char *photon_file, *query_file;
    pm__counts searches;   /* of `search`: numbers of contenders */
    pm__shape shapes[PM__MAX_SHAPES]; /* of `search`: several lookups */
    size_t shape_count;
    bool front_on, front_off;         /* of `search`: either or both */
    bool order_random, order_coherent;
    size_t radius_hits, samples;
    double seconds;
    unsigned quantities;   /* of `speed`: bit q for pm__quantity q */
    unsigned stress_tests, stress_searches; /* of `stress`: a bit each; 0: not given */
    pm__render_options render;
    pm__converge_options converge;
    pm__advise_options advise;
    pm__storage_options storage;
    pm__specs metrics;                /* of `compare`: empty: not given */
    const char *figures;              /* of `report`: a folder */
    char *command_line;               /* as it was typed, fit for a shell; owned */
    const char *operands[PM__MAX_OPERANDS];
    size_t operand_count;
} pm__settings;

typedef struct pm__option {
    const char *name;     /* --name */
    int letter;           /* -letter, or 0 */
    const char *argument; /* as help shows it; NULL: a flag */
    const char *help;
    pm_status (*set)(pm__settings *settings, const char *text, pm_error *error);
} pm__option;

extern const pm__option pm__option_case, pm__option_estimator, pm__option_one_estimator, pm__option_sampler;
extern const pm__option pm__option_k, pm__option_one_k, pm__option_radius, pm__option_photons, pm__option_photon_file;
extern const pm__option pm__option_query_file, pm__option_trials, pm__option_probes, pm__option_search;
extern const pm__option pm__option_lookup, pm__option_front, pm__option_profile, pm__option_seed, pm__option_threads;
extern const pm__option pm__option_json, pm__option_csv, pm__option_markdown, pm__option_output, pm__option_quiet;
extern const pm__option pm__option_help;

struct pm__command;

/* Parses argv[1..]. Options may be abbreviated and repeated: lists grow, else the last one counts. EINVAL or ENAME with
 * a message that names the option; ENOMEM. settings: init first, free always. */
void pm__settings_init(pm__settings *settings);
pm_status pm__options_parse(const struct pm__command *command, int argc, char **argv, pm__settings *settings,
                            pm_error *error);
void pm__settings_free(pm__settings *settings);

/* A word as a shell takes it: plain, or quoted. */
void pm__write_word(FILE *file, const char *word);

/* "sphere", "ellipsoid:3", "disc:0.01". */
void pm__lookup_format(const pm__shape *shape, char text[48]);

#endif
