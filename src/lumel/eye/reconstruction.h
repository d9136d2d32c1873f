// The solution between patches: irradiance and specular radiance at lattice vertices, interpolated linearly over patches.
#pragma once

#include <optional>

#include "lumel/accel/accel.h"
#include "lumel/areas/estimates.h"
#include "lumel/areas/irradiance.h"
#include "lumel/eye/bright_patches.h"
#include "lumel/eye/vertex_pool.h"
#include "lumel/scene/lattice.h"

namespace lumel {

/// A value and the standard error that belongs to it.
struct Reconstructed {
    Rgb value, stderr_;
    Trust trust;  ///< of specular estimates
};

/// What a solve knows of the sides: irradiance that was shot, irradiance straight from lamps (0 without the first shot), and the
/// measured areas.
struct Solution {
    const SideField& indirect;
    const SideField& direct;
    const PatchAreas& areas;
};

/// Smooth fields made from a solution. A vertex pools the samples of all patches around it: their sums are added before the
/// estimator takes its ratio.
class Reconstruction {
public:
    Reconstruction(const Accel& accel, const Lattice& lattice, const Solution& solution, const Estimator& estimator);

    /// Where fields are looked up for a point: its patch, and vertices of that face. Where a wall divides the patch, the corners that are
    /// on the same side of it as p have all the weight.
    Lattice::Stencil stencil(SurfacePoint p, bool back) const;
    /// Irradiance that was shot (indirect, or all without the first shot), W/m2.
    Reconstructed irradiance(const Lattice::Stencil& at) const;
    /// A point on the same face, drawn by the share that the light around it has in `irradiance`; nothing where that is unknown.
    std::optional<SurfacePoint> draw_source(const Lattice::Stencil& at, Square choice, Square where) const;
    /// Irradiance of all light, W/m2: what a ray finds that meets the surface from afar.
    Rgb total_irradiance(const Lattice::Stencil& at) const;
    /// Indirect specular radiance towards an eye, W/(m2 sr); nothing where none of the vertices around was measured.
    std::optional<Reconstructed> specular(uint32_t eye, const Lattice::Stencil& at) const;

    const BrightPatches& bright_patches() const { return bright_patches_; }

    /// Vertices that had no sample of their own and took those of their neighbours, and vertices that found none there either.
    uint32_t borrowed() const { return borrowed_; }
    uint32_t unfilled() const { return unfilled_; }
    /// Share of the vertices with specular samples whose estimate is flagged (see Trust), 0..1.
    double flagged() const { return measured_ > 0 ? static_cast<double>(flagged_) / measured_ : 0; }

private:
    /// A value and its standard error at every vertex and side.
    struct VertexField {
        std::vector<Rgb> value, stderr_;
    };
    VertexField pooled(const SideField& field) const;
    void estimate_specular(const PatchAreas& areas, const Estimator& estimator, uint32_t eye);
    /// Make the field linear along edges that coarser cells share.
    void hang_specular(uint32_t eye);
    /// Find the edges of patches whose ends a wall keeps apart, or whose end is covered. Fields are not linear along these.
    void find_cut_edges();
    bool is_cut(const Lattice::Hanging& hanging, bool back) const;
    uint32_t vertex_side(uint32_t vertex, bool back) const { return vertex + (back ? lattice_->size() : 0); }

    const Accel* accel_;
    const Scene* scene_;
    const Lattice* lattice_;
    std::optional<VertexPool> pool_;
    std::vector<uint64_t> cut_edges_;  // names of both vertex sides, sorted
    VertexField indirect_, direct_;
    BrightPatches bright_patches_;
    Neighbourhood neighbourhood_;
    std::vector<std::vector<Reconstructed>> specular_;  // per eye and slot of the neighbourhood
    uint32_t borrowed_ = 0, unfilled_ = 0, measured_ = 0, flagged_ = 0;
};

}  // namespace lumel
