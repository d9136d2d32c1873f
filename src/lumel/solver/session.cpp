#include "lumel/solver/session.h"

#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/solver/refine.h"
#include "lumel/transport/covers.h"
#include "lumel/transport/walls.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kSurvey = 41, kEye };

// Shares of defensive rays where none is given: what a lobe sees of the sky and of black surfaces is not covered without them.
constexpr float kDefensiveClosed = 0.3f, kDefensiveOpen = 0.5f;

std::vector<Vec3> eyes_of(const std::vector<Camera>& cameras) {
    std::vector<Vec3> eyes;
    eyes.reserve(cameras.size());
    for (const Camera& camera : cameras) eyes.push_back(camera.origin);
    return eyes;
}

/// The scene, divided anew where the light varies if that is wanted.
const Scene& refined(Scene& scene, const Accel& accel, std::span<const Camera> cameras, const SessionConfig& config) {
    if (config.adaptive_patches > 0) refine(scene, accel, cameras, config.adaptive_patches, config.solver.first_shot);
    return scene;
}

}  // namespace

Session::Session(Scene scene, std::vector<Camera> cameras, const SessionConfig& config)
    : scene_(std::move(scene)),
      accel_(scene_, config.isa),
      lattice_(refined(scene_, accel_, cameras, config)),
      defensive_(survey(accel_, key(config.solver.seed, kSurvey))),
      cameras_(std::move(cameras)),
      config_(config) {
    // Gathered samples and bundles cover all that a lobe can see, and `classical` asks for no cover.
    const bool is_classical = config_.estimator == find_estimator("classical"), is_auto = config_.estimator == find_estimator("auto");
    const bool covered = (config_.solver.gather > 0 || is_classical || transport() == Transport::kBundles) &&
                         !config_.weight_diffuse.value_or(false);
    if (config_.solver.defensive < 0) config_.solver.defensive = covered ? 0 : defensive_.open() ? kDefensiveOpen : kDefensiveClosed;
    scene_.set_covers(find_covers(accel_, defensive_));
    if (std::vector<PatchParts> parts = find_parts(accel_); !parts.empty()) scene_.set_parts(std::move(parts), walls_in_order(accel_));
    const bool in_pixels = config.areas == AreaKind::kPixels;
    PatchAreas patches(scene_, eyes_of(cameras_), in_pixels ? std::vector<uint32_t>{} : visible_glossy_sides(accel_, lattice_, cameras_));
    if (config_.most_gathering > 0) {
        const double measured = static_cast<double>(patches.measured()), most = double{config_.most_gathering} * kRaysOfGather;
        if (double{config_.solver.gather} * measured > most) config_.solver.gather = static_cast<float>(most / measured);
    }
    solver_.emplace(accel_, defensive_, config_.solver, std::move(patches));
    if (in_pixels) solver_->measure_pixels(PixelAreas(accel_, lattice_, cameras_));
    if (config_.weight_diffuse.value_or(is_auto && config_.solver.defensive > 0)) solver_->weigh_irradiance();
}

SideField Session::indirect() const {
    // Of fewer hits than these the coefficients of `auto` are noise, and its correction costs more than it brings.
    constexpr double kFewestHits = 24;
    const IrradianceAreas* weighed = solver_->irradiance();
    const bool pays = weighed && (config_.weight_diffuse.has_value() || weighed->mean_hits() >= kFewestHits);
    return pays ? weighed->field(*config_.estimator) : solver_->indirect();
}

void Session::reconstruct() {
    const SideField shot = indirect(), direct = solver_->direct();
    reconstruction_.emplace(accel_, lattice_, Solution{shot, direct, solver_->areas()}, *config_.estimator);
    pixels_.clear();
    for (uint32_t c = 0; solver_->pixels() && c < cameras_.size(); ++c)
        pixels_.push_back(estimate_pixels(*solver_->pixels(), c, *config_.estimator));
    films_.clear();
    for (const Camera& camera : cameras_) films_.emplace_back(camera.width, camera.height);
}

uint32_t Session::borrowed() const {
    uint32_t sum = reconstruction_->borrowed();
    for (const PixelRadiance& camera : pixels_) sum += camera.borrowed;
    return sum;
}

uint32_t Session::unfilled() const {
    uint32_t sum = reconstruction_->unfilled();
    for (const PixelRadiance& camera : pixels_) sum += camera.unfilled;
    return sum;
}

double Session::flagged() const {
    if (pixels_.empty()) return reconstruction_->flagged();
    double measured = 0, flagged = 0;
    for (const PixelRadiance& camera : pixels_) measured += camera.measured, flagged += camera.flagged;
    return measured > 0 ? flagged / measured : 0;
}

std::vector<MeasuredArea> Session::measured(uint32_t camera, const Estimator& estimator, uint32_t most) const {
    std::vector<MeasuredArea> all;
    const auto add = [&](uint32_t area, double albedo) {
        if (albedo > 0) all.push_back({area, albedo, {}});
    };
    const PixelAreas* pixels = solver_->pixels();
    const PatchAreas& areas = solver_->areas();
    if (pixels)
        for (uint32_t pixel = 0; pixel < cameras_[camera].width * cameras_[camera].height; ++pixel)
            add(pixel, pixels->albedo(camera, pixel));
    else
        for (uint32_t area = 0; area < areas.size(); ++area) add(area, areas.albedo(camera, area));

    const size_t stride = std::max<size_t>(1, (all.size() + most - 1) / std::max(1u, most));
    for (size_t i = 0; i * stride < all.size(); ++i) all[i] = all[i * stride];
    all.resize((all.size() + stride - 1) / stride);

    const Neighbourhood neighbourhood(scene_, lattice_, areas);
    tbb::parallel_for(size_t{0}, all.size(), [&](size_t i) {
        uint32_t& area = all[i].index;
        all[i].at = pixels ? estimate_pixel(*pixels, camera, area, estimator)
                           : estimate_pooled(areas, neighbourhood, camera, std::span(&area, 1), estimator);
        if (!pixels) area = areas.sides()[area];
    });
    return all;
}

bool Session::eye_pass(uint32_t camera, uint32_t samples) {
    Film& film = films_[camera];
    const bool first_shot = config_.solver.first_shot;
    const EyePassConfig pass{samples, first_shot, first_shot, config_.solver.gather > 0, key(config_.solver.seed, kEye, camera)};
    return lumel::eye_pass(accel_, cameras_[camera], camera, *reconstruction_, pixels(camera), pass, &stop_, film);
}

}  // namespace lumel
