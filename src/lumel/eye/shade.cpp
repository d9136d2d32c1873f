#include "lumel/eye/shade.h"

#include "lumel/sampling/warp.h"

namespace lumel {

namespace {

constexpr int kMirrors = 64, kLobes = 32;
constexpr int kSources = 4;         // points of patches that are tried: some are under a box
enum Kind : uint64_t { kDiffuse, kSpecular };
constexpr float kNear = 2;          // patches: what is closer may make the reconstruction be off
constexpr float kUnknown = 0.3f;    // standard errors of the irradiance over it, above which a ray tells more
constexpr float kRoundLobe = 0.5f;  // roughness of a lobe that is about as wide as a diffuse one

/// A direction with density cos/pi around the shading normal.
Vec3 draw_cosine(const Surface& x, Square s) { return Frame(x.shading).to_world(square_to_cosine_hemisphere(s)); }

/// Draw the other direction of the specular lobe around `wo`; `scatter` is w_s / pdf_w.
struct LobeDraw {
    Vec3 wi;
    Rgb scatter;
    float pdf_w = 0;
};
LobeDraw draw_lobe(const Surface& x, Vec3 wo, Square s) {
    const Frame frame(x.shading);
    const Vec3 local_o = frame.to_local(wo);
    if (!(local_o.z > 0)) return {};
    const Vec3 local_i = ggx::sample(local_o, x.material->alpha, s), wi = frame.to_world(local_i);
    const float pdf_w = ggx::pdf_w(local_o, local_i, x.material->alpha);
    if (!(pdf_w > 0) || !(dot(x.normal, wi) > 0)) return {};
    // w_s / pdf_w = F G1(wi) times the tint.
    const Rgb fresnel = x.material->fresnel.any ? x.material->fresnel(0.5f * length(local_i + local_o)) : Rgb{1, 1, 1};
    return {wi, x.material->specular * fresnel * ggx::G1(local_i.z, x.material->alpha), pdf_w};
}

}  // namespace

EyeShader::Meeting EyeShader::meet(Ray& ray, const Hit& first, EyeStream& stream) const {
    Meeting m;
    for (; m.mirrors < kMirrors; ++m.mirrors) {
        m.hit = m.mirrors == 0 ? first : accel_.intersect(ray);
        if (m.hit.is_miss()) return m;
        const Surface x(scene_, m.hit.point(), m.hit.back);
        if (m.mirrors == 0) m.distance = length(x.x - ray.origin);
        const Rgb emitted = m.hit.back ? Rgb{} : scene_.emission(m.hit.triangle);
        (m.mirrors == 0 ? m.emission : m.mirrored_emission) += m.throughput * emitted;
        if (!x.material->is_mirror() || !x.scatters) return m;

        // Go on by the mirror, or stay with the rest of the surface.
        const float choice = x.material->mirror_choice();
        const bool mirrored = choice >= 1 || stream.next_one() < choice;
        m.throughput *= 1 / (mirrored ? choice : 1 - choice);
        if (!mirrored) return m;
        const Vec3 wo = -ray.direction;
        const float cos = dot(x.shading, wo);
        const Vec3 out = reflect(wo, x.shading);
        m.hit = {};
        if (!(cos > 0) || !(dot(out, x.normal) > 0)) return m;
        m.throughput *= x.material->mirror_reflectance(cos);
        const float survive = m.mirrors < 4 ? 1.0f : std::min(1.0f, max_component(m.throughput));
        if (!(survive > 0) || (survive < 1 && stream.next_one() >= survive)) return m;
        m.throughput *= 1 / survive;
        ray = {x.off(scene_.epsilon()), out};
    }
    m.hit = {};
    return m;
}

EyeShader::Seen EyeShader::sample(Ray ray, const Hit& first, Gather gather, EyeStream& stream) const {
    const Meeting m = meet(ray, first, stream);
    Seen seen;
    EyeSample& s = seen.sample;
    s.depth = m.distance;
    s.emission = (!first.is_miss() && small_lamps_.has(first.triangle) ? Rgb{} : m.emission) + m.mirrored_emission;
    if (m.hit.is_miss()) return seen;
    const SurfacePoint p = m.hit.point();
    const bool back = m.hit.back;
    const Surface x(scene_, p, back);
    const Vec3 wo = -ray.direction;
    s.normal = x.shading;
    if (!x.scatters) return seen;

    const float cos = dot(x.shading, wo);
    const bool glossy = x.material->is_glossy() && cos > 0;
    s.albedo = m.throughput * (x.material->diffuse + (glossy ? x.material->albedo_s(cos) : Rgb{}));
    if (direct_light_) seen.lamps = lamps(x, wo, stream);
    const float size = std::sqrt(scene_.patch_area(scene_.patch_of(p)));
    const bool is_matt = max_component(x.material->diffuse) > 0;
    const Reconstructed irradiance = reconstruction_.irradiance(p, back);
    const bool is_known = !gather.is_allowed || !is_matt || lum(irradiance.stderr_) < kUnknown * lum(irradiance.value);
    if (is_known) {
        s.indirect_diffuse = x.material->diffuse * irradiance.value * kInvPi;
        s.solution_stderr = x.material->diffuse * irradiance.stderr_ * kInvPi;
    } else {
        const Vec3 wi = draw_cosine(x, stream.next());
        s.indirect_diffuse = x.material->diffuse * gather_irradiance(x, wi, size, stream).radiance;
    }

    // The estimator knows the specular light towards the eye itself; where it was not measured, and what a mirror shows of a glossy
    // surface, is gathered.
    if (glossy) {
        const bool measured_in_pixel = pixels_ && m.mirrors == 0;
        std::optional<Reconstructed> specular;
        if (m.mirrors == 0 && !pixels_) specular = reconstruction_.specular(eye_, p, back);
        const bool measured = specular || measured_in_pixel;
        const float lobe_size = size * std::max(1.0f, kRoundLobe / x.material->alpha);
        if (direct_light_) seen.lobe = lobe(x, wo, stream);
        if (!measured) s.indirect_specular = gather_lobe(x, wo, lobe_size, stream).radiance;
        if (specular) {
            s.indirect_specular = specular->value;
            s.solution_stderr += specular->stderr_;
            s.specular_stderr = specular->stderr_;
            s.trust = specular->trust;
        }
        if (measured) seen.material = scene_.material_index(p.triangle);
        if (measured && gather.specular) {
            EyeStream of_some = stream.of_some(kSpecular, gather.before_specular);
            const Brought brought = gather_lobe(x, wo, lobe_size, of_some);
            seen.excess.specular = brought.radiance - s.indirect_specular;
            seen.excess.near_specular = brought.near ? 1.0f : 0.0f;
        }
    }
    if (gather.diffuse && is_matt && is_known) {
        EyeStream of_some = stream.of_some(kDiffuse, gather.before_diffuse);
        const Brought beyond = gather_beyond_patches(x, p, back, size, of_some);
        seen.excess.diffuse = x.material->diffuse * beyond.radiance;
        seen.excess.near_diffuse = beyond.near ? 1.0f : 0.0f;
    }
    for (Rgb* radiance : {&seen.lamps.radiance, &seen.lobe.radiance, &s.indirect_diffuse, &s.indirect_specular, &s.solution_stderr,
                          &s.specular_stderr, &seen.excess.diffuse, &seen.excess.specular})
        *radiance *= m.throughput;
    return seen;
}

LampLight EyeShader::lamps(const Surface& x, Vec3 wo, EyeStream& stream) const {
    const LampView view(scene_, x, &wo);
    const float choice = stream.next_one();
    const LampSample lamp = view.sample(choice, stream.next());
    const float cos = dot(x.shading, lamp.wi);
    if (!(lamp.pdf_w > 0) || !(cos > 0) || !(dot(x.normal, lamp.wi) > 0)) return {};
    Rgb scatter = x.material->diffuse * (kInvPi * cos);
    if (x.material->is_glossy()) {
        const Frame frame(x.shading);
        const Vec3 wi = frame.to_local(lamp.wi), local_o = frame.to_local(wo);
        const float other = lamp.is_point ? 0.0f : ggx::pdf_w(local_o, wi, x.material->alpha);
        scatter += x.material->scatter_s(wi, local_o) * (lamp.pdf_w / (lamp.pdf_w + other));
    }
    return {x.off(scene_.epsilon()), lamp.target, scatter * lamp.radiance * (1 / lamp.pdf_w)};
}

LampLight EyeShader::lamp_along(const Surface& x, Vec3 wo, const Ray& ray, Rgb scatter, float pdf_w) const {
    const Hit hit = accel_.intersect_lamps(ray);
    if (hit.is_miss() || hit.back) return {};
    const Vec3 y = scene_.position(hit.point());
    float share = 1;
    if (direct_light_) {
        const float sampled = LampView(scene_, x, &wo).pdf_w(hit.triangle, ray.direction, length(y - ray.origin));
        share = pdf_w / (pdf_w + sampled);
    }
    return {ray.origin, y + scene_.geometric_normal(hit.triangle) * scene_.epsilon(), scatter * scene_.emission(hit.triangle) * share};
}

LampLight EyeShader::lobe(const Surface& x, Vec3 wo, EyeStream& stream) const {
    if (scene_.area_lamps().empty()) return {};
    const LobeDraw draw = draw_lobe(x, wo, stream.next());
    if (!(draw.pdf_w > 0)) return {};
    return lamp_along(x, wo, {x.off(scene_.epsilon()), draw.wi}, draw.scatter, draw.pdf_w);
}

EyeShader::Brought EyeShader::gather_lobe(const Surface& x, Vec3 wo, float size, EyeStream& stream) const {
    const LobeDraw draw = draw_lobe(x, wo, stream.next());
    if (!(draw.pdf_w > 0)) return {};
    const Ray ray{x.off(scene_.epsilon()), draw.wi};
    Brought brought = gather(ray, draw.scatter, false, size, stream);
    if (!direct_light_)
        if (const LampLight light = lamp_along(x, wo, ray, draw.scatter, draw.pdf_w); is_lit(light)) brought.radiance += light.radiance;
    return brought;
}

EyeShader::Brought EyeShader::gather_irradiance(const Surface& x, Vec3 wi, float size, EyeStream& stream) const {
    if (!(dot(x.normal, wi) > 0)) return {};
    return gather({x.off(scene_.epsilon()), wi}, {1, 1, 1}, true, size, stream);
}

EyeShader::Brought EyeShader::gather_beyond_patches(const Surface& x, SurfacePoint p, bool back, float size, EyeStream& stream) const {
    const Vec3 wi = draw_cosine(x, stream.next());
    EyeStream same = stream;
    const Brought here = gather_irradiance(x, wi, size, stream);
    for (int attempt = 0; attempt < kSources; ++attempt) {
        const Square choice = stream.next();
        const std::optional<SurfacePoint> source = reconstruction_.draw_source(p, back, choice, stream.next());
        if (!source) break;
        const Surface y(scene_, *source, back);
        if (!(dot(x.shading, y.shading) > 0)) break;
        EyeStream numbers = same;
        const Brought there = gather_irradiance(y, turned(wi, x.shading, y.shading), size, numbers);
        if (!there.covered) return {here.radiance - there.radiance, here.near || there.near};
    }
    return {};
}

EyeShader::Brought EyeShader::gather(Ray ray, Rgb throughput, bool coarse, float size, EyeStream& stream) const {
    Brought brought;
    Rgb& sum = brought.radiance;
    for (int step = 0; step < kLobes; ++step) {
        const Meeting m = meet(ray, accel_.intersect(ray), stream);
        sum += throughput * m.mirrored_emission;
        if (m.hit.is_miss()) break;
        throughput *= m.throughput;
        const Surface x(scene_, m.hit.point(), m.hit.back);
        if (step == 0) brought.covered = !(scene_.open_share(scene_.side_of(m.hit.point(), m.hit.back)) > 0);
        if (!x.scatters) break;
        const Vec3 wo = -ray.direction;
        const Vec3 way = x.x - ray.origin;
        const float area = scene_.patch_area(scene_.patch_of(m.hit.point()));
        const bool near = dot(way, way) < sqr(kNear) * std::max(area, sqr(size));
        if (step == 0) brought.near = near;
        if (coarse && !near && !x.material->is_glossy()) {
            sum += throughput * x.material->diffuse * reconstruction_.total_irradiance(m.hit.point(), m.hit.back) * kInvPi;
            break;
        }
        sum += throughput * x.material->diffuse * reconstruction_.irradiance(m.hit.point(), m.hit.back).value * kInvPi;
        if (direct_light_)
            if (const LampLight light = lamps(x, wo, stream); is_lit(light)) sum += throughput * light.radiance;

        // Follow one sample of the specular lobe; roulette ends it by its albedo.
        if (!x.material->is_glossy()) break;
        const LobeDraw draw = draw_lobe(x, wo, stream.next());
        if (!(draw.pdf_w > 0)) break;
        const float survive = std::min(1.0f, max_component(draw.scatter));
        if (!(stream.next_one() < survive)) break;
        throughput *= draw.scatter * (1 / survive);
        ray = {x.off(scene_.epsilon()), draw.wi};

        // A lamp that it meets at once could have been sampled from x as well.
        if (const LampLight light = lamp_along(x, wo, ray, {1, 1, 1}, draw.pdf_w); is_lit(light)) sum += throughput * light.radiance;
    }
    return brought;
}

}  // namespace lumel
