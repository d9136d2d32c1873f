// Discrete distributions over many items: random choice, and systematic choice in the order of the items.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace lumel {

/// Weights of n items as running sums. An item of weight 0 is never chosen.
class Distribution {
public:
    Distribution() = default;
    template <class Weight>
    Distribution(uint32_t n, Weight&& weight) : sums_(n) {
        double sum = 0;
        for (uint32_t i = 0; i < n; ++i) sums_[i] = sum += static_cast<double>(weight(i));
    }

    uint32_t size() const { return static_cast<uint32_t>(sums_.size()); }
    double total() const { return sums_.empty() ? 0 : sums_.back(); }
    double before(uint32_t i) const { return i == 0 ? 0 : sums_[i - 1]; }
    double upto(uint32_t i) const { return sums_[i]; }
    double weight(uint32_t i) const { return upto(i) - before(i); }
    double probability(uint32_t i) const { return weight(i) / total(); }

    /// The item that owns position `at` of [0, total()); total() must be positive. It is found fast a few items after `from`.
    uint32_t find(double at, uint32_t from = 0) const {
        // Go forward by steps that double.
        auto first = sums_.begin() + (at >= before(from) ? from : 0), last = first;
        for (ptrdiff_t step = 1; last != sums_.end() && !(at < *last); step *= 2) {
            first = last + 1;
            last = sums_.end() - first > step ? first + step : sums_.end();
        }
        auto it = std::upper_bound(first, last, at);
        if (it == sums_.end()) it = std::lower_bound(sums_.begin(), sums_.end(), total());
        return static_cast<uint32_t>(it - sums_.begin());
    }

private:
    std::vector<double> sums_;
};

}  // namespace lumel
