#include "sobol.h"

/* Direction numbers, from primitive polynomials over GF(2) and the first numbers of Joe and Kuo 2008:
 *
 *     dimension  polynomial   m_1, m_2, ...
 *     0          (van der Corput: the index with its bits reversed)
 *     1          x + 1        1
 *     2          x^2 + x + 1  1, 3
 *     3          x^3 + x + 1  1, 3, 1
 *
 * For x^s + a_1 x^(s-1) + ... + 1: v_k = m_k 2^(32-k) up to k = s, then
 * v_k = a_1 v_(k-1) ^ ... ^ a_(s-1) v_(k-s+1) ^ v_(k-s) ^ v_(k-s) >> s. The first two dimensions are a
 * (0, m, 2)-net: every elementary interval of area 2^-m holds one of the first 2^m points. */
static const uint32_t directions[PM__SOBOL_DIMENSIONS - 1][32] = {
    {0x80000000u, 0xc0000000u, 0xa0000000u, 0xf0000000u, 0x88000000u, 0xcc000000u, 0xaa000000u, 0xff000000u,
     0x80800000u, 0xc0c00000u, 0xa0a00000u, 0xf0f00000u, 0x88880000u, 0xcccc0000u, 0xaaaa0000u, 0xffff0000u,
     0x80008000u, 0xc000c000u, 0xa000a000u, 0xf000f000u, 0x88008800u, 0xcc00cc00u, 0xaa00aa00u, 0xff00ff00u,
     0x80808080u, 0xc0c0c0c0u, 0xa0a0a0a0u, 0xf0f0f0f0u, 0x88888888u, 0xccccccccu, 0xaaaaaaaau, 0xffffffffu},
    {0x80000000u, 0xc0000000u, 0x60000000u, 0x90000000u, 0xe8000000u, 0x5c000000u, 0x8e000000u, 0xc5000000u,
     0x68800000u, 0x9cc00000u, 0xee600000u, 0x55900000u, 0x80680000u, 0xc09c0000u, 0x60ee0000u, 0x90550000u,
     0xe8808000u, 0x5cc0c000u, 0x8e606000u, 0xc5909000u, 0x6868e800u, 0x9c9c5c00u, 0xeeee8e00u, 0x5555c500u,
     0x8000e880u, 0xc0005cc0u, 0x60008e60u, 0x9000c590u, 0xe8006868u, 0x5c009c9cu, 0x8e00eeeeu, 0xc5005555u},
    {0x80000000u, 0xc0000000u, 0x20000000u, 0x50000000u, 0xf8000000u, 0x74000000u, 0xa2000000u, 0x93000000u,
     0xd8800000u, 0x25400000u, 0x59e00000u, 0xe6d00000u, 0x78080000u, 0xb40c0000u, 0x82020000u, 0xc3050000u,
     0x208f8000u, 0x51474000u, 0xfbea2000u, 0x75d93000u, 0xa0858800u, 0x914e5400u, 0xdbe79e00u, 0x25db6d00u,
     0x58800080u, 0xe54000c0u, 0x79e00020u, 0xb6d00050u, 0x800800f8u, 0xc00c0074u, 0x200200a2u, 0x50050093u},
};

static uint32_t reverse_bits(uint32_t x)
{
    x = x << 16 | x >> 16;
    x = (x & 0x00ff00ffu) << 8 | (x >> 8 & 0x00ff00ffu);
    x = (x & 0x0f0f0f0fu) << 4 | (x >> 4 & 0x0f0f0f0fu);
    x = (x & 0x33333333u) << 2 | (x >> 2 & 0x33333333u);
    return (x & 0x55555555u) << 1 | (x >> 1 & 0x55555555u);
}

uint32_t pm__sobol(uint32_t index, int dimension)
{
    if (dimension == 0)
        return reverse_bits(index);
    const uint32_t *direction = directions[dimension - 1];
    uint32_t x = 0;
    for (; index; index >>= 1, direction++)
        x ^= *direction & (0u - (index & 1u));
    return x;
}

uint32_t pm__owen_scramble(uint32_t x, const uint32_t keys[4])
{
    /* With the digits reversed, sums and products let a bit depend on the less significant ones only, which are
     * the digits above. A product with an even number leaves the bit itself out, so x ^= x * even permutes. The
     * sums make the result uniform; the products, keyed, make the flips of different prefixes differ. */
    x = reverse_bits(x);
    x += keys[0];
    x ^= x * (keys[1] & ~1u);
    x *= keys[2] | 1u;
    x ^= x * (keys[3] & ~1u);
    x += keys[1] >> 16 | keys[3] << 16;
    x ^= x * ((keys[0] ^ keys[2]) & ~1u);
    x *= (keys[3] >> 16 | keys[1] << 16) | 1u;
    return reverse_bits(x);
}
