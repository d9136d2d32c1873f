#include "lumel/transport/covers.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <optional>

#include "lumel/sampling/hash.h"
#include "lumel/sampling/warp.h"
#include "lumel/scene/surface.h"
#include "lumel/transport/sealed_bodies.h"

namespace lumel {

namespace {

constexpr uint32_t kFewPoints = 8, kManyPoints = Cover::kParts;  // of a side; many where some of the few are covered
constexpr uint32_t kRays = 8;                         // of a point that is looked at closely
constexpr float kLeastShare = 1.0f / 32;
constexpr float kStep = 0.2f;     // between open points of one part, of the edge
constexpr double kSmall = 0.25;   // of the mean patch: undivided triangles that are smaller are not asked whether something crosses them

/// Which faces no light can reach, 2 triangle + back; empty where there are none.
std::vector<uint8_t> sealed_faces(const Scene& scene, const DefensiveStarts& starts) {
    std::vector<uint8_t> sealed(size_t{scene.triangles()} * 2);
    for (uint32_t t = 0; t < scene.triangles(); ++t)
        for (uint32_t back : {0u, 1u}) sealed[size_t{t} * 2 + back] = starts.closed[t] != Scene::kNone && !starts.reaches(scene, t, back);
    return std::find(sealed.begin(), sealed.end(), 1) == sealed.end() ? std::vector<uint8_t>{} : sealed;
}

/// Looks from points of one side at what covers them. One ray tells, but where faces lie in each other it may meet the other one, so that
/// a few are needed to be sure.
class Probes {
public:
    Probes(const Accel& accel, const std::vector<uint8_t>& sealed, uint32_t side) : accel_(accel), sealed_(sealed), side_(side) {}

    bool any(uint32_t points, uint32_t rays) const {
        for (uint32_t i = 0; i < points; ++i)
            if (is_covered(point(i), i, rays)) return true;
        return false;
    }
    bool all(uint32_t points, uint32_t rays) const {
        for (uint32_t i = 0; i < points; ++i)
            if (!is_covered(point(i), i, rays)) return false;
        return true;
    }
    /// Does something stand on two of its edges, a wall too thin to cover anything? What stands on one leaves a way over the third corner,
    /// if that is not covered.
    bool is_crossed(const std::array<bool, 3>& is_covered = {}) const {
        std::array<Vec3, 3> corner;
        for (uint32_t k = 0; k < 3; ++k) corner[k] = surface(kCornersFromWithin[k]).off(accel_.scene().epsilon());
        int blocked = 0;
        int open = 3;
        for (uint32_t k = 0; k < 3; ++k) {
            const uint32_t next = (k + 1) % 3;
            open -= is_covered[k];
            blocked += !is_covered[k] && !is_covered[next] && !accel_.visible(corner[k], corner[next]);
        }
        return blocked >= std::max(1, open - 1);
    }
    /// Look closely, at the corners first. Where the covered part divides the rest, nobody knows which part has the light. Then all counts
    /// as open: light that is lost does less harm than light that goes through a wall.
    Cover look() const {
        std::array<Square, 3 + kManyPoints> where{};
        std::copy_n(kCornersFromWithin.begin(), 3, where.begin());
        std::array<bool, 3 + kManyPoints> covered{};
        Cover cover;
        uint32_t count = 0;
        for (uint32_t i = 0; i < where.size(); ++i) {
            if (i >= 3) where[i] = point_of_part(i - 3);
            covered[i] = is_covered(where[i], i, kRays);
            if (i < 3)
                cover.corner[i] = covered[i];
            else
                count += covered[i], cover.parts |= uint64_t{covered[i]} << (i - 3);
        }
        // What is covered may be too narrow for points to tell that it divides the rest.
        cover.divides = is_divided(where, covered) || is_crossed(cover.corner);
        if (cover.divides)
            cover.parts = 0;
        else
            cover.open_share = count == kManyPoints ? 0 : std::max(kLeastShare, 1 - static_cast<float>(count) / kManyPoints);
        return cover;
    }

private:
    /// Do short steps over open points lead from one open corner to all others?
    template <size_t n>
    static bool is_divided(const std::array<Square, n>& where, const std::array<bool, n>& covered) {
        const auto start = static_cast<uint32_t>(std::find(covered.begin(), covered.begin() + 3, false) - covered.begin());
        if (start == 3) return false;
        std::array<uint32_t, n> way{start};
        std::array<bool, n> met = covered;
        met[start] = true;
        for (uint32_t next = 0, found = 1; next < found; ++next)
            for (uint32_t i = 0; i < n; ++i) {
                const float du = where[i].u - where[way[next]].u, dv = where[i].v - where[way[next]].v;
                if (!met[i] && du * du + dv * dv < sqr(kStep)) way[found++] = i, met[i] = true;
            }
        return !(met[0] && met[1] && met[2]);
    }
    Square point(uint32_t i) const { return square_to_triangle(sobol2d(i, key(0x0Eu, side_))); }
    /// A point in one of the parts of a Cover.
    Square point_of_part(uint32_t part) const {
        return within(PatchPlace::of_index(Cover::kDivisions, part).corners(Cover::kDivisions), point(part));
    }
    Surface surface(Square at) const {
        const Scene& scene = accel_.scene();
        return {scene, scene.point_on_patch(scene.patch_of_side(side_), at), scene.is_back(side_)};
    }
    bool is_covered(Square at, uint32_t number, uint32_t rays) const {
        if (sealed_.empty()) return false;
        const Scene& scene = accel_.scene();
        const Surface x = surface(at);
        const Frame frame(x.normal);
        for (uint32_t i = 0; i < rays; ++i) {
            const Vec3 w = frame.to_world(square_to_cosine_hemisphere(sobol2d(number * kRays + i, key(0x0Fu, side_))));
            const Hit hit = accel_.intersect({x.off(scene.epsilon()), w});
            if (!hit.is_miss() && sealed_[size_t{hit.triangle} * 2 + hit.back]) return true;
        }
        return false;
    }

    const Accel& accel_;
    const std::vector<uint8_t>& sealed_;
    uint32_t side_;
};

Cover cover(const Probes& probes, uint32_t points, bool is_small) {
    if (!probes.any(points, 1)) return is_small || !probes.is_crossed() ? Cover{} : probes.look();
    return probes.all(kFewPoints, kRays) ? Cover{0} : probes.look();
}

}  // namespace

std::vector<Cover> find_covers(const Accel& accel, const DefensiveStarts& starts) {
    const Scene& scene = accel.scene();
    if (starts.reached.empty()) return {};
    const std::vector<uint8_t> sealed = sealed_faces(scene, starts);
    const std::optional<SealedBodies> bodies = sealed.empty() ? std::nullopt
                                                              : std::optional<SealedBodies>(std::in_place, scene, starts.closed, sealed);
    const double small = kSmall * scene.total_area() / scene.patches();
    std::vector<Cover> covers(scene.sides());
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 256), [&](const auto& range) {
        const FlushDenormals flush;
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const uint32_t patch = scene.patch_of_side(side);
            if (bodies && sealed[size_t{scene.triangle_of_side(side)} * 2 + scene.is_back(side)])
                covers[side] = {0};
            else if (scene.scatters(side))
                covers[side] = cover(Probes(accel, sealed, side), bodies && bodies->may_cover(patch) ? kFewPoints : 0,
                                     scene.tessellation().share(patch) == 1 && double{scene.patch_area(patch)} < small);
        }
    });
    const bool is_open = std::all_of(covers.begin(), covers.end(), [](const Cover& c) { return c.open_share == 1 && !c.divides; });
    return is_open ? std::vector<Cover>{} : covers;
}

}  // namespace lumel
