/* The plan: what a scene, a method and its estimators need, derived before work starts; all else is skipped. */
#ifndef PM_METHODS_PLAN_H
#define PM_METHODS_PLAN_H

#include <stdbool.h>
#include <stddef.h>

enum { PM__MOST_STEPS = 12 };

typedef struct pm__step {
    const char *name; /* "caustic pass" */
    bool done;
    char why[160];    /* half a sentence: "no specular surface" */
} pm__step;

typedef struct pm__plan {
    pm__step steps[PM__MOST_STEPS];
    size_t count;
} pm__plan;

#endif
