// Random numbers keyed by what they are for, never by the thread that asks.
#pragma once

#include <cstdint>

namespace lumel {

/// Mix 64 bits well (the finaliser of splitmix64, Steele et al. 2014).
constexpr uint64_t mix(uint64_t x) {
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

/// A key for the random stream of one thing: fold the numbers that name it, one at a time.
constexpr uint64_t key(uint64_t a) { return mix(a + 0x9e3779b97f4a7c15ull); }
template <class... Rest>
constexpr uint64_t key(uint64_t a, uint64_t b, Rest... rest) {
    return key(mix(a + 0x9e3779b97f4a7c15ull) ^ b, rest...);
}

/// Mix 32 bits well (constants found by Wellons 2018), for many numbers side by side: vectors have no product of 64 bits.
constexpr uint32_t mix32(uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352du;
    x = (x ^ (x >> 15)) * 0x846ca68bu;
    return x ^ (x >> 16);
}

/// Uniform float in [0, 1) from the upper bits of `x`, which vectors convert as signed numbers.
constexpr float to_unit(uint32_t x) { return static_cast<float>(static_cast<int32_t>(x >> 8)) * 0x1p-24f; }

/// A small sequential generator (splitmix64) for the few places where the count of numbers is not known beforehand.
class Rng {
public:
    explicit constexpr Rng(uint64_t stream) : state_(stream) {}
    constexpr uint64_t bits() { return mix(state_ += 0x9e3779b97f4a7c15ull); }
    /// Uniform in [0, 1).
    constexpr float uniform() { return to_unit(static_cast<uint32_t>(bits() >> 32)); }

private:
    uint64_t state_;
};

}  // namespace lumel
