#include "lumel/transport/walk.h"

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kShoot = 12, kScatter, kRoulette };

constexpr double kMostReflected = 0.999;  // of the light, by all surfaces together: a walk must end

double total_power(const Scene& scene, const Emitters& emitters) {
    double power = 0;
    for (uint32_t side = 0; side < scene.sides(); ++side) power += emitters.power(scene, side);
    if (emitters.point_lamps)
        for (const PointLamp& lamp : scene.point_lamps()) power += 4 * kPi * lum(lamp.intensity);
    return power;
}

/// The largest share of light that any surface reflects, 0..1.
double most_reflected(const Scene& scene) {
    double most = 0;
    for (const Material& m : scene.materials()) most = std::max(most, double{m.max_albedo()});
    return std::min(most, kMostReflected);
}

}  // namespace

uint64_t walk(const Accel& accel, const DefensiveStarts& defensive, Emitters emitters, const WalkConfig& config, const Sink& sink) {
    const Scene& scene = accel.scene();
    const double fewest = std::max(64.0, static_cast<double>(config.rays) / 1024);
    Emitters next(scene);
    Transfers transfers;
    std::vector<Rgb> received;
    uint64_t shot = 0;
    double power = total_power(scene, emitters);
    const double first_power = power;
    const double reflected = most_reflected(scene);

    for (uint64_t generation = 0;; ++generation) {
        // Spend rays in proportion to the power that is left; below a minimum, roulette decides on the whole generation.
        if (!(power > 0)) return shot;
        double rays = static_cast<double>(config.rays) * power / first_power;
        if (rays < fewest) {
            const double survive = rays / fewest;
            if (to_unit(static_cast<uint32_t>(key(config.stream, kRoulette, generation) >> 32)) >= survive) return shot;
            emitters.scale(static_cast<float>(1 / survive));
            rays = fewest, power /= survive;
        }
        const auto count = static_cast<uint64_t>(rays);
        const Shot step(accel, emitters, defensive, {count, config.defensive, key(config.stream, kShoot, generation)});
        shoot(step, transfers);
        scatter(scene, transfers, key(config.stream, kScatter, generation), received, next);
        shot += transfers.shot;
        // Light that grew was sent by what is known badly, such as how little of a patch is open.
        double sent = total_power(scene, next);
        if (sent > power) next.scale(static_cast<float>(reflected * power / sent)), sent = reflected * power;
        power = sent;
        sink({transfers, step, received, next});
        std::swap(emitters, next);
        next.behind_mirror.clear();
        next.homogeneous = {};
        next.point_lamps = false;
    }
}

}  // namespace lumel
