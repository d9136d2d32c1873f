#include "lumel/eye/eye_rays.h"

namespace lumel {

namespace {

enum Kind : uint64_t { kDiffuse, kSpecular, kUnknownDiffuse, kUnknownSpecular };
constexpr float kUnknown = 0.3f;    // standard errors of the irradiance over it, above which a ray tells more
constexpr float kRoundLobe = 0.5f;  // roughness of a lobe that is about as wide as a diffuse one

}  // namespace

void EyeRays::add(uint32_t pixel, uint64_t stream, uint32_t index, Gather gather) {
    samples_.push_back({pixel, index, stream, gather});
    if (samples_.size() == RayBlock::kMost) look();
}

void EyeRays::finish() {
    look();
    follow_lobes();
    gathers_.finish();
    shadows_.cast();
}

void EyeRays::aim() {
    alignas(32) std::array<float, RayBlock::kRoom> column, row;
    alignas(32) std::array<uint32_t, RayBlock::kRoom> index, lo, hi;
    const auto count = static_cast<uint32_t>(samples_.size());
    const Camera camera = eye_.camera;
    for (uint32_t i = 0; i < count; ++i) {
        const Sample& sample = samples_[i];
        const uint32_t x = sample.pixel % camera.width, y = sample.pixel / camera.width;
        column[i] = static_cast<float>(x), row[i] = static_cast<float>(y);
        index[i] = sample.index;
        lo[i] = static_cast<uint32_t>(sample.stream), hi[i] = static_cast<uint32_t>(sample.stream >> 32);
    }
    for (uint32_t i = 0; i < count; ++i)
        rays_.direction.set(i, camera.direction(camera.on_film(column[i], row[i], sobol2d(index[i], lo[i], hi[i]))));
    for (uint32_t i = 0; i < count; ++i) rays_.origin.set(i, camera.origin), rays_.traced[i] = -1;
    rays_.size = count;
}

void EyeRays::look() {
    aim();
    HitBlock hits;
    shader_.accel().intersect(rays_, hits, Coherence::kRays);
    for (uint32_t i = 0; i < rays_.size; ++i) see(samples_[i], rays_[i], hits[i]);
    rays_.size = 0;
    samples_.clear();
}

void EyeRays::see(const Sample& sample, Ray ray, const Hit& hit) {
    PixelPass& pixel = pass_[sample.pixel];
    EyeStream stream(sample.stream, sample.index);
    const EyeShader::Meeting m = shader_.meet(ray, hit, stream);
    ++pixel.samples, pixel.diffuse += sample.gather.diffuse, pixel.specular += sample.gather.specular;
    pixel.sum.depth += m.distance;
    const bool is_small = !hit.is_miss() && eye_.small_lamps.has(hit.triangle);
    pixel.sum.emission += (is_small ? Rgb{} : m.emission) + m.mirrored_emission;
    if (!m.surface) return;
    const Surface& x = *m.surface;
    pixel.sum.normal += x.shading;
    if (!x.scatters) return;

    const Lattice::Stencil at = shader_.reconstruction().stencil(m.hit.point(), m.hit.back);
    const View view{sample, m, x, -ray.direction, at, std::sqrt(scene_.patch_area(at.patch))};
    if (shader_.direct_light()) shadows_.add(sample.pixel, Layer::kDirect, shader_.lamps(x, view.wo, stream), m.throughput);
    see_diffuse(view, stream);
    const float cos = dot(x.shading, view.wo);
    const bool is_glossy = x.material->is_glossy() && cos > 0;
    pixel.sum.albedo += m.throughput * (x.material->diffuse + (is_glossy ? x.material->albedo_s(cos) : Rgb{}));
    if (is_glossy) see_gloss(view, stream);
}

void EyeRays::see_diffuse(const View& view, EyeStream& stream) {
    const Gather& gather = view.sample.gather;
    const Surface& x = view.x;
    if (!(max_component(x.material->diffuse) > 0)) return;
    PixelPass& pixel = pass_[view.sample.pixel];
    const Rgb throughput = view.met.throughput * x.material->diffuse;
    const Reconstructed irradiance = shader_.reconstruction().irradiance(view.at);
    GatherTask task{view.sample.pixel, Layer::kIndirectDiffuse, throughput, true, view.size, view.sample.stream, view.sample.index};
    if (gather.is_allowed && !(lum(irradiance.stderr_) < kUnknown * lum(irradiance.value))) {
        task.stream = key(task.stream, kUnknownDiffuse);
        const Vec3 wi = shader_.draw_diffuse(x, stream, task.target);
        task.pdf_w = EyeShader::pdf_cosine(x, wi);
        if (dot(x.normal, wi) > 0 && task.pdf_w > 0) gathers_.add({x.off(scene_.epsilon()), wi}, task);
        return;
    }
    pixel.sum.indirect_diffuse += throughput * irradiance.value * kInvPi;
    pixel.sum.solution_stderr += throughput * irradiance.stderr_ * kInvPi;
    if (!gather.diffuse) return;
    task.layer = Layer::kHere, task.stream = key(task.stream, kDiffuse), task.number = gather.before_diffuse;
    EyeStream of_some = stream.of_some(kDiffuse, gather.before_diffuse);
    const Vec3 wi = shader_.draw_diffuse(x, of_some, task.target);
    gathers_.add_pair(x, view.met.hit, view.at, wi, throughput * irradiance.value * kInvPi, task);
}

void EyeRays::see_gloss(const View& view, EyeStream& stream) {
    // The estimator knows the specular light towards the eye itself; where it was not measured, and what a mirror shows of a glossy
    // surface, is gathered.
    const Gather& gather = view.sample.gather;
    const Rgb throughput = view.met.throughput;
    PixelPass& pixel = pass_[view.sample.pixel];
    const bool is_first = view.met.mirrors == 0;
    std::optional<Reconstructed> specular;
    if (is_first && !eye_.pixels) specular = shader_.reconstruction().specular(eye_.number, view.at);
    const bool is_measured = specular || (is_first && eye_.pixels);
    if (specular) {
        pixel.sum.indirect_specular += throughput * specular->value;
        pixel.sum.solution_stderr += throughput * specular->stderr_;
        pixel.sum.specular_stderr += throughput * specular->stderr_;
        pixel.sum.trust += specular->trust;
        if (gather.specular) pixel.excess.specular += throughput * specular->value * -1;
    }
    if (is_measured && pixel.material == PixelPass::kNoMaterial) pixel.material = scene_.material_index(view.met.hit.triangle);

    const bool direct = shader_.direct_light() && !scene_.area_lamps().empty(),
               gathers = !is_measured || (gather.specular && gather.every_lobe);
    GatherTask task{view.sample.pixel, is_measured ? Layer::kExcessSpecular : Layer::kIndirectSpecular,
                    throughput,        false,
                    view.size,         key(view.sample.stream, kUnknownSpecular),
                    view.sample.index, std::max(1.0f, kRoundLobe / view.x.material->alpha)};
    const BrightPatches& bright = shader_.reconstruction().bright_patches();
    if (gathers) task.target = bright.draw(stream);
    if (direct || gathers) push_lobe(view, stream.next(), {view.x, task, direct ? Layer::kDirect : task.layer, true, gathers});
    if (!gather.specular || gathers) return;
    task.stream = key(view.sample.stream, kSpecular), task.number = gather.before_specular;
    EyeStream of_some = stream.of_some(kSpecular, gather.before_specular);
    task.target = bright.draw(of_some);
    push_lobe(view, of_some.next(), {view.x, task, task.layer, !direct, true});
}

void EyeRays::push_lobe(const View& view, Square s, const Lobe& lobe) {
    draws_.push(view.x.shading, view.wo, view.x.material->alpha, s);
    lobes_.push_back(lobe);
    if (draws_.is_full()) follow_lobes();
}

void EyeRays::follow_lobes() {
    draws_.draw();
    lobe_rays_.size = 0;
    for (uint32_t i = 0; i < draws_.size; ++i) {
        const Lobe& lobe = lobes_[i];
        lobe_rays_.push(lobe.x.off(scene_.epsilon()), draws_.wi[i]);
        const bool leads = draws_.pdf_w[i] > 0 && dot(lobe.x.normal, draws_.wi[i]) > 0;
        if (!leads) draws_.pdf_w[i] = 0;
        if (!leads || !lobe.to_lamps) lobe_rays_.traced[i] = 0;
    }
    HitBlock lamps;
    shader_.accel().intersect_lamps(lobe_rays_, lamps);
    for (uint32_t i = 0; i < draws_.size; ++i) {
        const Lobe& lobe = lobes_[i];
        const LobeDraw draw = draws_[i];
        const Hit lamp = lamps[i];
        const bool sent = lobe.gathers && lobe.task.target;
        if (sent) send_lobe(lobe, draws_.wo[i]);
        if (!(draw.pdf_w > 0) || (lamp.is_miss() && (sent || !lobe.gathers))) continue;
        const Rgb scatter = draw.scatter(*lobe.x.material);
        const Ray ray = lobe_rays_[i];
        GatherTask task = lobe.task;
        if (!lamp.is_miss())
            shadows_.add(task.pixel, lobe.lamps, shader_.lamp_along(lobe.x, draws_.wo[i], ray, lamp, scatter, draw.pdf_w), task.throughput);
        task.throughput *= scatter, task.pdf_w = draw.pdf_w;
        if (lobe.gathers && !sent) gathers_.add(ray, task);
    }
    draws_.size = 0;
    lobes_.clear();
}

void EyeRays::send_lobe(const Lobe& lobe, Vec3 wo) {
    const Surface& x = lobe.x;
    const Vec3 wi = normalize(lobe.task.target->x - x.x);
    const LobeDraw along = LobeDraw::along(wi, x.shading, wo, x.material->alpha);
    if (!(along.pdf_w > 0) || !(dot(x.normal, wi) > 0)) return;
    GatherTask task = lobe.task;
    task.throughput *= along.scatter(*x.material), task.pdf_w = along.pdf_w;
    gathers_.add({x.off(scene_.epsilon()), wi}, task);
}

}  // namespace lumel
