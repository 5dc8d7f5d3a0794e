/* Any bytes as a checkpoint, as they are and with size and checksum made right, so that what lies behind is reached. */
#include "../../src/converge/checkpoint.h"
#include "fuzz.h"

static void read_file(const uint8_t *data, size_t size)
{
    char name[40];
    int file;
    unsigned sum = 0;
    pm__checkpoint found;
    pm_error error = {""};
    const pm_status status = pm__checkpoint_read(as_file(data, size, &file, name), &found, &error);
    FUZZ_CHECK(status == PM_OK || status == PM_EFORMAT || status == PM_ENOMEM || status == PM_EIO, error.text);
    FUZZ_CHECK(status == PM_OK || (*error.text && !found.parts && !found.count), "parts after an error");
    for (size_t i = 0; i < found.count; i++) /* all can be touched */
        for (size_t b = 0; b < found.parts[i].saved.count; b++)
            sum += found.parts[i].saved.bytes[b];
    FUZZ_CHECK(sum <= size * 255, "more bytes than there are");
    pm__checkpoint_free(&found);
    (void)close(file);
}

static void make_plausible(uint8_t *data, size_t size)
{
    const uint64_t whole = size;
    uint64_t sum = 14695981039346656037u;
    memcpy(data + 24, &whole, 8);
    for (size_t i = 0; i < size - 8; i++)
        sum = (sum ^ data[i]) * 1099511628211u;
    memcpy(data + size - 8, &sum, 8);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    read_file(data, size);
    if (size < 64)
        return 0;
    uint8_t *const copy = malloc(size);
    FUZZ_CHECK(copy != NULL, "out of memory");
    memcpy(copy, data, size);
    make_plausible(copy, size);
    read_file(copy, size);
    free(copy);
    return 0;
}
