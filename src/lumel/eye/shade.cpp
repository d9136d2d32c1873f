#include "lumel/eye/shade.h"

#include "lumel/sampling/warp.h"

namespace lumel {

namespace {

constexpr int kMirrors = 64;

}  // namespace

EyeShader::Meeting EyeShader::meet(Ray& ray, const Hit& first, EyeStream& stream) const {
    Meeting m;
    m.hit = first;
    for (; m.mirrors < kMirrors; ++m.mirrors) {
        m.surface.reset();
        if (m.mirrors > 0) m.hit = accel_.intersect(ray);
        if (m.hit.is_miss()) return m;
        const Surface& x = m.surface.emplace(scene_, m.hit.point(), m.hit.back);
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
        if (!(cos > 0) || !(dot(out, x.normal) > 0)) break;
        m.throughput *= x.material->mirror_reflectance(cos);
        const float survive = m.mirrors < 4 ? 1.0f : std::min(1.0f, max_component(m.throughput));
        if (!(survive > 0) || (survive < 1 && stream.next_one() >= survive)) break;
        m.throughput *= 1 / survive;
        ray = {x.off(scene_.epsilon()), out};
    }
    m.surface.reset();
    return m;
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

LampLight EyeShader::lamp_along(const Surface& x, Vec3 wo, const Ray& ray, const Hit& hit, Rgb scatter, float pdf_w) const {
    if (hit.is_miss() || hit.back) return {};
    const Vec3 y = scene_.position(hit.point());
    float share = 1;
    if (direct_light_) {
        const float sampled = LampView(scene_, x, &wo).pdf_w(hit.triangle, ray.direction, length(y - ray.origin));
        share = pdf_w / (pdf_w + sampled);
    }
    return {ray.origin, y + scene_.geometric_normal(hit.triangle) * scene_.epsilon(), scatter * scene_.emission(hit.triangle) * share};
}

Vec3 EyeShader::draw_diffuse(const Surface& x, EyeStream& stream, std::optional<BrightPatches::Target>& target) const {
    target = reconstruction_.bright_patches().draw(stream);
    return target ? normalize(target->x - x.x) : Frame(x.shading).to_world(square_to_cosine_hemisphere(stream.next()));
}

std::optional<Surface> EyeShader::draw_source(const Surface& x, const Lattice::Stencil& at, bool back, EyeStream& stream) const {
    const Square choice = stream.next();
    const std::optional<SurfacePoint> source = reconstruction_.draw_source(at, choice, stream.next());
    if (!source) return {};
    const Surface y(scene_, *source, back);
    return dot(x.shading, y.shading) > 0 ? std::optional(y) : std::nullopt;
}

}  // namespace lumel
