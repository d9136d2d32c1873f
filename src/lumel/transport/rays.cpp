#include "lumel/transport/rays.h"

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kLamps = 21, kShoot, kScatter, kMerge };

}  // namespace

FrozenLight::FrozenLight(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const WalkConfig& config,
                         uint64_t& rays)
    : emitters_(light.emitters()), next_(accel.scene()) {
    uint64_t generation = 0;
    rays += walk(accel, defensive, emitters_, config, [&](const Generation& g) {
        for (size_t side = 0; side < emitters_.diffuse.size(); ++side) emitters_.diffuse[side] += g.next.diffuse[side];
        for (size_t part = 0; part < emitters_.of_part.size(); ++part) emitters_.of_part[part] += g.next.of_part[part];
        merge_records(accel.scene(), g.next, key(config.stream, kMerge, generation++), emitters_);
    });
}

uint64_t FrozenLight::step(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const ShootConfig& config,
                           const Sink& sink) {
    // Lamps are drawn anew for as many glossy sides as cost no more than a thirty-second of the rays.
    const auto parts = static_cast<uint32_t>(1 + uint64_t{accel.scene().glossy_sides()} / 2 * kLampRecords * 32 / (config.rays + 1));
    light.refresh(key(config.stream, kLamps), emitters_, steps_++ % parts, parts);
    const Shot shot(accel, emitters_, defensive, {config.rays, config.defensive, key(config.stream, kShoot)});
    shoot(shot, transfers_);
    scatter(accel.scene(), transfers_, key(config.stream, kScatter), received_, next_);
    sink({transfers_, shot, received_, next_});

    // The records of this step are the next one's; its diffuse flux has been measured and is not fed back.
    const Scene& scene = accel.scene();
    for (uint32_t side = 0; side < scene.sides(); ++side) {
        const auto received = next_.records_of(scene, side);
        if (received.empty() && emitters_.records_of(scene, side).empty()) continue;
        const auto records = emitters_.open_records(scene, side).subspan(kLampRecords);
        if (received.empty())
            std::fill(records.begin(), records.end(), Record{});
        else
            std::copy(received.begin() + kLampRecords, received.end(), records.begin());
    }
    return transfers_.shot;
}

}  // namespace lumel
