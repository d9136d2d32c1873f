#include "lumel/transport/variance_growth.h"

#include <tbb/parallel_for.h>

#include <array>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"
#include "lumel/transport/emitters.h"

namespace lumel {

namespace {

constexpr uint32_t kWalks = 1u << 15;
constexpr int kFirst = 2, kSteps = 6;  // the growth is that from the first of these on, when the start is forgotten

Square square(Rng& rng) {
    const float u = rng.uniform();
    return {u, rng.uniform()};
}

/// The next direction to light, and 2 pi w^2 over its density.
struct Step {
    Vec3 wi;
    double growth = 0;
};
Step draw(const Surface& x, Vec3 wo, Rng& rng) {
    const Material& m = *x.material;
    const Frame frame(x.shading);
    const Vec3 local_o = frame.to_local(wo);
    const float diffuse = lum(m.diffuse), specular = m.is_glossy() && !is_sharp(m) && local_o.z > 0 ? lum(m.specular) : 0.0f;
    if (!x.scatters || !(diffuse + specular > 0)) return {};
    const float share = specular / (diffuse + specular);
    const Vec3 wi = rng.uniform() < share ? ggx::sample(local_o, m.alpha, square(rng)) : square_to_cosine_hemisphere(square(rng));
    if (!(wi.z > 0)) return {};
    const Rgb w = m.diffuse * (wi.z * kInvPi) + (specular > 0 ? m.scatter_s(wi, local_o) : Rgb{});
    const double pdf_w = double{share} * (specular > 0 ? double{ggx::pdf_w(local_o, wi, m.alpha)} : 0.0) +
                         (1 - double{share}) * double{wi.z * kInvPi};
    return {frame.to_world(wi), 2 * double{kPi} * double{sqr(lum(w))} / pdf_w};
}

/// Products of the growths of a walk up to each of its steps.
std::array<double, kSteps> products(const Accel& accel, const DefensiveStarts& reachable, Rng rng) {
    const Scene& scene = accel.scene();
    std::array<double, kSteps> product{};
    const uint32_t side = reachable.by_area.find(double{rng.uniform()} * reachable.by_area.total());
    Surface x(scene, scene.point_on_patch(scene.patch_of_side(side), square_to_triangle(square(rng))), scene.is_back(side));
    Vec3 wo = Frame(x.normal).to_world(square_to_cosine_hemisphere(square(rng)));
    double growth = 1;
    for (double& here : product) {
        const Step step = draw(x, wo, rng);
        if (!(step.growth > 0) || !(dot(x.normal, step.wi) > 0)) break;
        here = growth *= step.growth;
        const Hit hit = accel.intersect({x.off(scene.epsilon()), step.wi});
        if (hit.is_miss()) break;
        x = Surface(scene, hit.point(), hit.back);
        wo = -step.wi;
    }
    return product;
}

}  // namespace

double variance_growth(const Accel& accel, const DefensiveStarts& reachable, uint64_t stream) {
    if (!(reachable.by_area.total() > 0)) return 0;
    std::vector<std::array<double, kSteps>> walks(kWalks);
    tbb::parallel_for(uint32_t{0}, kWalks, [&](uint32_t walk) {
        const FlushDenormals flush;
        walks[walk] = products(accel, reachable, Rng(key(stream, walk)));
    });
    double first = 0, last = 0;
    for (const auto& product : walks) first += product[kFirst - 1], last += product[kSteps - 1];
    return first > 0 ? std::pow(last / first, 1.0 / (kSteps - kFirst)) : 0;
}

}  // namespace lumel
