// The runs of patches along the rows of a divided triangle.
#include <gtest/gtest.h>

#include "lumel/raster/patch_runs.h"
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

/// Hold every pixel of every row against all patches.
void expect_owners(const Corners& corners, uint32_t n, int32_t pixels) {
    constexpr uint32_t kFirst = 1000;
    const DividedTriangle divided(corners, n, kFirst);
    std::vector<PatchRun> runs(divided.room_for_runs());
    std::vector<uint32_t> columns(divided.room_for_columns());
    for (int32_t y = 0; y <= pixels; ++y) {
        std::vector<uint32_t> covered;
        for (int32_t x = 0; x <= pixels; ++x)
            if (patch_covers(corners, 1, {}, x, y)) covered.push_back(static_cast<uint32_t>(x));
        if (covered.empty()) continue;
        const uint32_t count = divided.cut(y, covered.front(), covered.back() + 1, runs.data(), columns.data());
        ASSERT_LE(count, runs.size());
        ASSERT_EQ(runs[count - 1].end, covered.back() + 1);
        uint32_t run = 0;
        for (uint32_t x : covered) {
            while (runs[run].end <= x) ++run;
            ASSERT_GE(runs[run].patch, kFirst);
            ASSERT_LT(runs[run].patch, kFirst + n * n);
            ASSERT_TRUE(patch_covers(corners, n, PatchPlace::of_index(n, runs[run].patch - kFirst), x, y)) << "pixel " << x << ", " << y;
        }
    }
}

}  // namespace

TEST(PatchRuns, are_of_the_patches_that_own_the_pixels) {
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

TEST(PatchRuns, are_exact_for_the_finest_lattice_of_the_largest_window) {
    // The finest division there is, on triangles as large as the largest window.
    constexpr auto kMost = static_cast<int32_t>(Window::kMostResolution * kSubpixels);
    constexpr uint32_t kDivisions = 4096;
    Rng rng(2);
    for (int i = 0; i < 20 && !HasFailure(); ++i) {
        Corners corners;
        for (SnappedVertex& corner : corners)
            corner = {static_cast<int32_t>(rng.uniform() * kMost), static_cast<int32_t>(rng.uniform() * kMost), 0};
        const DividedTriangle divided(corners, kDivisions, 0);
        std::vector<PatchRun> runs(divided.room_for_runs());
        std::vector<uint32_t> columns(divided.room_for_columns());
        const auto y = static_cast<int32_t>((corners[0].y + int64_t{corners[1].y} + corners[2].y) / (3 * kSubpixels));
        const auto inside = [&](int64_t x) { return patch_covers(corners, 1, {}, x, y); };
        int64_t begin = (corners[0].x + int64_t{corners[1].x} + corners[2].x) / (3 * kSubpixels), end = begin;
        if (!inside(begin)) continue;
        while (inside(begin - 1)) --begin;
        while (inside(end)) ++end;
        const uint32_t count = divided.cut(y, static_cast<uint32_t>(begin), static_cast<uint32_t>(end), runs.data(), columns.data());
        ASSERT_EQ(runs[count - 1].end, end);
        for (uint32_t x = static_cast<uint32_t>(begin), run = 0; x < end; ++x) {
            while (runs[run].end <= x) ++run;
            ASSERT_TRUE(patch_covers(corners, kDivisions, PatchPlace::of_index(kDivisions, runs[run].patch), x, y)) << "pixel " << x;
        }
    }
}
