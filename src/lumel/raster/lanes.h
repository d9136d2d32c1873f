// Four doubles side by side, as vectors of the compiler. Functions take them by reference: to hand over values needs AVX.
#pragma once

#include <cstdint>

namespace lumel {

inline constexpr uint32_t kLanes = 4;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));
using IntLanes = int32_t __attribute__((vector_size(kLanes * sizeof(int32_t))));
using FloatLanes = float __attribute__((vector_size(kLanes * sizeof(float))));

/// To the nearest whole number; |v| < 2^51, so that the sum has no room for fractions.
inline void round(Lanes& v) { v = (v + 0x1.8p52) - 0x1.8p52; }

/// To the least whole number that is not below v. A quotient a/b of whole numbers is rounded exactly if |a| < 2^53: it lies at least 1/b
/// above the whole number below it, and the error of the division is less.
inline void round_up(Lanes& v) {
    const Lanes given = v;
    round(v);
    v = v < given ? v + 1 : v;
}

/// One bit for each lane of a comparison.
inline uint32_t bits(IntLanes is_true) {
    const IntLanes bit = is_true & IntLanes{1, 2, 4, 8};
    return static_cast<uint32_t>(bit[0] | bit[1] | bit[2] | bit[3]);
}

inline IntLanes to_int(const Lanes& v) { return __builtin_convertvector(v, IntLanes); }

}  // namespace lumel
