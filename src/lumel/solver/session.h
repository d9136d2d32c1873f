// Everything that a render holds: the scene made ready, the solver, and a film for every camera.
#pragma once

#include <atomic>
#include <optional>
#include <stdexcept>

#include "lumel/eye/eye_pass.h"
#include "lumel/eye/pixel_radiance.h"
#include "lumel/solver/solver.h"
#include "lumel/transport/variance_growth.h"

namespace lumel {

/// Where the specular light towards the eyes is measured.
enum class AreaKind { kPatches, kPixels };

struct SessionConfig {
    SolverConfig solver;
    AreaKind areas = AreaKind::kPatches;
    const Estimator* estimator = find_estimator("weighted");
    uint64_t adaptive_patches = 0;  ///< divide into about so many patches where the light varies; 0: leave the scene as it is
    Isa isa = best_isa();           ///< that rays are traced with
    float most_gathering = 0;       ///< gathering rays for every shooting ray: above this, areas get fewer than `gather`; 0: no limit
    std::optional<bool> weight_diffuse;  ///< weigh irradiance too; by default where the estimator is `auto` and the density covers it
};

/// One area of interest of a camera.
struct MeasuredArea {
    uint32_t index;  ///< side or pixel
    double albedo;   ///< mean lum(a_s)
    AreaEstimate at;
};

class Session {
public:
    Session(Scene scene, std::vector<Camera> cameras, const SessionConfig& config);
    Session(const Session&) = delete;
    Session& operator=(const Session&) = delete;

    const Scene& scene() const { return scene_; }
    const Accel& accel() const { return accel_; }
    const Lattice& lattice() const { return lattice_; }
    const DefensiveStarts& defensive() const { return defensive_; }
    const std::vector<Camera>& cameras() const { return cameras_; }
    Solver& solver() { return *solver_; }
    Transport transport() const { return config_.solver.transport; }
    Isa isa() const { return config_.isa; }
    bool is_plain() const { return transport() == Transport::kBundles && config_.solver.iteration == Iteration::kPlain; }

    /// Irradiance that was shot, W/m2, weighed if it was asked for.
    SideField indirect() const;
    /// Make the fields for eye passes from the replicas closed so far, and start the films anew.
    void reconstruct();
    const Reconstruction& reconstruction() const { return *reconstruction_; }
    /// Add one pass of `samples` per pixel to the film of a camera; false if it was stopped. `reconstruct` must have been called.
    bool eye_pass(uint32_t camera, uint32_t samples);
    /// Estimates of the pixels, where they are measured.
    const PixelRadiance* pixels(uint32_t camera) const { return pixels_.empty() ? nullptr : &pixels_[camera]; }
    /// Areas or vertices that had no sample when the fields were made: those that took their neighbours' samples, and those left dark.
    uint32_t borrowed() const;
    uint32_t unfilled() const;
    /// Growth of the variance in a step of the plain iteration of bundles (see `variance_growth`).
    double variance_growth() const { return lumel::variance_growth(accel_, defensive_, config_.solver.seed); }
    /// Share of the measured areas that are flagged (see Trust), 0..1.
    double flagged() const;
    /// What an estimator makes of the areas of interest that a camera sees, in ascending order of sides or pixels: of all, or where these
    /// are more than `most` of every so manieth.
    std::vector<MeasuredArea> measured(uint32_t camera, const Estimator& estimator, uint32_t most) const;
    const Film& film(uint32_t camera) const { return films_[camera]; }
    /// Ask an eye pass that runs on another thread to stop.
    void stop() { stop_ = true; }

private:
    Scene scene_;
    Accel accel_;
    Lattice lattice_;
    DefensiveStarts defensive_;
    std::vector<Camera> cameras_;
    SessionConfig config_;
    std::optional<Solver> solver_;
    std::optional<Reconstruction> reconstruction_;
    std::vector<PixelRadiance> pixels_;  // per camera, where pixels are measured
    std::vector<Film> films_;
    std::atomic<bool> stop_ = false;
};

}  // namespace lumel
