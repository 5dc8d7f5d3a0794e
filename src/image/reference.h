/* Stored references: images of scenes without an exact answer, made by the path tracer, kept within the program. */
#ifndef PM_IMAGE_REFERENCE_H
#define PM_IMAGE_REFERENCE_H

#include "image.h"

typedef struct pm__reference {
    pm__image radiance; /* W/(m2 sr), R G B */
    pm__image error;    /* its own: the standard error of each pixel and band, over the mean radiance of the image */
} pm__reference;

/* A stored pair of files; `scene` as the program has it, or with _ for -. */
typedef struct pm__reference_row {
    const char *scene; /* NULL: the end of a table */
    const unsigned char *radiance, *radiance_end, *error, *error_end;
} pm__reference_row;

/* Every row of references.h. */
extern const pm__reference_row pm__references[];

/* Is there one of that scene (its defaults, by its name without "scene:")? */
bool pm__reference_exists(const char *scene);
/* ENAME: there is none. ENOMEM. *reference is whole or empty; free by pm__reference_free. */
pm_status pm__reference_load(const char *scene, pm__reference *reference, pm_error *error);

/* The same from another table. EFORMAT: a file is none or has not R G B, or the two do not fit together. */
pm_status pm__reference_load_from(const pm__reference_row *table, const char *scene, pm__reference *reference,
                                  pm_error *error);

void pm__reference_free(pm__reference *reference);

#endif
