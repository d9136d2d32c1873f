#include "lumel/eye/eye_rays.h"

namespace lumel {

namespace {

void push(RayBlock& block, Vec3 origin, Vec3 direction) {
    const uint32_t i = block.size++;
    block.origin.set(i, origin), block.direction.set(i, direction);
    block.traced[i] = -1;
}

}  // namespace

void EyeRays::add(uint32_t pixel, uint64_t stream, uint32_t index, Gather gather) {
    samples_.push_back({pixel, index, stream, gather});
    if (samples_.size() == RayBlock::kMost) look();
}

void EyeRays::finish() {
    look();
    cast_shadows();
}

void EyeRays::aim() {
    alignas(32) std::array<float, RayBlock::kRoom> column, row;
    alignas(32) std::array<uint32_t, RayBlock::kRoom> index, lo, hi;
    const auto count = static_cast<uint32_t>(samples_.size());
    for (uint32_t i = 0; i < count; ++i) {
        const Sample& sample = samples_[i];
        column[i] = static_cast<float>(sample.pixel % camera_.width), row[i] = static_cast<float>(sample.pixel / camera_.width);
        index[i] = sample.index;
        lo[i] = static_cast<uint32_t>(sample.stream), hi[i] = static_cast<uint32_t>(sample.stream >> 32);
    }
    const Camera camera = camera_;
    for (uint32_t i = 0; i < count; ++i)
        rays_.direction.set(i, camera.direction(camera.on_film(column[i], row[i], sobol2d(index[i], lo[i], hi[i]))));
    for (uint32_t i = 0; i < count; ++i) rays_.origin.set(i, camera_.origin), rays_.traced[i] = -1;
    rays_.size = count;
}

void EyeRays::look() {
    aim();
    HitBlock hits;
    accel_.intersect(rays_, hits, Coherence::kRays);
    for (uint32_t i = 0; i < rays_.size; ++i) {
        Sample& sample = samples_[i];
        PixelPass& pixel = pass_[sample.pixel];
        EyeStream stream(sample.stream, sample.index);
        const EyeShader::Seen seen = shader_.sample(rays_[i], hits[i], sample.gather, stream);
        pixel.sum += seen.sample;
        ++pixel.samples;
        pixel.excess += seen.excess;
        pixel.diffuse += sample.gather.diffuse, pixel.specular += sample.gather.specular;
        if (pixel.material == PixelPass::kNoMaterial) pixel.material = seen.material;
        light(sample.pixel, seen.lamps);
        light(sample.pixel, seen.lobe);
    }
    rays_.size = 0;
    samples_.clear();
}

void EyeRays::light(uint32_t pixel, const LampLight& light) {
    if (!light) return;
    push(shadows_, light.from, light.to - light.from);
    lights_.push_back({pixel, light.radiance});
    if (shadows_.size == RayBlock::kMost) cast_shadows();
}

void EyeRays::cast_shadows() {
    BlockedBlock blocked;
    accel_.occluded(shadows_, blocked);
    for (uint32_t i = 0; i < shadows_.size; ++i)
        if (!blocked[i]) pass_[lights_[i].pixel].sum.direct += lights_[i].radiance;
    shadows_.size = 0;
    lights_.clear();
}

}  // namespace lumel
