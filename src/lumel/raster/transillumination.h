// The transillumination buffer ([WIS] 3.2): all patches along one direction at once, every line of the window with all that it meets.
#pragma once

#include "lumel/raster/raster_scene.h"
#include "lumel/raster/scan_triangles.h"

namespace lumel {

/// Rasterises the scene and exchanges light along its lines. Coverage is exact: a pixel on the shared edge of two patches belongs to one of
/// them, also where the triangles are divided unequally; for that their vertices must be in the same places. Where a vertex lies on the
/// edge of another triangle, a gap or overlap of half a subpixel is possible, as it is for rays. Faces seen edge-on, needles, patches that
/// coincide or cross, and open surfaces are all right. Equal depths are told apart by the number of the triangle. A sheet thinner than a
/// subpixel or two may fold over itself when its corners are snapped; its lines then cross it three times, in turn.
///
/// Holds scratch memory, which grows with the patches and with the spans of one row: one object a thread.
class Transillumination {
public:
    /// `scene` must outlive it.
    explicit Transillumination(const RasterScene& scene) : scene_(&scene) {}

    /// Carry light along `window.direction` both ways.
    ///
    /// `sent` (sides): the radiance that each side sends along the line; a side that faces the direction sends along it, one that faces
    /// against it sends back along it. `received` (sides) += the radiance that arrives, summed over the pixels of the side. `pixels`
    /// (patches) += the pixels that the patch covers: both of its sides have as many, whether or not light arrives there.
    /// Times pixel_area they stand for the projected area. Which way a patch faces is told by its snapped corners; seen edge-on, that
    /// may differ from its normal.
    void exchange(const Window& window, std::span<const Rgb> sent, std::span<Rgb> received, std::span<uint32_t> pixels,
                  SweepCounters& counters);

    /// Memory that it holds, in bytes.
    size_t bytes() const;

private:
    void prepare(const Window& window);
    void begin_triangles(uint32_t row, std::span<const Rgb> sent);
    void collect(std::span<Rgb> received, std::span<uint32_t> pixels, SweepCounters& counters);
    std::array<SnappedVertex, 3> corners(const RasterTriangle& triangle) const {
        const auto& [a, b, c] = triangle.corners;
        return {vertices_[a], vertices_[b], vertices_[c]};
    }

    const RasterScene* scene_;
    std::vector<SnappedVertex> vertices_;
    std::vector<uint32_t> first_row_;  // of each triangle, or the number of rows where it has none
    std::vector<uint8_t> front_along_;  // of each triangle: its front looks along the direction
    std::vector<uint32_t> first_of_row_, by_row_;  // triangles in the order of their first rows, and where those of a row begin
    ScanTriangles active_;
    RowSweep sweep_;
};

}  // namespace lumel
