// Where the spans of a row pass from patch to patch.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "lumel/raster/divided_triangle.h"

namespace lumel {

/// By how much the number of the patch grows from pixel to pixel of a span: at pixel x by steps[x]. Where it does, bit x % 64 of
/// changes[x / 64] is set.
struct PatchSteps {
    const int32_t* steps = nullptr;
    const uint64_t* changes = nullptr;
};

/// The steps of all spans of a row.
class RowPatches {
public:
    static constexpr uint32_t kWord = 64;  ///< pixels whose bits are together

    /// Be ready for rows of `width` pixels.
    void resize(uint32_t width);
    /// Be ready for another row, in which divided triangles have at most `pixels` pixels, and kMargin more for each.
    void begin_row(size_t pixels);
    static constexpr uint32_t kMargin = 2 * kWord;

    /// Those of spans of one patch: there are none.
    PatchSteps none() const { return {steps_.data(), changes_.data()}; }
    bool has_none(const PatchSteps& of) const { return of.steps == steps_.data(); }
    /// Those of a divided triangle in `row` from pixel `begin` to before `end`; `first` becomes the patch of `begin`.
    PatchSteps add(const DividedTriangle& triangle, int32_t row, uint32_t begin, uint32_t end, uint32_t& first);
    size_t bytes() const { return steps_.capacity() * sizeof(int32_t) + changes_.capacity() * sizeof(uint64_t); }

private:
    std::vector<int32_t> steps_;  // all are 0 before they are found, and those of the first `width_` stay so
    std::vector<uint64_t> changes_;
    size_t width_ = 0, used_ = 0;  // of steps_, whole words
};

/// Call at(x) for the pixels between `from` and `until` whose bit is set in bits(x / 64), in their order, and for `until`.
template <class Bits, class At>
inline void for_each_change(size_t from, size_t until, const Bits& bits, const At& at) {
    constexpr size_t kWord = RowPatches::kWord;
    const size_t last_word = until / kWord;
    const uint64_t last = uint64_t{1} << until % kWord;
    size_t word = from / kWord;
    uint64_t left = bits(word) & ~uint64_t{1} << from % kWord;
    for (; word != last_word; left = bits(++word))
        for (; left != 0; left &= left - 1) at(word * kWord + static_cast<size_t>(std::countr_zero(left)));
    for (left = (left & (last - 1)) | last; left != 0; left &= left - 1) at(word * kWord + static_cast<size_t>(std::countr_zero(left)));
}

}  // namespace lumel
