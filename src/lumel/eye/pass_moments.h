// The mean of samples that came in passes, and how far the passes spread.
#pragma once

#include <algorithm>

#include "lumel/math/vec.h"

namespace lumel {

/// Passes may differ in size, and the samples within one are spread better than chance would.
class PassMoments {
public:
    /// Add a pass of `count` samples.
    void add(Rgb mean, float count) {
        count_ += count, count2_ += count * count;
        sum_ += mean * count, sum2_ += mean * (count * count), squares_ += mean * mean * (count * count);
    }
    float count() const { return count_; }
    /// How many passes of equal size would say as much about the spread.
    float passes() const { return count2_ > 0 ? count_ * count_ / count2_ : 0; }
    /// Were there two passes, so that `variance` means something?
    bool has_spread() const { return count_ * count_ > count2_; }
    /// Of all samples.
    Rgb mean() const { return sum_ / std::max(1.0f, count_); }
    /// Variance of `mean`; 0 with fewer than two passes. A pass counts by the square of its size, as its error does in the mean: so large
    /// passes, which are spread well, say how good the whole is. Without bias if samples were independent.
    Rgb variance() const {
        if (!has_spread()) return {};
        const Rgb m = mean(), spread = squares_ - m * sum2_ * 2 + m * m * count2_;
        return Rgb{std::max(0.0f, spread.x), std::max(0.0f, spread.y), std::max(0.0f, spread.z)} / (count_ * count_ - count2_);
    }

private:
    float count_ = 0, count2_ = 0;
    Rgb sum_, sum2_, squares_;
};

}  // namespace lumel
