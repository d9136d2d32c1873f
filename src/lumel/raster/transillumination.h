// The transillumination buffer ([WIS] 3.2): all patches along one direction at once, every line of the window with all that it meets.
#pragma once

#include "lumel/raster/projection.h"
#include "lumel/raster/raster_scene.h"

namespace lumel {

/// What sweeps along directions met.
struct SweepCounters {
    uint64_t directions = 0;
    uint64_t fragments = 0;   ///< patches met, summed over all lines
    uint64_t lines = 0;       ///< pixels of the window that hold a fragment
    uint64_t pairs = 0;       ///< neighbours on a line; each carries light both ways
    uint64_t most_depth = 0;  ///< most fragments on one line
    /// Lines that enter and leave closed surfaces unequally often, or have two neighbouring fragments of one closed surface that face the
    /// same way: cracks, self-intersections, and depths that cannot be told apart.
    uint64_t parity_violations = 0;
    Rgb64 escaped;  ///< radiance sent by sides that see nothing, summed over pixels; times pixel_area it is W/sr

    SweepCounters& operator+=(const SweepCounters& other);
};

/// Rasterises the scene and exchanges light along its lines. Coverage is exact: a pixel on the shared edge of two patches belongs to one of
/// them, also where the triangles are divided unequally. Faces seen edge-on, needles, patches that coincide or cross, and open
/// surfaces are all right. Equal depths are told apart by the number of the patch. Holds scratch memory: one object a thread.
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

private:
    const RasterScene* scene_;
    std::vector<SnappedVertex> vertices_;
};

}  // namespace lumel
