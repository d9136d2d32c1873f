// What the bundles of a step bring to any point of a surface: linear between the vertices of the lattice, so that no patch shows.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lumel/areas/bundle_samples.h"
#include "lumel/scene/lattice.h"

namespace lumel {

/// A vertex pools the sides around it, as they are seen from the end of the line that is in front of it: with A their areas,
///     I / cos = sum A I / sum A cos(theta_i)      C / cos = sum A C / sum A cos(theta_i)
/// Even radiance stays even, however the surface bends, and the mean of C over jitter is cos(theta_i) as it is for a patch.
class BundleField {
public:
    using Lane = BundleSamples::Lane;
    /// Of each bundle, at a point: the irradiance, W/(m2 sr), and the rasterised projected area over the area.
    struct Light {
        Lane r, g, b, cosine;
        Rgb irradiance(size_t bundle) const { return {r[bundle], g[bundle], b[bundle]}; }
    };

    BundleField() = default;
    /// For points of `sides`.
    BundleField(const Scene& scene, const Lattice& lattice, std::span<const uint32_t> sides);

    /// Take the bundles of a step, at most BundleSamples::kMost.
    void pool(std::span<const Bundle> bundles);
    /// What they bring to a point of one of the sides.
    void at(SurfacePoint p, bool back, Light& light) const;

private:
    void pool_slot(uint32_t slot);
    Vec3 normal_of(uint32_t side) const {
        return scene_->geometric_normal(scene_->triangle_of_side(side)) * (scene_->is_back(side) ? -1.0f : 1.0f);
    }
    /// Cosines of all directions, on the side of `normal`.
    void cosines(Vec3 normal, Lane& cosine) const;

    const Scene* scene_ = nullptr;
    const Lattice* lattice_ = nullptr;
    std::vector<uint32_t> slot_;  // of a vertex on one face, where two sides or more meet; else Scene::kNone
    std::vector<uint32_t> first_side_, sides_;  // of each slot
    std::vector<Vec3> normal_;                  // of each slot
    std::vector<Light> light_;                  // of each slot, over the cosines
    std::span<const Bundle> bundles_;
    Lane x_{}, y_{}, z_{};  // of their directions
};

}  // namespace lumel
