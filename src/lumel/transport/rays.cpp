#include "lumel/transport/rays.h"

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kLamps = 21, kShoot, kScatter, kMerge };

}  // namespace

FrozenLight::FrozenLight(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const WalkConfig& config,
                         uint64_t& rays)
    : emitters_(light.emitters(key(config.stream, kLamps))), next_(accel.scene()) {
    uint64_t generation = 0;
    rays += walk(accel, defensive, light, config, [&](const Generation& g) {
        for (size_t side = 0; side < emitters_.diffuse.size(); ++side) emitters_.diffuse[side] += g.next.diffuse[side];
        merge_records(g.next, key(config.stream, kMerge, generation++), emitters_);
    });
}

uint64_t FrozenLight::step(const Accel& accel, const DefensiveStarts& defensive, const Illumination& light, const ShootConfig& config,
                           const Sink& sink) {
    light.refresh(key(config.stream, kLamps), emitters_);
    const Shot shot(accel, emitters_, defensive, {config.rays, config.defensive, key(config.stream, kShoot)});
    shoot(shot, transfers_);
    scatter(accel.scene(), transfers_, key(config.stream, kScatter), received_, next_);
    sink({transfers_, shot, received_, next_});

    // The records of this step are the next one's; its diffuse flux has been measured and is not fed back.
    for (size_t i = 0; i < next_.records.size(); ++i)
        if (i % kRecords >= kLampRecords) emitters_.records[i] = next_.records[i];
    return transfers_.all.size();
}

}  // namespace lumel
