// Which pixels see surfaces whose light is about equally well reconstructed.
#pragma once

#include <vector>

#include "lumel/eye/film.h"

namespace lumel {

/// Compares what the pixels of a film see, as the mean of their samples.
class Likeness {
public:
    explicit Likeness(const Film& film);
    /// Do two pixels see surfaces that are about as far, as bright, and turned the same way? Never where there is nothing.
    bool operator()(size_t pixel, size_t other) const {
        const Seen &a = seen_[pixel], &b = seen_[other];
        return dot(a.normal, b.normal) > kNormal && std::abs(a.depth - b.depth) <= kDepth * a.depth &&
               std::abs(a.albedo - b.albedo) <= kAlbedo * a.albedo;
    }

private:
    static constexpr float kNormal = 0.8f;                  // cosine
    static constexpr float kDepth = 0.1f, kAlbedo = 0.25f;  // relative differences

    struct Seen {
        Vec3 normal;  // of length 1
        float depth = 0, albedo = 0;
    };
    std::vector<Seen> seen_;
};

}  // namespace lumel
