// Random numbers for what one eye sample does.
#pragma once

#include <array>

#include "lumel/math/vec_array.h"
#include "lumel/sampling/hash.h"
#include "lumel/sampling/sobol.h"

namespace lumel {

/// Pairs of random numbers for one eye sample; sample `index` of a pixel is well spread against its other samples. They are drawn many
/// side by side, since nearly all samples need several.
class EyeStream {
public:
    EyeStream(uint64_t pixel, uint32_t index) : pixel_(pixel), index_(index) {}
    Square next() {
        if (used_ == kSideBySide) draw();
        const Square s{u_[used_], v_[used_]};
        ++used_;
        return s;
    }
    float next_one() { return next().u; }
    /// Numbers for a ray that only some samples of the pixel send, the one of this number among them: every so manieth sample of a sequence
    /// would leave most of the square empty.
    EyeStream of_some(uint64_t kind, uint32_t number) const { return {key(pixel_, ~kind), number}; }

private:
    void draw() {
        const auto lo = static_cast<uint32_t>(pixel_), hi = static_cast<uint32_t>(pixel_ >> 32);
        for (uint32_t k = 0; k < kSideBySide; ++k) {
            const uint32_t first = mix32(lo + (dimension_ + k) * 0x9e3779b9u), second = mix32(hi ^ first);
            const Square s = sobol2d(index_, first, second);
            u_[k] = s.u, v_[k] = s.v;
        }
        dimension_ += kSideBySide, used_ = 0;
    }

    uint64_t pixel_;
    uint32_t index_, dimension_ = 0, used_ = kSideBySide;
    alignas(32) std::array<float, kSideBySide> u_, v_;
};

}  // namespace lumel
