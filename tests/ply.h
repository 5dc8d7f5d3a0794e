/* PLY files for tests: pieces of headers, and binary files put together byte by byte. */
#ifndef PM_TESTS_PLY_H
#define PM_TESTS_PLY_H

#include "files.h"
#include "test.h"

#include <stdint.h>

#define POSITION "property float x\nproperty float y\nproperty float z\n"
#define DIRECTION "property float dx\nproperty float dy\nproperty float dz\n"
#define POWER "property float r\nproperty float g\nproperty float b\n"
#define NORMAL "property float nx\nproperty float ny\nproperty float nz\n"
#define ALL POSITION DIRECTION POWER
#define ASCII "ply\nformat ascii 1.0\n"
#define BINARY "ply\nformat binary_little_endian 1.0\n"
#define ONE ASCII "element vertex 1\n" ALL "end_header\n"

static pm__test_directory directory;
static char path[PM__TEST_PATH];
static unsigned char built[4096]; /* what the put functions have put */
static size_t built_size;

/* Leaves the file's name in `path` too. */
static inline const char *save(const void *content, size_t count)
{
    if (!directory.path[0])
        directory = pm__test_directory_create();
    pm__test_write(pm__test_path(&directory, "p.ply", path), content, count);
    return path;
}

static inline void cleanup(void)
{
    pm__test_directory_remove(&directory);
}

static inline void put(const void *from, size_t count)
{
    ck_assert_uint_le(built_size + count, sizeof built);
    memcpy(built + built_size, from, count);
    built_size += count;
}

static inline void put_text(const char *text)
{
    built_size = 0;
    put(text, strlen(text));
}

static inline void put_integer(int64_t value, int size)
{
    unsigned char little[8];
    for (int i = 0; i < size; i++)
        little[i] = (unsigned char)((uint64_t)value >> (8 * i));
    put(little, (size_t)size);
}

static inline void put_float(float value)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_integer(bits, 4);
}

static inline void put_double(double value)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    put_integer((int64_t)bits, 8);
}

static inline void put_floats(int count, const double *values)
{
    for (int i = 0; i < count; i++)
        put_float((float)values[i]);
}

/* One photon: x y z dx dy dz r g b. */
static const double sample[9] = {1.5, -2.0, 300.0, 0.6, 0.0, -0.8, 0.5, 0.25, 2.0};

#endif
