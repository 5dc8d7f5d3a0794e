#include "stock.h"

#include "../base/memory.h"

#include <stdlib.h>

pm_status pm__stock_reserve(pm__stock *stock, size_t more)
{
    size_t rooms[3] = {stock->capacity, stock->capacity, stock->capacity};
    const size_t wanted = stock->count + more;
    if (pm__grow((void **)&stock->photons, &rooms[0], wanted, sizeof *stock->photons) ||
        pm__grow((void **)&stock->normals, &rooms[1], wanted, sizeof *stock->normals) ||
        pm__grow((void **)&stock->part, &rooms[2], wanted, sizeof *stock->part))
        return PM_ENOMEM;
    stock->capacity = rooms[0];
    return PM_OK;
}

void pm__stock_free(pm__stock *stock)
{
    free(stock->photons);
    free(stock->normals);
    free(stock->part);
    *stock = (pm__stock){0};
}

void pm__add_powers(const pm_photon *photons, const unsigned char *part, size_t count, double sums[2])
{
    for (size_t i = 0; i < count; i++) {
        const float *const power = photons[i].power;
        const double sum = (double)power[0] + (double)power[1] + (double)power[2];
        sums[0] += sum;
        sums[1] += part[i] ? sum : 0.0;
    }
}

size_t pm__stock_taken(const pm__stock *stock, size_t wanted, const unsigned char *kept, const uint32_t *numbers,
                       uint64_t first, size_t count)
{
    size_t stored = stock->count, begin = 0; /* of the path in hand */
    for (size_t i = 0; i < count; i++) {
        if (i > 0 && numbers[i] != numbers[i - 1]) {
            if (stored >= wanted)
                return i; /* one path is enough */
            begin = i;
        }
        stored += kept ? kept[i] : 1;
        if (stored >= wanted && first + numbers[i] > 0)
            return begin;
    }
    return count;
}
