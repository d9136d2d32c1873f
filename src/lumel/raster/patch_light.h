// What a patch sends and receives in one sweep, in one cache line.
#pragma once

#include <immintrin.h>

#include "lumel/math/vec.h"

namespace lumel {

/// Light along the direction of the window and against it, each as red, green, blue and a count: what is sent counts 1, so that what is
/// received counts the pixels.
struct alignas(64) PatchLight {
    struct alignas(16) Flow {
        float red = 0, green = 0, blue = 0, count = 1;
    };
    Flow sent_along, sent_against;
    Flow received_along{0, 0, 0, 0}, received_against{0, 0, 0, 0};  ///< by the side that faces along, by the one that faces against

    PatchLight() = default;
    PatchLight(Rgb along, Rgb against) : sent_along{along.x, along.y, along.z, 1}, sent_against{against.x, against.y, against.z, 1} {}

    /// Receive over `width` pixels what `before` sends along the direction and `behind` against it.
    void receive(const PatchLight& before, const PatchLight& behind, __m256 width) {
        const __m256 arriving = _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_load_ps(&behind.sent_against.red)),
                                                     _mm_load_ps(&before.sent_along.red), 1);
        float* received = &received_along.red;
        _mm256_store_ps(received, _mm256_add_ps(_mm256_load_ps(received), _mm256_mul_ps(arriving, width)));
    }
};

}  // namespace lumel
