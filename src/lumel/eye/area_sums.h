// Sums over rectangles of a picture.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace lumel {

/// A table of sums (Crow 1984): a rectangle of any size takes four look-ups.
class AreaSums {
public:
    /// `value(pixel)`: of each pixel, row by row.
    template <class Value>
    AreaSums(uint32_t width, uint32_t height, const Value& value) : width_(static_cast<int>(width)), height_(static_cast<int>(height)) {
        sums_.resize(size_t{width + 1} * (height + 1));
        for (int y = 0; y < height_; ++y) {
            double row = 0;
            for (int x = 0; x < width_; ++x) {
                row += value(static_cast<size_t>(y) * width + static_cast<size_t>(x));
                sums_[at(x + 1, y + 1)] = sums_[at(x + 1, y)] + row;
            }
        }
    }
    /// Of the pixels up to `reach` away to each side.
    double around(int x, int y, int reach) const {
        const int x0 = std::max(0, x - reach), y0 = std::max(0, y - reach), x1 = std::min(width_, x + reach + 1),
                  y1 = std::min(height_, y + reach + 1);
        return std::max(0.0, sums_[at(x1, y1)] - sums_[at(x0, y1)] - sums_[at(x1, y0)] + sums_[at(x0, y0)]);
    }

private:
    size_t at(int x, int y) const { return static_cast<size_t>(y) * static_cast<size_t>(width_ + 1) + static_cast<size_t>(x); }

    int width_, height_;
    std::vector<double> sums_;
};

}  // namespace lumel
