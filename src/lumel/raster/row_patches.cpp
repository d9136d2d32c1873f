#include "lumel/raster/row_patches.h"

#include <algorithm>

namespace lumel {

void RowPatches::resize(uint32_t width) {
    used_ = width_ = (width / kWord + 1) * size_t{kWord};
    steps_.assign(std::max(steps_.size(), width_), 0);
    changes_.assign(steps_.size() / kWord, 0);
}

void RowPatches::begin_row(size_t pixels) {
    std::fill(steps_.data() + width_, steps_.data() + used_, 0);
    used_ = width_;
    if (steps_.size() < width_ + pixels) changes_.resize(2 * (width_ + pixels) / kWord + 1), steps_.resize(changes_.size() * kWord);
}

PatchSteps RowPatches::add(const DividedTriangle& triangle, int32_t row, uint32_t begin, uint32_t end, uint32_t& first) {
    // Take the words that hold the span: those of the row before them belong to others.
    const size_t first_word = begin / kWord, words = end / kWord + 1 - first_word, origin = used_ - first_word * kWord;
    const int32_t* step = &steps_[used_];
    uint64_t* const changes = &changes_[used_ / kWord];
    used_ += words * kWord;
    first = triangle.cut(row, begin, end, &steps_[origin]);
    steps_[origin + end] = 0;
    for (size_t k = 0; k < words; ++k, step += kWord)
        changes[k] = uint64_t{which_are_not_0(step)} | uint64_t{which_are_not_0(step + kWord / 2)} << 32;
    return {&steps_[origin], &changes_[origin / kWord]};
}

}  // namespace lumel
