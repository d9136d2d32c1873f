// The patches along the rows of divided triangles.
#include <gtest/gtest.h>

#include "lumel/raster/row_patches.h"
#include "lumel/sampling/hash.h"
#include "reference_raster.h"

using namespace lumel;
using namespace lumel::test;

namespace {

using Corners = std::array<SnappedVertex, 3>;

/// Corners on a coarse grid: many lines of the lattice go along rows, or through the centres of pixels.
Corners random_corners(int32_t pixels, int32_t places_of_pixel, Rng& rng) {
    Corners corners;
    const auto coordinate = [&] {
        const auto place = static_cast<int32_t>(rng.uniform() * static_cast<float>(pixels * places_of_pixel + 1));
        return place * static_cast<int32_t>(kSubpixels) / places_of_pixel;
    };
    for (SnappedVertex& corner : corners) corner = {coordinate(), coordinate(), 0};
    return corners;
}

/// The patch of each pixel from `begin` to before `end`, by the steps of the row. Every step must have its bit.
std::vector<uint32_t> patches_of_row(RowPatches& row_patches, const DividedTriangle& divided, int32_t row, uint32_t begin, uint32_t end) {
    uint32_t patch = 0;
    const PatchSteps found = row_patches.add(divided, row, begin, end, patch);
    std::vector<uint32_t> patches;
    size_t from = begin;
    for_each_change(
        begin, end, [&](size_t word) { return found.changes[word]; },
        [&](size_t x) {
            patches.insert(patches.end(), x - from, patch);
            for (size_t unchanged = from + 1; unchanged < x; ++unchanged) EXPECT_EQ(found.steps[unchanged], 0);
            patch += static_cast<uint32_t>(found.steps[x]), from = x;
        });
    return patches;
}

/// Hold every pixel of every row against all patches.
void expect_owners(const Corners& corners, uint32_t n, int32_t pixels) {
    constexpr uint32_t kFirst = 1000;
    const DividedTriangle divided(corners, n, kFirst);
    RowPatches row_patches;
    row_patches.resize(static_cast<uint32_t>(pixels) + 1);
    for (int32_t y = 0; y <= pixels; ++y) {
        std::vector<uint32_t> covered;
        for (int32_t x = 0; x <= pixels; ++x)
            if (patch_covers(corners, 1, {}, x, y)) covered.push_back(static_cast<uint32_t>(x));
        if (covered.empty()) continue;
        row_patches.begin_row(covered.size() + RowPatches::kMargin);
        const std::vector<uint32_t> patches = patches_of_row(row_patches, divided, y, covered.front(), covered.back() + 1);
        ASSERT_EQ(patches.size(), covered.size());
        for (size_t k = 0; k < covered.size(); ++k) {
            ASSERT_GE(patches[k], kFirst);
            ASSERT_LT(patches[k], kFirst + n * n);
            ASSERT_TRUE(patch_covers(corners, n, PatchPlace::of_index(n, patches[k] - kFirst), covered[k], y))
                << "pixel " << covered[k] << ", " << y;
        }
    }
}

}  // namespace

TEST(RowPatches, are_of_the_patches_that_own_the_pixels) {
    Rng rng(1);
    for (int i = 0; i < 3000 && !HasFailure(); ++i) {
        const int32_t pixels = 2 + i % 30;
        const std::array places{1, 2, 3, 256};
        const Corners corners = random_corners(pixels, places[static_cast<size_t>(i) % places.size()], rng);
        if (turn(corners[0], corners[1], corners[2]) == 0) continue;
        SCOPED_TRACE("triangle " + std::to_string(i));
        expect_owners(corners, 2 + static_cast<uint32_t>(rng.uniform() * 40), pixels);
    }
}

TEST(RowPatches, are_exact_for_the_finest_lattice_of_the_largest_window) {
    // The finest division there is, on triangles as large as the largest window.
    constexpr auto kMost = static_cast<int32_t>(Window::kMostResolution * kSubpixels);
    constexpr uint32_t kDivisions = 4096;
    Rng rng(2);
    for (int i = 0; i < 20 && !HasFailure(); ++i) {
        Corners corners;
        for (SnappedVertex& corner : corners)
            corner = {static_cast<int32_t>(rng.uniform() * kMost), static_cast<int32_t>(rng.uniform() * kMost), 0};
        const DividedTriangle divided(corners, kDivisions, 0);
        const auto y = static_cast<int32_t>((corners[0].y + int64_t{corners[1].y} + corners[2].y) / (3 * kSubpixels));
        const auto inside = [&](int64_t x) { return patch_covers(corners, 1, {}, x, y); };
        int64_t begin = (corners[0].x + int64_t{corners[1].x} + corners[2].x) / (3 * kSubpixels), end = begin;
        if (!inside(begin)) continue;
        while (inside(begin - 1)) --begin;
        while (inside(end)) ++end;
        RowPatches row_patches;
        row_patches.resize(Window::kMostResolution);
        row_patches.begin_row(static_cast<size_t>(end - begin) + RowPatches::kMargin);
        const auto patches = patches_of_row(row_patches, divided, y, static_cast<uint32_t>(begin), static_cast<uint32_t>(end));
        ASSERT_EQ(patches.size(), static_cast<size_t>(end - begin));
        for (int64_t x = begin; x < end; ++x) {
            const uint32_t patch = patches[static_cast<size_t>(x - begin)];
            ASSERT_TRUE(patch_covers(corners, kDivisions, PatchPlace::of_index(kDivisions, patch), x, y)) << "pixel " << x;
        }
    }
}
