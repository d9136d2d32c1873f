// The irradiance of every side as an area of interest, over independent replicas.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "lumel/math/vec.h"

namespace lumel {

/// One colour a side with the variance of it.
struct SideField {
    std::vector<Rgb> mean, variance;
};

/// Sums of one field over replicas.
class SideMoments {
public:
    explicit SideMoments(size_t sides) : sum_(sides), squares_(sides) {}

    /// Add the value of a replica.
    void add(size_t side, Rgb64 value) {
        sum_[side] += value;
        squares_[side] += value * value;
    }
    /// Mean over `replicas` and variance of that mean (0 with fewer than two).
    SideField field(uint32_t replicas) const;

private:
    std::vector<Rgb64> sum_, squares_;
};

}  // namespace lumel
