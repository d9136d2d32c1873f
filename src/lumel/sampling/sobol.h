// Owen-scrambled Sobol points, padded in pairs of dimensions: well spread in every aligned power-of-two block of indices.
#pragma once

#include <array>
#include <cstdint>

#include "lumel/sampling/hash.h"

namespace lumel {

/// A point of the unit square.
struct Square {
    float u = 0, v = 0;
};

constexpr uint32_t reverse_bits(uint32_t x) {
    x = __builtin_bswap32(x);
    x = ((x & 0x0f0f0f0fu) << 4) | ((x >> 4) & 0x0f0f0f0fu);
    x = ((x & 0x33333333u) << 2) | ((x >> 2) & 0x33333333u);
    return ((x & 0x55555555u) << 1) | ((x >> 1) & 0x55555555u);
}

/// Nested uniform scramble of a bit-reversed number (Laine and Karras 2011, constants by Vegdahl 2021).
constexpr uint32_t scramble_reversed(uint32_t x, uint32_t seed) {
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16) | 1u;
    x ^= x * 0x05526c56u;
    return x ^ (x * 0x53a22864u);
}

constexpr uint32_t owen_scramble(uint32_t x, uint32_t seed) { return reverse_bits(scramble_reversed(reverse_bits(x), seed)); }

namespace detail {

/// Second Sobol dimension of every byte position, so that an index needs four look-ups.
constexpr std::array<std::array<uint32_t, 256>, 4> sobol_table() {
    std::array<std::array<uint32_t, 256>, 4> table{};
    std::array<uint32_t, 32> direction{};
    direction[0] = 0x80000000u;
    for (int i = 1; i < 32; ++i) direction[i] = direction[i - 1] ^ (direction[i - 1] >> 1);
    for (int byte = 0; byte < 4; ++byte)
        for (uint32_t value = 0; value < 256; ++value)
            for (int bit = 0; bit < 8; ++bit)
                if (value >> bit & 1) table[byte][value] ^= direction[8 * byte + bit];
    return table;
}
inline constexpr auto kSobol = sobol_table();

}  // namespace detail

/// Point `index` of the scrambled (0,2)-sequence of stream `seed`. Other streams are independently shuffled and scrambled
/// (Burley 2020, JCGT 9(4)), so that pairs of dimensions can be padded by giving each its own stream.
inline Square sobol2d(uint32_t index, uint64_t seed) {
    const auto lo = static_cast<uint32_t>(seed), hi = static_cast<uint32_t>(seed >> 32);
    // Shuffling the index needs it reversed twice; the first Sobol dimension is its reversal, so one of them is free.
    const uint32_t reversed = scramble_reversed(reverse_bits(index), lo ^ 0x79c68e4au);
    const uint32_t shuffled = reverse_bits(reversed);
    const uint32_t y = detail::kSobol[0][shuffled & 255] ^ detail::kSobol[1][shuffled >> 8 & 255] ^
                       detail::kSobol[2][shuffled >> 16 & 255] ^ detail::kSobol[3][shuffled >> 24];
    return {to_unit(owen_scramble(reversed, hi)), to_unit(owen_scramble(y, lo * 0x9e3779b9u + hi))};
}

}  // namespace lumel
