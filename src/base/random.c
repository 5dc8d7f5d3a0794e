#include "random.h"

#include <Random123/philox.h>

void pm__random_words(uint64_t seed, pm__purpose purpose, uint32_t trial, uint64_t number, uint32_t block,
                      uint32_t words[4])
{
    /* 40 bits of number, the purpose above them, trial and block in words of their own: no two uses collide. */
    const philox4x32_ctr_t counter = {{(uint32_t)number, (uint32_t)(number >> 32 & 0xff) | (uint32_t)purpose << 8,
                                       trial, block}};
    const philox4x32_key_t key = {{(uint32_t)seed, (uint32_t)(seed >> 32)}};
    const philox4x32_ctr_t out = philox4x32(counter, key);
    for (int i = 0; i < 4; i++)
        words[i] = out.v[i];
}

void pm__random_uniform(uint64_t seed, pm__purpose purpose, uint32_t trial, uint64_t number, double *u, int count)
{
    for (int i = 0; i < count; i += 2) {
        uint32_t w[4];
        pm__random_words(seed, purpose, trial, number, (uint32_t)i / 2, w);
        u[i] = (double)(((uint64_t)w[0] << 32 | w[1]) >> 11) * 0x1p-53;
        if (i + 1 < count)
            u[i + 1] = (double)(((uint64_t)w[2] << 32 | w[3]) >> 11) * 0x1p-53;
    }
}

void pm__random_triple(uint64_t seed, pm__purpose purpose, uint32_t trial, uint64_t number, uint32_t block, double u[3])
{
    uint32_t w[4];
    pm__random_words(seed, purpose, trial, number, block, w);
    for (int i = 0; i < 3; i++) /* by way of int64_t: one instruction where an unsigned number takes several */
        u[i] = (double)(int64_t)((uint64_t)w[i] << 10 | (w[3] >> 10 * i & 0x3ff)) * 0x1p-42;
}
