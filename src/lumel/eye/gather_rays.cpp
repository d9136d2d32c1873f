#include "lumel/eye/gather_rays.h"

namespace lumel {

namespace {

constexpr uint32_t kLobes = 32;
constexpr int kSources = 4;  // points of patches that are tried: some are under a box
constexpr float kNear = 2;   // patches: what is closer may make the reconstruction be off
constexpr float kClose = 0.5f;  // patches: what is closer has light that may be off itself
constexpr uint64_t kOtherSource = ~uint64_t{0};

/// Where the second ray of a pair goes if the first one goes along `wi`.
Vec3 way_of_other(const GatherTask& task, Vec3 wi, const Surface& x, const Surface& y) {
    return task.target ? normalize(task.target->x - y.x) : turned(wi, x.shading, y.shading);
}

}  // namespace

void GatherRays::push(const Ray& ray, const Waiting& waiting) {
    filling().rays.push(ray.origin, ray.direction);
    filling().tasks.push_back(waiting);
}

void GatherRays::push_above(const Surface& x, Vec3 wi, const Waiting& waiting) {
    push({x.off(scene_.epsilon()), wi}, waiting);
    float& pdf_w = filling().tasks.back().task.pdf_w;
    pdf_w = EyeShader::pdf_cosine(x, wi);
    RayBlock& rays = filling().rays;
    if (!(dot(x.normal, wi) > 0) || !(pdf_w > 0)) rays.traced[rays.size - 1] = 0;
}

void GatherRays::add_pair(const Surface& x, const Hit& hit, const Lattice::Stencil& at, Vec3 wi, Rgb known, const GatherTask& task) {
    EyeStream stream(key(task.stream, kOtherSource), task.number);
    const std::optional<Surface> y = shader_.draw_source(x, at, hit.back, stream);
    if (!y) return;
    make_room(2);
    push_above(x, wi, {task, 0, hit, known});
    push_above(*y, way_of_other(task, wi, x, *y), {task});
}

void GatherRays::finish() {
    while (filling().rays.size > 0) trace();
}

void GatherRays::trace() {
    Block& block = filling();
    filling_ = 1 - filling_;
    HitBlock hits;
    shader_.accel().intersect(block.rays, hits);
    for (uint32_t i = 0; i < block.rays.size; ++i) {
        const Waiting& waiting = block.tasks[i];
        if (!waiting.from.is_miss())
            use_pair(block, i++, hits);
        else if (use(waiting, block.rays[i], hits[i]) && waiting.step == 0 && waiting.task.layer == Layer::kExcessSpecular)
            pass_[waiting.task.pixel].excess.near_specular += near_of(waiting.task);
    }
    block.rays.size = 0;
    block.tasks.clear();
}

float GatherRays::near_of(const GatherTask& task) const {
    return task.target ? 0.0f : 1 / (1 - shader_.reconstruction().bright_patches().share());
}

bool GatherRays::is_covered(const Hit& hit) const {
    return !hit.is_miss() && !(scene_.open_share(scene_.side_of(hit.point(), hit.back)) > 0);
}

void GatherRays::use_pair(const Block& block, uint32_t first, const HitBlock& hits) {
    const Waiting& here = block.tasks[first];
    Waiting there = block.tasks[first + 1];
    Ray other = block.rays[first + 1];
    Hit met = hits[first + 1];
    if (scene_.has_covers() && is_covered(met)) {
        const Surface x(scene_, here.from.point(), here.from.back);
        const Lattice::Stencil at = shader_.reconstruction().stencil(here.from.point(), here.from.back);
        EyeStream stream(key(here.task.stream, kOtherSource), here.task.number);
        stream.next(), stream.next();  // of the source that is covered
        for (int source = 1; source < kSources && is_covered(met); ++source) {
            const std::optional<Surface> y = shader_.draw_source(x, at, here.from.back, stream);
            if (!y) return;
            other = {y->off(scene_.epsilon()), way_of_other(here.task, block.rays.direction[first], x, *y)};
            there.task.pdf_w = EyeShader::pdf_cosine(*y, other.direction);
            met = dot(y->normal, other.direction) > 0 && there.task.pdf_w > 0 ? shader_.accel().intersect(other) : Hit{};
        }
        if (is_covered(met)) return;
    }
    there.task.layer = Layer::kThere;
    pass_[here.task.pixel].pairs.known += here.known;
    const bool near = use(here, block.rays[first], hits[first]), other_near = use(there, other, met);
    if (near || other_near) pass_[here.task.pixel].excess.near_diffuse += near_of(here.task);
}

bool GatherRays::use(const Waiting& waiting, Ray ray, const Hit& first) {
    if (first.is_miss()) return false;
    const GatherTask& task = waiting.task;
    const Reconstruction& reconstruction = shader_.reconstruction();
    const float weight = task.pdf_w > 0 ? reconstruction.bright_patches().weight(task.pdf_w, task.target, ray.origin, first) : 1.0f;
    if (!(weight > 0)) return false;
    EyeStream stream(task.stream, task.number);
    Rgb& sum = pass_[task.pixel][task.layer];
    const EyeShader::Meeting m = shader_.meet(ray, first, stream);
    sum += task.throughput * weight * m.mirrored_emission;
    if (!m.surface || !m.surface->scatters) return false;
    const Surface& x = *m.surface;
    const Rgb throughput = task.throughput * weight * m.throughput;
    const Vec3 way = x.x - ray.origin, wo = -ray.direction;
    const Lattice::Stencil at = reconstruction.stencil(m.hit.point(), m.hit.back);
    const bool near = dot(way, way) < sqr(kNear) * std::max(scene_.patch_area(at.patch), sqr(task.size * task.stretch));
    const bool is_glossy = x.material->is_glossy(), follows = waiting.step + 1 < kLobes,
               is_close = follows && shader_.direct_light() &&
                          dot(way, way) < sqr(kClose) * std::max(scene_.patch_area(at.patch), sqr(task.size)),
               is_source = task.layer == Layer::kThere && waiting.step == 0;
    // The light that is known was sent from all of a patch alike, however close: to go on here would take away less than was added there.
    if (!is_glossy && ((task.coarse && !near) || (is_source && is_close))) {
        sum += throughput * x.material->diffuse * reconstruction.total_irradiance(at) * kInvPi;
        return near;
    }
    if (shader_.direct_light()) shadows_.add(task.pixel, task.layer, shader_.lamps(x, wo, stream), throughput);
    if (!is_close) sum += throughput * x.material->diffuse * reconstruction.irradiance(at).value * kInvPi;
    // One ray leads to one more at the most, where both could follow to either.
    const bool either = is_close && is_glossy;
    const Rgb onward = either ? throughput * 2 : throughput;
    if (is_close && !(either && stream.next_one() < 0.5f))
        follow_diffuse(waiting, x, onward, std::sqrt(scene_.patch_area(at.patch)), stream);
    else if (follows && is_glossy)
        follow_lobe(waiting, x, wo, onward, stream);
    return near;
}

void GatherRays::follow_diffuse(const Waiting& waiting, const Surface& x, Rgb throughput, float size, EyeStream& stream) {
    const float survive = std::min(1.0f, max_component(x.material->diffuse));
    if (!(stream.next_one() < survive)) return;
    Waiting next{waiting.task, waiting.step + 1};
    const Vec3 wi = shader_.draw_diffuse(x, stream, next.task.target);
    next.task.pdf_w = EyeShader::pdf_cosine(x, wi);
    if (!(next.task.pdf_w > 0) || !(dot(x.normal, wi) > 0)) return;
    next.task.throughput = throughput * x.material->diffuse * (1 / survive);
    next.task.stream = key(waiting.task.stream, next.step);
    next.task.coarse = true, next.task.size = size, next.task.stretch = 1;
    push({x.off(scene_.epsilon()), wi}, next);
}

void GatherRays::follow_lobe(const Waiting& waiting, const Surface& x, Vec3 wo, Rgb throughput, EyeStream& stream) {
    // Follow one sample of the specular lobe, or one to a bright patch instead; roulette ends it by its albedo.
    LobeDraw draw(x.shading, wo, x.material->alpha, stream.next());
    const float survives = stream.next_one();
    Waiting next{waiting.task, waiting.step + 1};
    next.task.stream = key(waiting.task.stream, next.step);
    // Only once: the weights of rays that are not sent multiply along a chain of lobes.
    const bool may_be_sent = waiting.step == 0;
    next.task.target = may_be_sent ? shader_.reconstruction().bright_patches().draw(stream) : std::nullopt;
    const auto leads = [&] { return draw.pdf_w > 0 && dot(x.normal, draw.wi) > 0; };
    // The throughput of the lobe if it goes on along the draw.
    const auto onward = [&] {
        const Rgb scatter = draw.scatter(*x.material);
        const float survive = std::min(1.0f, max_component(scatter));
        return survives < survive ? throughput * scatter * (1 / survive) : Rgb{};
    };
    if (leads()) {
        // A lamp that it meets at once could have been sampled from x as well.
        next.task.throughput = onward();
        const Ray ray{x.off(scene_.epsilon()), draw.wi};
        if (max_component(next.task.throughput) > 0) {
            const LampLight light = shader_.lamp_along(x, wo, ray, shader_.accel().intersect_lamps(ray), {1, 1, 1}, draw.pdf_w);
            shadows_.add(next.task.pixel, next.task.layer, light, next.task.throughput);
        }
    }
    if (next.task.target) draw = LobeDraw::along(normalize(next.task.target->x - x.x), x.shading, wo, x.material->alpha);
    if (!leads()) return;
    next.task.throughput = onward(), next.task.pdf_w = may_be_sent ? draw.pdf_w : 0;
    if (max_component(next.task.throughput) > 0) push({x.off(scene_.epsilon()), draw.wi}, next);
}

}  // namespace lumel
