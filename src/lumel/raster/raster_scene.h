// What all sweeps of a scene share, however many threads make them.
#pragma once

#include "lumel/scene/scene.h"

namespace lumel {

/// A scene with its closed surfaces: connected triangles of which every edge is met as often one way as the other. A line that crosses a
/// closed surface enters it as often as it leaves it, in turn, so that gaps show.
class RasterScene {
public:
    static constexpr uint32_t kOpen = 0xffffffffu;

    /// `scene` must outlive it.
    explicit RasterScene(const Scene& scene);

    const Scene& scene() const { return *scene_; }
    /// Number of the closed surface of a triangle, or kOpen.
    uint32_t closed_surface(uint32_t triangle) const { return closed_surface_[triangle]; }

private:
    const Scene* scene_;
    std::vector<uint32_t> closed_surface_;
};

}  // namespace lumel
