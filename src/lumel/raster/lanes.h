// Four doubles side by side, as vectors of the compiler, with intrinsics where these have no operation. Functions take them by reference:
// to hand over values needs AVX.
#pragma once

#include <cstddef>
#include <cstdint>
#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace lumel {

inline constexpr uint32_t kLanes = 4;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using IntLanes = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));
using UintLanes = uint32_t __attribute__((vector_size(kLanes * sizeof(uint32_t))));
using FloatLanes = float __attribute__((vector_size(kLanes * sizeof(float))));

/// To the nearest whole number; |v| < 2^51.
inline void round(Lanes& v) {
#ifdef __AVX2__
    v = _mm256_round_pd(v, _MM_FROUND_TO_NEAREST_INT | _MM_FROUND_NO_EXC);
#else
    v = (v + 0x1.8p52) - 0x1.8p52;  // the sum has no room for fractions
#endif
}

/// To the least whole number that is not below v. A quotient a/b of whole numbers is rounded exactly if |a| < 2^53: it lies at least 1/b
/// above the whole number below it, and the error of the division is less.
inline void round_up(Lanes& v) {
#ifdef __AVX2__
    v = _mm256_ceil_pd(v);
#else
    const Lanes given = v;
    round(v);
    v = v < given ? v + 1 : v;
#endif
}

/// To the greatest whole number that is not above v.
inline void round_down(Lanes& v) {
    v = -v;
    round_up(v);
    v = -v;
}

/// One bit for each lane of a comparison.
inline uint32_t bits(IntLanes is_true) {
#ifdef __AVX2__
    return static_cast<uint32_t>(_mm_movemask_ps(reinterpret_cast<__m128>(is_true)));
#else
    const IntLanes bit = is_true & IntLanes{1, 2, 4, 8};
    return static_cast<uint32_t>(bit[0] | bit[1] | bit[2] | bit[3]);
#endif
}

/// One bit for each of 32 numbers that is not 0.
inline uint32_t which_are_not_0(const int32_t* numbers) {
#ifdef __AVX2__
    const auto is_0 = [&](size_t k) {
        return _mm256_cmpeq_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(numbers) + k), _mm256_setzero_si256());
    };
    // Packing goes by halves of the vectors, which come back into order in the end.
    const __m256i bytes = _mm256_packs_epi16(_mm256_packs_epi32(is_0(0), is_0(1)), _mm256_packs_epi32(is_0(2), is_0(3)));
    return ~static_cast<uint32_t>(_mm256_movemask_epi8(_mm256_permutevar8x32_epi32(bytes, _mm256_setr_epi32(0, 4, 1, 5, 2, 6, 3, 7))));
#else
    uint32_t bits = 0;
    for (uint32_t k = 0; k < 32; ++k) bits |= (numbers[k] != 0 ? 1u : 0u) << k;
    return bits;
#endif
}

inline IntLanes to_int(const Lanes& v) { return __builtin_convertvector(v, IntLanes); }

}  // namespace lumel
