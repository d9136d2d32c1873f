// The scene that is rendered: triangles with their patches, materials, lamps.
#pragma once

#include <span>
#include <vector>

#include "lumel/math/frame.h"
#include "lumel/sampling/distribution.h"
#include "lumel/scene/lamp_arrays.h"
#include "lumel/scene/lamp_facets.h"
#include "lumel/scene/lamp_tree.h"
#include "lumel/scene/material.h"
#include "lumel/scene/patch_parts.h"
#include "lumel/scene/side_order.h"
#include "lumel/scene/tessellation.h"

namespace lumel {

using Indices = std::array<uint32_t, 3>;

/// Triangles as they come from a reader. `normals` is empty or one a vertex; a zero normal shades flat.
struct MeshInput {
    std::span<const Vec3> vertices;
    std::span<const Vec3> normals;
    std::span<const Indices> triangles;
    std::span<const uint32_t> triangle_shape;   ///< shape of each triangle
    std::span<const uint32_t> shape_material;   ///< material of each shape
    std::span<const Rgb> shape_emission;        ///< radiance of the front of each shape, W/(m2 sr)
};

/// A lamp without size.
struct PointLamp {
    Vec3 position;
    Rgb intensity;  ///< W/sr
};

/// What was found wrong with the given triangles, which are left out of the scene.
struct MeshReport {
    uint64_t given = 0, nonfinite = 0, bad_index = 0, degenerate = 0, huge = 0, duplicate = 0;
};

/// A point on a triangle.
struct SurfacePoint {
    uint32_t triangle = 0;
    float u = 0, v = 0;
};

/// Shape with emission, a unit of lamp sampling.
struct AreaLamp {
    uint32_t shape = 0;
    Rgb radiance;
    float area = 0;                   ///< m2
    Vec3 centre;                      ///< mean of the triangles' centroids by area
    Vec3 normal;                      ///< mean normal by area: its length tells how flat the lamp is
    float radius = 0;                 ///< all of the lamp is within this distance of the centre
    std::vector<uint32_t> triangles;  ///< those of a facet together
    Distribution by_area;             ///< over `triangles`
    LampFacets facets;                ///< of a round lamp
};

/// What keeps light from a side, or from a part of it: what stands on the patch or cuts it.
struct Cover {
    float open_share = 1;            ///< of the side, that light can reach, 0..1
    uint64_t parts = 0;              ///< a bit for each of kParts equal parts of the patch: those that no light can reach
    std::array<bool, 3> corner{};    ///< those of the patch that no light can reach
    bool divides = false;            ///< light at one of the other corners need not be that at another: a thin wall stands between

    static constexpr uint32_t kDivisions = 8, kParts = kDivisions * kDivisions;
    /// Is a point of the patch, given in it, covered?
    bool covers(Square in_patch) const {
        return parts != 0 && ((parts >> PatchPlace::of_point(kDivisions, in_patch.u, in_patch.v).index(kDivisions)) & 1) != 0;
    }
};

/// Barycentric coordinates of the corners of a patch, seen from a little within: walls often begin right at them.
inline constexpr std::array<Square, 3> kCornersFromWithin{{{0.0067f, 0.0067f}, {0.9867f, 0.0067f}, {0.0067f, 0.9867f}}};

/// One **side** is one face of a patch: index patch for the front, patch + patches() for the back.
class Scene {
public:
    /// Take the triangles, leave out broken ones, and divide the rest into about `patches` patches.
    Scene(const MeshInput& input, std::vector<Material> materials, std::vector<PointLamp> point_lamps, uint64_t patches);

    /// Divide the triangles anew; patches and sides are numbered anew.
    void divide(Tessellation tessellation);

    // Triangles
    uint32_t triangles() const { return static_cast<uint32_t>(indices_.size()); }
    const std::vector<Vec3>& vertices() const { return vertices_; }
    const std::vector<Indices>& indices() const { return indices_; }
    uint32_t shape(uint32_t triangle) const { return shape_[triangle]; }
    uint32_t shapes() const { return static_cast<uint32_t>(shape_material_.size()); }
    const Material& material(uint32_t triangle) const { return materials_[shape_material_[shape_[triangle]]]; }
    uint32_t material_index(uint32_t triangle) const { return shape_material_[shape_[triangle]]; }
    const std::vector<Material>& materials() const { return materials_; }
    Rgb emission(uint32_t triangle) const { return shape_emission_[shape_[triangle]]; }
    Vec3 geometric_normal(uint32_t triangle) const { return normal_[triangle]; }
    float triangle_area(uint32_t triangle) const { return area_[triangle]; }
    /// Divisions of the edges of a triangle, in a uniform tessellation.
    uint32_t divisions(uint32_t triangle) const { return tessellation_.divisions(triangle); }
    bool is_smooth(uint32_t triangle) const { return smooth_[triangle]; }
    /// Whether light on it counts the same wherever it comes from and arrives: there is no gloss, and no shading normal apart.
    bool is_plain(uint32_t triangle) const { return plain_[triangle]; }

    Vec3 position(SurfacePoint p) const {
        const Indices& i = indices_[p.triangle];
        return vertices_[i[0]] * (1 - p.u - p.v) + vertices_[i[1]] * p.u + vertices_[i[2]] * p.v;
    }
    /// Normal of a smooth triangle on the front side, linear over the triangle and not of unit length.
    Vec3 interpolated_normal(SurfacePoint p) const {
        const Indices& i = indices_[p.triangle];
        return normals_[i[0]] * (1 - p.u - p.v) + normals_[i[1]] * p.u + normals_[i[2]] * p.v;
    }
    /// The same of unit length; the geometric normal on flat triangles.
    Vec3 shading_normal(SurfacePoint p) const { return smooth_[p.triangle] ? normalize(interpolated_normal(p)) : normal_[p.triangle]; }

    // Patches and sides
    const Tessellation& tessellation() const { return tessellation_; }
    uint32_t patches() const { return tessellation_.patches(); }
    uint32_t sides() const { return 2 * patches(); }
    uint32_t first_patch(uint32_t triangle) const { return tessellation_.first_patch(triangle); }
    uint32_t patch_of(SurfacePoint p) const { return tessellation_.patch_of(p.triangle, p.u, p.v); }
    uint32_t side_of(SurfacePoint p, bool back) const { return patch_of(p) + (back ? patches() : 0); }
    bool is_back(uint32_t side) const { return side >= patches(); }
    uint32_t patch_of_side(uint32_t side) const { return is_back(side) ? side - patches() : side; }
    uint32_t triangle_of_side(uint32_t side) const { return triangle_of_patch(patch_of_side(side)); }
    uint32_t triangle_of_patch(uint32_t patch) const { return tessellation_.triangle_of(patch); }
    float patch_area(uint32_t patch) const { return area_[triangle_of_patch(patch)] / tessellation_.share(patch); }
    /// Tell what covers each side.
    void set_covers(std::vector<Cover> covers) { covers_ = std::move(covers); }
    const Cover& cover(uint32_t side) const {
        static constexpr Cover kNothing;
        return covers_.empty() ? kNothing : covers_[side];
    }
    /// Tell which sides walls divide into parts, in ascending order, and at which positions of the order of sides a wall stands between a
    /// side and the one before it.
    void set_parts(std::vector<PatchParts> parts, std::span<const uint32_t> walls_before);
    /// The parts of a side; null where it is whole.
    const PatchParts* parts(uint32_t side) const { return is_divided(side) ? &parts_[parts_of_side_[side]] : nullptr; }
    bool is_divided(uint32_t side) const { return !parts_of_side_.empty() && parts_of_side_[side] != kNone; }
    /// Divided sides are numbered without gaps as well, for what only they need.
    uint32_t divided_sides() const { return static_cast<uint32_t>(parts_.size()); }
    uint32_t divided_index(uint32_t side) const { return parts_of_side_[side]; }
    float open_share(uint32_t side) const { return cover(side).open_share; }
    /// Is a part of this side covered?
    bool is_open_in_part(uint32_t side) const { return cover(side).parts != 0; }
    bool has_covers() const { return !covers_.empty(); }
    /// The part of a side that light can reach, m2; the whole patch where that is nothing.
    float side_area(uint32_t side) const {
        const float share = open_share(side);
        return patch_area(patch_of_side(side)) * (share > 0 ? share : 1.0f);
    }
    /// Does this side scatter light? The back of a one-sided surface is black, and so is what no light can reach.
    bool scatters(uint32_t side) const { return (!is_back(side) || material(triangle_of_side(side)).two_sided) && open_share(side) > 0; }
    SurfacePoint point_on_patch(uint32_t patch, Square barycentric) const;
    /// The sides of glossy patches are numbered without gaps as well, for what only they need; kNone for others.
    static constexpr uint32_t kNone = 0xffffffffu;
    uint32_t glossy_sides() const { return 2 * glossy_patches_; }
    uint32_t glossy_index(uint32_t side) const {
        const uint32_t patch = patch_of_side(side), triangle = triangle_of_patch(patch), first = first_glossy_[triangle];
        if (first == kNone || (is_back(side) && !material(triangle).two_sided)) return kNone;
        return first + (patch - first_patch(triangle)) + (is_back(side) ? glossy_patches_ : 0);
    }
    /// All sides, neighbours together.
    const SideOrder& side_order() const { return side_order_; }
    SurfacePoint centre_of_patch(uint32_t patch) const { return point_on_patch(patch, {1.0f / 3, 1.0f / 3}); }

    // Lamps
    const std::vector<AreaLamp>& area_lamps() const { return area_lamps_; }
    const std::vector<PointLamp>& point_lamps() const { return point_lamps_; }
    /// Of all lamps: area lamps first, then point lamps.
    const LampArrays& lamps() const { return lamps_; }
    const LampTree& lamp_tree() const { return lamp_tree_; }
    /// Lamp of a triangle, or -1.
    int lamp_of(uint32_t triangle) const { return shape_lamp_[shape_[triangle]]; }

    // The whole
    Vec3 centre() const { return 0.5f * (lower_ + upper_); }
    float radius() const { return 0.5f * length(upper_ - lower_); }
    /// Distance that keeps a ray off the surface that it starts from, m.
    float epsilon() const { return epsilon_; }
    bool has_mirrors() const { return has_mirrors_; }
    const MeshReport& report() const { return report_; }
    double total_area() const { return total_area_; }

private:
    void take_triangles(const MeshInput& input);
    void order_along_curve();
    void find_lamps();
    void find_facets(AreaLamp& lamp) const;

    std::vector<Vec3> vertices_, normals_;
    std::vector<Indices> indices_;
    std::vector<uint32_t> shape_, shape_material_;
    std::vector<Rgb> shape_emission_;
    std::vector<int> shape_lamp_;
    std::vector<Material> materials_;
    std::vector<Vec3> normal_;
    std::vector<float> area_;
    std::vector<uint8_t> smooth_, plain_;
    Tessellation tessellation_;
    std::vector<uint32_t> first_glossy_;  // per triangle
    uint32_t glossy_patches_ = 0;
    std::vector<Cover> covers_;  // per side, or empty
    std::vector<PatchParts> parts_;
    std::vector<uint32_t> parts_of_side_;  // index into parts_, or empty
    SideOrder side_order_;
    std::vector<AreaLamp> area_lamps_;
    LampArrays lamps_;
    LampTree lamp_tree_;
    std::vector<PointLamp> point_lamps_;
    MeshReport report_;
    Vec3 lower_, upper_;
    float epsilon_ = 0;
    double total_area_ = 0;
    bool has_mirrors_ = false;
};

}  // namespace lumel
