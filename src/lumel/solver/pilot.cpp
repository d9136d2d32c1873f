#include "lumel/solver/pilot.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/lamp_sampler.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kDirect = 61, kBounce, kLook, kDiffuse, kGloss, kLamps };

constexpr uint64_t kBounces = 3;
constexpr uint32_t kBounceRays = 8;       // a side
constexpr double kFewestAbsorb = 0.1;     // of the light, at least so much is taken to be absorbed
constexpr uint32_t kLampSamples = 2;      // a point
constexpr float kInside = 0.06f;          // how far points are from the border of a cell, where rays would start in another wall
constexpr float kSharp = 0.03f;           // roughness below which patches do not measure gloss

double sum(const std::array<double, 3>& v) { return v[0] + v[1] + v[2]; }
double dot(const std::array<double, 3>& a, const std::array<double, 3>& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
std::array<double, 3> less_mean(std::array<double, 3> v) {
    const double mean = sum(v) / 3;
    for (double& x : v) x -= mean;
    return v;
}

template <class Body>
void for_each(size_t count, const Body& body) {
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, 256), [&](const auto& range) {
        const FlushDenormals flush;
        for (size_t i = range.begin(); i < range.end(); ++i) body(i);
    });
}

}  // namespace

Pilot::Pilot(const Accel& accel, const Lattice& lattice, const DefensiveStarts& reachable, std::span<const uint32_t> large, bool first_shot,
             uint64_t stream)
    : accel_(accel), scene_(accel.scene()), lattice_(lattice), first_shot_(first_shot), stream_(stream) {
    // What all sides send of the lamps' light, and the irradiance that would balance it in a closed scene.
    std::vector<double> albedo(scene_.sides()), source(scene_.sides());
    for_each(scene_.sides(), [&](size_t i) {
        const auto side = static_cast<uint32_t>(i);
        const Surface x(scene_, scene_.centre_of_patch(scene_.patch_of_side(side)), scene_.is_back(side));
        if (!first_shot && !scene_.is_back(side)) source[side] = double{kPi * lum(scene_.emission(scene_.triangle_of_side(side)))};
        if (!x.scatters || !(reachable.by_area.weight(side) > 0)) return;
        albedo[side] = double{lum(x.material->diffuse + x.material->specular)};
        if (first_shot) source[side] = albedo[side] * lamps(x, key(stream, kDirect, side));
    });
    double lit = 0, sent = 0, absorbed = 0;
    for (uint32_t side = 0; side < scene_.sides(); ++side) {
        const double area = reachable.by_area.weight(side);
        lit += area, sent += area * source[side], absorbed += area * (1 - albedo[side]);
    }
    const double ambient = sent / std::max(absorbed, kFewestAbsorb * lit);
    std::vector<double> radiosity(scene_.sides());
    for (uint32_t side = 0; side < scene_.sides(); ++side) radiosity[side] = source[side] + albedo[side] * ambient;
    pool(radiosity);

    // Gather a few times what large sides receive.
    for (uint64_t bounce = 0; bounce < kBounces; ++bounce) {
        for_each(large.size(), [&](size_t i) {
            const uint32_t side = large[i];
            const Surface x(scene_, scene_.centre_of_patch(scene_.patch_of_side(side)), scene_.is_back(side));
            radiosity[side] = source[side] + albedo[side] * irradiance(x, kBounceRays, key(stream, kBounce, bounce, side));
        });
        pool(radiosity);
    }
}

void Pilot::pool(std::span<const double> radiosity) {
    radiosity_.assign(size_t{lattice_.size()} * 2, 0);
    std::vector<double> area(radiosity_.size());
    for (uint32_t side = 0; side < scene_.sides(); ++side)
        for (uint32_t vertex : lattice_.corners(scene_.patch_of_side(side))) {
            const size_t at = vertex + (scene_.is_back(side) ? size_t{lattice_.size()} : 0);
            area[at] += double{scene_.side_area(side)};
            radiosity_[at] += radiosity[side] * double{scene_.side_area(side)};
        }
    for (size_t at = 0; at < area.size(); ++at) radiosity_[at] = area[at] > 0 ? radiosity_[at] / area[at] : 0;
}

Finding Pilot::look(uint32_t side, const Vec3* eye, const std::array<bool, 3>& border, uint32_t rays) const {
    const Half a = half(side, eye, rays, key(stream_, kLook, side, 0)), b = half(side, eye, rays, key(stream_, kLook, side, 1));
    Finding found{.light = (a.direct + b.direct) / 2, .spread = dot(less_mean(a.radiosity), less_mean(b.radiosity)) / 12};
    for (size_t k = 0; k < 6; ++k) found.light += (a.indirect[k] + b.indirect[k]) / 12;

    // With d_k what linear interpolation misses in the middle of the edges, it misses 4 sum d_k l_i l_j elsewhere (l: barycentric
    // coordinates), whose square has the mean 4/45 (sum d_k^2 + (sum d_k)^2).
    const auto along = [](const Half& h) {
        return std::array{h.indirect[3] - (h.indirect[0] + h.indirect[1]) / 2, h.indirect[4] - (h.indirect[1] + h.indirect[2]) / 2,
                          h.indirect[5] - (h.indirect[2] + h.indirect[0]) / 2};
    };
    found.bend = 4.0 / 45 * (dot(along(a), along(b)) + sum(along(a)) * sum(along(b)));

    // Vertices on a border have patches on one side alone, whose mean is 4/9 of a patch inside: with c the difference across the cell,
    // 4/9 c is missed along that edge and falls off linearly, which has the mean square 8/81 c^2.
    for (size_t k = 0; k < 3; ++k) {
        const auto across = [k](const Half& h) { return h.indirect[(k + 2) % 3] - (h.indirect[k] + h.indirect[(k + 1) % 3]) / 2; };
        if (border[k]) found.bend += 8.0 / 81 * across(a) * across(b);
    }
    return found;
}

Pilot::Half Pilot::half(uint32_t side, const Vec3* eye, uint32_t rays, uint64_t stream) const {
    constexpr std::array<Square, 6> kPoints{{{0, 0}, {1, 0}, {0, 1}, {0.5f, 0}, {0.5f, 0.5f}, {0, 0.5f}}};
    Half h{};
    for (size_t k = 0; k < 6; ++k) {
        const Square b{kPoints[k].u * (1 - kInside) + kInside / 3, kPoints[k].v * (1 - kInside) + kInside / 3};
        const Surface x(scene_, scene_.point_on_patch(scene_.patch_of_side(side), b), scene_.is_back(side));
        const double diffuse = double{lum(x.material->diffuse)}, all = diffuse + double{lum(x.material->specular)};
        const double arrived = irradiance(x, rays, key(stream, kDiffuse));
        h.indirect[k] = diffuse * arrived;
        if (eye && x.material->is_glossy() && x.material->alpha >= kSharp)
            h.indirect[k] += gloss(x, normalize(*eye - x.x), rays, key(stream, kGloss));
        if (k >= 3) continue;
        const double direct = first_shot_ ? lamps(x, key(stream, kLamps)) : 0;
        h.radiosity[k] = all * (arrived + direct);
        h.direct += diffuse * direct / 3;
    }
    return h;
}

double Pilot::irradiance(const Surface& x, uint32_t rays, uint64_t stream) const {
    const Frame frame(x.shading);
    const Vec3 start = x.off(scene_.epsilon());
    double all = 0;
    for (uint32_t i = 0; i < rays; ++i) {
        const Vec3 wi = frame.to_world(square_to_cosine_hemisphere(sobol2d(i, stream)));
        if (lumel::dot(x.normal, wi) > 0) all += radiosity({start, wi});
    }
    return all / rays;
}

double Pilot::gloss(const Surface& x, Vec3 wo, uint32_t rays, uint64_t stream) const {
    const Frame frame(x.shading);
    const Vec3 local = frame.to_local(wo), start = x.off(scene_.epsilon());
    if (!(local.z > 0)) return 0;
    double all = 0;
    for (uint32_t i = 0; i < rays; ++i) {
        const Vec3 local_i = ggx::sample(local, x.material->alpha, sobol2d(i, stream)), wi = frame.to_world(local_i);
        if (local_i.z > 0 && lumel::dot(x.normal, wi) > 0) all += double{ggx::G1(local_i.z, x.material->alpha)} * radiosity({start, wi});
    }
    return all * double{lum(x.material->specular)} / rays;
}

double Pilot::radiosity(const Ray& ray) const {
    const Hit hit = accel_.intersect(ray);
    if (hit.is_miss()) return 0;
    const Lattice::Stencil s = lattice_.stencil(hit.point(), hit.back);
    double all = 0;
    for (size_t k = 0; k < 3; ++k) all += double{s.weight[k]} * radiosity_[s.vertex[k] + (hit.back ? size_t{lattice_.size()} : 0)];
    return all;
}

double Pilot::lamps(const Surface& x, uint64_t stream) const {
    const LampView view(scene_, x);
    double all = 0;
    for (uint32_t i = 0; i < kLampSamples; ++i) {
        const LampSample lamp = view.sample(sobol2d(i, key(stream, 1)).u, sobol2d(i, key(stream, 2)));
        const float cos = lumel::dot(x.shading, lamp.wi);
        if (!(lamp.pdf_w > 0) || !(cos > 0) || !(lumel::dot(x.normal, lamp.wi) > 0)) continue;
        if (accel_.visible(x.off(scene_.epsilon()), lamp.target)) all += double{lum(lamp.radiance) * cos / lamp.pdf_w};
    }
    return all / kLampSamples;
}

}  // namespace lumel
