// Owen-scrambled Sobol points, padded in pairs of dimensions: well spread in every aligned power-of-two block of indices.
#pragma once

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

/// Second Sobol dimension of an index, both with their bits reversed: the first dimension is the reversed index, so this takes what the
/// first is, too. The generator matrix is Pascal's triangle modulo 2, the fifth Kronecker power of [1 1; 0 1]: each of the five factors
/// adds half of the bits to the other half.
constexpr uint32_t sobol_second_reversed(uint32_t index) {
    index ^= (index & 0xaaaaaaaau) >> 1;
    index ^= (index & 0xccccccccu) >> 2;
    index ^= (index & 0xf0f0f0f0u) >> 4;
    index ^= (index & 0xff00ff00u) >> 8;
    return index ^ index >> 16;
}

/// Point `index` of the scrambled (0,2)-sequence of stream `seed`, whose halves are `lo` and `hi`. Other streams are independently shuffled
/// and scrambled (Burley 2020, JCGT 9(4)), so that pairs of dimensions can be padded by giving each its own stream.
constexpr Square sobol2d(uint32_t index, uint32_t lo, uint32_t hi) {
    // A shuffled index is its own first dimension reversed, which is what scrambling starts from.
    const uint32_t first = reverse_bits(scramble_reversed(reverse_bits(index), lo ^ 0x79c68e4au)), second = sobol_second_reversed(first);
    const auto scramble = [](uint32_t reversed, uint32_t key) { return to_unit(reverse_bits(scramble_reversed(reversed, key))); };
    return {scramble(first, hi), scramble(second, lo * 0x9e3779b9u + hi)};
}
constexpr Square sobol2d(uint32_t index, uint64_t seed) {
    return sobol2d(index, static_cast<uint32_t>(seed), static_cast<uint32_t>(seed >> 32));
}

}  // namespace lumel
