/* Damaged PLY files: whatever the damage, a status comes back soon, an error names the file, and what is read is
 * finite. Deterministic: the same files at each run. */
#include "../../src/photonmap.h"

#include "../ply.h"
#include "damage.h"

#include <time.h>

enum { FILES = 12000, SEEDS = 4, TEST = 7 }; /* TEST: of the dice */

#define BEFORE "element camera 2\nproperty double fov\nproperty list uchar short ids\n"
#define AFTER "element face 1\nproperty list uchar int vertex_indices\n"

static sample_file valid_file(int kind)
{
    sample_file f;
    put_text(kind == 0 ? ASCII "comment a\nelement vertex 3\n" ALL NORMAL "end_header\n"
             : kind == 1 ? ASCII BEFORE "element vertex 3\n" ALL NORMAL AFTER "end_header\n60 2 1 2\n61.5 0\n"
             : kind == 2 ? BINARY "element vertex 3\n" ALL NORMAL "end_header\n"
                         : BINARY BEFORE "element vertex 3\n" ALL NORMAL AFTER "end_header\n");
    if (kind == 3)
        for (int i = 0; i < 2; i++) {
            put_double(60.0);
            put_integer(i, 1);
            put_integer(i, 2 * i);
        }
    for (int i = 0; i < 3; i++)
        if (kind < 2)
            put("0.25 -1e3 7 0.6 0 -0.8 1 2 3 0 0 2.5\n", sizeof "0.25 -1e3 7 0.6 0 -0.8 1 2 3 0 0 2.5\n" - 1);
        else {
            put_floats(9, sample);
            put_floats(3, sample);
        }
    memcpy(f.content, built, built_size);
    f.size = built_size;
    return f;
}

/* Puts an ugly word in place of a word or a number. */
static void replace_word(sample_file *f, size_t at, dice *d)
{
    static const char *const words[] = {"1e999", "-1", "nan", "-inf", "18446744073709551615", "18446744073709551616",
                                        "1073741823", "4294967295", "1e18", "0x1p5", "", "vertex", "property", "list",
                                        "element", "end_header\n", "x", "double", "uchar", "\n", "\r", "comment",
                                        "binary_little_endian", "ascii", "1e-400", "0.00000000000000000000000000001"};
    replace_run(f, at, ' ' + 1, words, sizeof words / sizeof *words, d);
}

static void damage(sample_file *f, dice *d)
{
    const size_t at = roll(d, f->size), kind = roll(d, DAMAGES + 2);
    if (kind < DAMAGES)
        damage_bytes(f, at, kind, d);
    else
        replace_word(f, at, d);
}

static void check_error(pm_status status, const pm_error *error, size_t count)
{
    ck_assert_msg(status == PM_EFORMAT || status == PM_ENONFINITE, "%s: %s", pm_status_text(status), error->text);
    ck_assert_msg(strstr(error->text, path) && strlen(error->text) > strlen(path) + 10, "%s", error->text);
    for (const char *c = error->text; *c; c++)
        ck_assert_msg(*c >= ' ' && *c <= '~', "%s", error->text);
    ck_assert_uint_eq(count, 0);
}

static void check_floats(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++)
        ck_assert(isfinite(values[i]));
}

/* Whether the file was read. */
static bool try_photons(void)
{
    pm_photon *photons;
    float(*normals)[3];
    size_t count;
    pm_error error = {""};
    const pm_status status = pm_ply_read_photons(path, &photons, &normals, &count, &error);
    if (status != PM_OK) {
        check_error(status, &error, count);
        ck_assert(!photons && !normals);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        check_floats(photons[i].position, 3);
        check_floats(photons[i].power, 3);
        PM_CHECK_NEAR((double)hypotf(hypotf(photons[i].direction[0], photons[i].direction[1]), photons[i].direction[2]),
                      1.0, 1e-6);
        if (normals)
            PM_CHECK_NEAR((double)hypotf(hypotf(normals[i][0], normals[i][1]), normals[i][2]), 1.0, 1e-6);
    }
    pm_free(photons);
    pm_free(normals);
    return true;
}

static bool try_points(void)
{
    pm_surface_point *points;
    size_t count;
    pm_error error = {""};
    const pm_status status = pm_ply_read_points(path, &points, &count, &error);
    if (status != PM_OK) {
        check_error(status, &error, count);
        ck_assert_ptr_null(points);
        return false;
    }
    for (size_t i = 0; i < count; i++) {
        check_floats(points[i].position, 3);
        check_floats(points[i].normal, 3);
    }
    pm_free(points);
    return true;
}

START_TEST(damaged_files)
{
    limit_memory();
    size_t read = 0, refused = 0;
    for (uint64_t i = 0; i < FILES; i++) {
        dice d = {i, TEST, 0};
        sample_file f = valid_file((int)(i % SEEDS));
        for (size_t n = i < SEEDS ? 0 : 1 + roll(&d, 4); n > 0; n--)
            damage(&f, &d);
        (void)save(f.content, f.size);
        const clock_t start = clock();
        const bool got = try_photons();
        if (i < SEEDS)
            ck_assert(got);
        *(got ? &read : &refused) += 1;
        (void)try_points();
        ck_assert_msg(clock() - start < 2 * CLOCKS_PER_SEC, "file %d took too long", (int)i);
    }
    cleanup();
    /* The damage is neither always harmless nor always fatal. */
    ck_assert_uint_ge(read, FILES / 50);
    ck_assert_uint_ge(refused, FILES / 4);
}
END_TEST

/* Noise from the first byte on, and behind a good header. */
START_TEST(noise)
{
    limit_memory();
    for (uint64_t i = 0; i < 2000; i++) {
        dice d = {FILES + i, TEST, 0};
        static const char *const starts[] = {"", "ply\n", ASCII, BINARY "element vertex 5\n" ALL NORMAL "end_header\n",
                                             ASCII "element vertex 5\n" ALL NORMAL "end_header\n"};
        put_text(starts[i % 5]);
        for (size_t n = roll(&d, 600); n > 0; n--)
            put_integer((int64_t)(roll(&d, 4) ? roll(&d, 256) : (size_t)"0123456789.e- \n"[roll(&d, 15)]), 1);
        (void)save(built, built_size);
        (void)try_photons();
        (void)try_points();
    }
    cleanup();
}
END_TEST

PM_TEST_MAIN("fuzz_ply", damaged_files, noise)
