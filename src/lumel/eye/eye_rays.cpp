#include "lumel/eye/eye_rays.h"

namespace lumel {

namespace {

void push(RayBlock& block, Vec3 origin, Vec3 direction) {
    const uint32_t i = block.size++;
    block.origin.set(i, origin), block.direction.set(i, direction);
    block.traced[i] = -1;
}

}  // namespace

void EyeRays::add(uint32_t pixel, EyeStream stream, Gather gather) {
    const Square in_pixel = stream.next();
    push(rays_, camera_.origin, camera_.direction(camera_.on_film(pixel, in_pixel)));
    samples_.push_back({pixel, stream, gather});
    if (rays_.size == RayBlock::kMost) look();
}

void EyeRays::finish() {
    look();
    cast_shadows();
}

void EyeRays::look() {
    HitBlock hits;
    accel_.intersect(rays_, hits, Coherence::kRays);
    for (uint32_t i = 0; i < rays_.size; ++i) {
        Sample& sample = samples_[i];
        PixelPass& pixel = pass_[sample.pixel];
        const EyeShader::Seen seen = shader_.sample(rays_[i], hits[i], sample.gather, sample.stream);
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
