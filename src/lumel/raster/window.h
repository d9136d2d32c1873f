// The window of a bundle of parallel rays: a square grid of pixels perpendicular to one direction, over all of the scene.
#pragma once

#include "lumel/sampling/sobol.h"
#include "lumel/scene/scene.h"

namespace lumel {

/// Pixel (x, y) stands for the line along `direction` through its centre. All windows of one resolution have pixels of one size.
struct Window {
    static constexpr uint32_t kLeastResolution = 4, kMostResolution = 4096;

    Vec3 direction, right, up;     ///< right-handed: right x up = direction
    Vec3 centre;                   ///< of the scene
    float radius = 0;              ///< of a ball around the scene, m
    uint32_t resolution = 0;       ///< pixels along an edge
    Square jitter;                 ///< shift of the scene against the grid, in pixels
    double pixels_per_metre = 0;
    float pixel_area = 0;          ///< m2

    /// Cover `scene` with `resolution` x `resolution` pixels, shifted by `jitter` in [0,1)^2. Over uniform jitter the expected number of
    /// pixels of a patch is its projected area / pixel_area. Throws std::invalid_argument where a number is out of range.
    static Window covering(const Scene& scene, Vec3 direction, uint32_t resolution, Square jitter);

    /// Position in the window, in pixels: pixel centres have whole coordinates.
    double x(Vec3 p) const { return place(p, right, jitter.u); }
    double y(Vec3 p) const { return place(p, up, jitter.v); }
    /// Distance from the centre of the scene along `direction`, -1..1 in radii.
    double depth(Vec3 p) const { return along(p, direction) / double{radius}; }
    /// The point of the centre of pixel (x, y) at a distance of one radius before the scene.
    Vec3 start_of_line(uint32_t x, uint32_t y) const;

private:
    /// Where the centre of the scene is without jitter: half a pixel before the middle, as jitter adds half a pixel on average.
    double middle() const { return 0.5 * resolution - 1; }
    double along(Vec3 p, Vec3 axis) const {
        return (double{p.x} - double{centre.x}) * double{axis.x} + (double{p.y} - double{centre.y}) * double{axis.y} +
               (double{p.z} - double{centre.z}) * double{axis.z};
    }
    double place(Vec3 p, Vec3 axis, float shift) const { return along(p, axis) * pixels_per_metre + middle() + double{shift}; }
};

}  // namespace lumel
