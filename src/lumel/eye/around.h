// The pixels around one.
#pragma once

#include "lumel/eye/film.h"

namespace lumel {

inline size_t pixel_at(const Film& film, int x, int y) { return size_t{film.width} * static_cast<size_t>(y) + static_cast<size_t>(x); }

/// Visit a pixel and those up to `reach` away to each side, row by row: `body(pixel, x, y)`.
template <class Body>
void for_each_around(const Film& film, int x, int y, int reach, const Body& body) {
    const int x0 = std::max(0, x - reach), x1 = std::min(static_cast<int>(film.width) - 1, x + reach);
    const int y0 = std::max(0, y - reach), y1 = std::min(static_cast<int>(film.height) - 1, y + reach);
    for (int j = y0; j <= y1; ++j)
        for (int i = x0; i <= x1; ++i) body(pixel_at(film, i, j), i, j);
}

}  // namespace lumel
