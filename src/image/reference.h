/* Stored references: images of scenes without an exact answer, made by the path tracer, kept within the program. */
#ifndef PM_IMAGE_REFERENCE_H
#define PM_IMAGE_REFERENCE_H

#include "image.h"

typedef struct pm__reference {
    pm__image radiance; /* W/(m2 sr) */
    pm__image error;    /* its own: the standard error of each pixel and band */
} pm__reference;

/* Is there one of that scene (its defaults, by its name without "scene:")? */
bool pm__reference_exists(const char *scene);
/* ENAME: there is none. ENOMEM. Free by pm__reference_free. */
pm_status pm__reference_load(const char *scene, pm__reference *reference, pm_error *error);
void pm__reference_free(pm__reference *reference);

#endif
