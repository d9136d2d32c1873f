// What a patch sends and receives in one sweep, in one cache line.
#pragma once

#include <immintrin.h>

#include "lumel/math/vec.h"

namespace lumel {

/// Light along the direction of the window and against it.
struct alignas(64) PatchLight {
    /// Colour and a count: what is sent counts 1, so that what is received counts the pixels that it came over.
    struct alignas(16) Flow {
        float red = 0, green = 0, blue = 0, count = 0;

        Flow() = default;
        Flow(Rgb colour, float n) : red(colour.x), green(colour.y), blue(colour.z), count(n) {}
        Rgb colour() const { return {red, green, blue}; }

        /// Add `times` the `other`.
        void add(const Flow& other, __m128 times) {
            _mm_store_ps(&red, _mm_add_ps(_mm_load_ps(&red), _mm_mul_ps(_mm_load_ps(&other.red), times)));
        }
    };
    Flow sent_along, sent_against;          ///< by the side that faces along the direction, by the one that faces against it
    Flow received_along, received_against;  ///< the same

    PatchLight() = default;
    PatchLight(Rgb along, Rgb against) : sent_along(along, 1), sent_against(against, 1) {}
};

/// Two neighbours see each other over `pixels` pixels: `far` lies behind `near`.
inline void exchange(PatchLight& near, PatchLight& far, uint32_t pixels) {
    const __m128 times = _mm_set1_ps(static_cast<float>(static_cast<int32_t>(pixels)));
    near.received_along.add(far.sent_against, times);
    far.received_against.add(near.sent_along, times);
}

}  // namespace lumel
