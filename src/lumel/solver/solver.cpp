#include "lumel/solver/solver.h"

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kFirstShot = 31, kSolve, kStep, kGather, kLamps };

}  // namespace

Solver::Solver(const Accel& accel, const DefensiveStarts& defensive, SolverConfig config, PatchAreas areas)
    : accel_(&accel),
      defensive_(&defensive),
      config_(config),
      areas_(std::move(areas)),
      direct_(accel.scene().sides()),
      indirect_(accel.scene().sides()) {
    stats_.landed.resize(accel.scene().shapes());
}

void Solver::begin_replica(uint64_t solve_rays) {
    light_ = std::make_unique<Illumination>(
        *accel_, *defensive_,
        IlluminationConfig{config_.first_shot, config_.direct_samples, config_.homogeneous, key(config_.seed, kFirstShot, replicas())});
    received_.assign(accel_->scene().sides(), {});
    weight_ = density_rays_ = 0;
    steps_ = generations_ = 0;
    frozen_.reset(), bundles_.reset();
    if (config_.transport == Transport::kRays) start_rays(solve_rays);
    if (config_.transport == Transport::kBundles) start_bundles(solve_rays);
}

void Solver::start_rays(uint64_t solve_rays) {
    const auto first = static_cast<uint64_t>(static_cast<double>(solve_rays) / reflections_) + 1;
    uint64_t rays = 0;
    // No measuring here, so no defensive part is needed.
    frozen_ = std::make_unique<FrozenLight>(*accel_, *defensive_, *light_, WalkConfig{first, 0.0f, key(config_.seed, kSolve, replicas())},
                                            rays);
    reflections_ = std::clamp(static_cast<double>(rays) / static_cast<double>(first), 1.0, 100.0);
    stats_.rays += rays;
}

void Solver::start_bundles(uint64_t solve_rays) {
    const auto first = static_cast<uint64_t>(static_cast<double>(solve_rays) / reflections_) + 1;
    const BundleConfig config{config_.window, first, key(config_.seed, kSolve, replicas())};
    if (config_.iteration == Iteration::kPlain) {
        bundles_ = std::make_unique<IteratedBundles>(*accel_, *defensive_, *light_, config);
    } else {
        bundles_ = std::make_unique<FrozenBundles>(*accel_, *defensive_, *light_, config);
        reflections_ = std::clamp(static_cast<double>(bundles_->rays()) / static_cast<double>(first), 1.0, 100.0);
    }
}

void Solver::step(uint64_t work) {
    const uint64_t stream = key(config_.seed, kStep, replicas(), steps_++);
    const auto weight = static_cast<double>(work);
    const Sink sink = [&](const Generation& generation) {
        // Steps of fewer rays (late generations of a walk) get fewer gathering rays.
        absorb(generation, weight, static_cast<double>(generation.transfers.rays) / kRaysOfGather);
    };
    switch (config_.transport) {
    case Transport::kWalk: {
        const auto first = static_cast<uint64_t>(weight / reflections_) + 1;
        Emitters emitters = light_->emitters();
        if (steps_ > 1) light_->refresh(key(stream, kLamps), emitters);
        const uint64_t shot = walk(*accel_, *defensive_, std::move(emitters), {first, config_.defensive, stream}, sink);
        reflections_ = std::clamp(static_cast<double>(shot) / static_cast<double>(first), 1.0, 100.0);
        stats_.rays += shot;
        weight_ += weight;
        break;
    }
    case Transport::kRays:
        stats_.rays += frozen_->step(*accel_, *defensive_, *light_, {work, config_.defensive, stream}, sink);
        weight_ += weight;
        break;
    case Transport::kBundles:
        bundles_->step(static_cast<uint32_t>(work), [&](const Generation& generation) {
            const auto directions = static_cast<double>(generation.bundles.size());
            absorb(generation, directions, directions / kBundlesOfGather);
            weight_ += directions;
        });
        break;
    }
}

std::vector<RayBlock> Solver::departures(uint64_t rays) const {
    return frozen_ ? frozen_->departures(*accel_, *defensive_, {rays, config_.defensive, key(config_.seed, kStep, replicas(), steps_)})
                   : std::vector<RayBlock>{};
}

void Solver::absorb(const Generation& generation, double weight, double full_steps) {
    for (size_t side = 0; side < received_.size(); ++side) received_[side] += to_double(generation.received[side]) * weight;
    const Step step{.transfers = generation.transfers,
                    .sight = generation.sight,
                    .bundles = generation.bundles,
                    .weight = weight,
                    .gather = double{config_.gather} * full_steps,
                    .stream = key(config_.seed, kGather, replicas(), generations_++)};
    areas_.measure(step);
    if (pixels_) pixels_->measure(step);
    if (irradiance_) irradiance_->measure(step);
    density_rays_ += step.samples();
    const Scene& scene = accel_->scene();
    for (uint32_t side = 0; side < scene.sides(); ++side)
        stats_.landed[scene.shape(scene.triangle_of_side(side))] += generation.arrivals(side);
    stats_.escaped += generation.transfers.escaped;
    stats_.lost_flux += generation.transfers.lost_flux * weight;
}

void Solver::end_replica() {
    stats_ = stats();
    bundles_.reset();
    if (steps_ == 0) return;
    const Scene& scene = accel_->scene();
    const auto& direct = light_->direct();
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        if (!direct.empty()) direct_.add(side, to_double(direct[side]));
        indirect_.add(side, received_[side] * (1.0 / (weight_ * double{scene.side_area(side)})));
    }
    areas_.close_replica(weight_, density_rays_);
    if (pixels_) pixels_->close_replica(weight_, density_rays_);
    if (irradiance_) irradiance_->close_replica(weight_, density_rays_);
    steps_ = 0;
    frozen_.reset();
    light_.reset();
}

void Solver::forget() {
    const Scene& scene = accel_->scene();
    areas_.forget();
    if (pixels_) pixels_->forget();
    if (irradiance_) irradiance_->forget();
    direct_ = SideMoments(scene.sides()), indirect_ = SideMoments(scene.sides());
    stats_ = {};
    stats_.landed.resize(scene.shapes());
    reflections_ = kReflections;
}

SolverStats Solver::stats() const {
    SolverStats all = stats_;
    if (bundles_) all.rays += bundles_->rays(), all.bundles += bundles_->stats();
    return all;
}

}  // namespace lumel
