// Sine and cosine of an angle counted in turns, as warps need them: without branches or calls, so that loops over them become vector code.
#pragma once

#include <cstdint>

namespace lumel {

struct CosSin {
    float cos = 1, sin = 0;
};

/// cos(2 pi t) and sin(2 pi t) for t in [0, 1], to 1e-7.
constexpr CosSin cos_sin_turns(float t) {
    // Go to the nearest quarter: the rest is at most an eighth of a turn, and its subtraction is exact.
    const int32_t quarter = (static_cast<int32_t>(8 * t) + 1) >> 1;
    const float a = 6.28318530717958648f * (t - 0.25f * static_cast<float>(quarter)), a2 = a * a;
    // Taylor series; what is left out, a^11/11! and a^10/10!, is below the rounding of floats.
    const float sin = a + a * a2 * (-1.0f / 6 + a2 * (1.0f / 120 + a2 * (-1.0f / 5040 + a2 * (1.0f / 362880))));
    const float cos = 1 + a2 * (-0.5f + a2 * (1.0f / 24 + a2 * (-1.0f / 720 + a2 * (1.0f / 40320))));
    // Turn back by whole quarters: odd ones swap, and two of the four change a sign.
    const bool odd = quarter & 1;
    const float c = odd ? sin : cos, s = odd ? cos : sin;
    return {(quarter + 1) & 2 ? -c : c, quarter & 2 ? -s : s};
}

}  // namespace lumel
