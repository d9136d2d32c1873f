// What all sweeps of a scene share, however many threads make them.
#pragma once

#include "lumel/scene/scene.h"

namespace lumel {

/// What sweeps ask of a triangle, together.
struct RasterTriangle {
    Indices corners{};
    uint32_t n = 1, first_patch = 0;  ///< it has n x n patches
    uint32_t closed_surface = 0;      ///< number of it, or RasterScene::kOpen
};

/// A scene with its closed surfaces. A line that crosses one enters it as often as it leaves it, in turn, so that gaps show.
class RasterScene {
public:
    static constexpr uint32_t kOpen = 0xffffffffu;

    /// `scene` must outlive it.
    explicit RasterScene(const Scene& scene);

    const Scene& scene() const { return *scene_; }
    /// Number of the closed surface of a triangle, or kOpen.
    uint32_t closed_surface(uint32_t triangle) const { return triangles_[triangle].closed_surface; }
    const std::vector<RasterTriangle>& triangles() const { return triangles_; }

private:
    const Scene* scene_;
    std::vector<RasterTriangle> triangles_;
};

}  // namespace lumel
