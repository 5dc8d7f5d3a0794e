/* The file of a checkpoint: what was asked for, and the series that are done or in hand, in order.
 *
 *     "photonbench-ckpt"         16 bytes
 *     0x04030201, format         u32 each: byte order, and the number of this layout
 *     size                       u64: bytes of the whole file
 *     version, asked             u64 length and as many bytes each: the program's, and the options in effect
 *     count                      u64, then of each series:
 *         done, length, bytes    u64: 0 or 1; u64; what pm__saved holds, nothing where it could not be measured
 *     checksum                   u64: FNV-1a, 64 bit, of all that stands before
 *
 * Numbers and series are as they lie in memory, so a file is read on the kind of machine that wrote it alone. */
#ifndef PM_CONVERGE_CHECKPOINT_H
#define PM_CONVERGE_CHECKPOINT_H

#include "converge.h"

#include <stdio.h>

typedef struct pm__checkpoint_part {
    pm__saved saved; /* bytes NULL: nothing */
    bool done;
    uint64_t offset; /* of its bytes in the file that it was read from */
} pm__checkpoint_part;

/* All owned, from malloc. */
typedef struct pm__checkpoint {
    char *version, *asked;
    pm__checkpoint_part *parts;
    size_t count;
} pm__checkpoint;

/* A regular file, whole and undamaged, or nothing: EIO where it cannot be read, EFORMAT ("FILE, byte N: expected ...")
 * or ENOMEM; *checkpoint is then empty. Memory: at most twice the file's true size, whatever it says. */
pm_status pm__checkpoint_read(const char *path, pm__checkpoint *checkpoint, pm_error *error);

/* Writes are unchecked: the file's owner checks it. */
void pm__checkpoint_write(FILE *file, const pm__checkpoint *checkpoint);

void pm__checkpoint_free(pm__checkpoint *checkpoint);

#endif
