// Lamps close to a point: triangles sampled by solid angle, densities, and irradiance against closed forms.
#include <gtest/gtest.h>

#include "lumel/scene/lamp_sampler.h"
#include "lumel/transport/first_shot.h"
#include "scenes.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

using Corners = std::array<Vec3, 3>;

Rgb64 unit(Vec3 v) {
    const Rgb64 w = to_double(v);
    return w * (1 / std::sqrt(w.x * w.x + w.y * w.y + w.z * w.z));
}
double inner(Rgb64 a, Rgb64 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Rgb64 outer(Rgb64 a, Rgb64 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
double norm(Rgb64 a) { return std::sqrt(inner(a, a)); }

/// Solid angle by its three dihedral angles (Girard), sr: another way than the sampler's.
double girard(const Corners& t) {
    const std::array<Rgb64, 3> n{outer(unit(t[0]), unit(t[1])), outer(unit(t[1]), unit(t[2])), outer(unit(t[2]), unit(t[0]))};
    double sum = -std::acos(-1.0);
    for (size_t i = 0; i < 3; ++i) {
        const Rgb64 p = n[i], q = n[(i + 1) % 3] * -1;
        sum += std::atan2(norm(outer(p, q)), inner(p, q));
    }
    return sum;
}

/// Irradiance from a triangle of radiance 1 that lies above the horizon of `normal`, W/m2 (Lambert's contour integral).
double lambert(const Corners& t, Vec3 normal) {
    double sum = 0;
    for (size_t i = 0; i < 3; ++i) {
        const Rgb64 p = unit(t[i]), q = unit(t[(i + 1) % 3]), n = outer(p, q);
        if (norm(n) > 0) sum += std::atan2(norm(n), inner(p, q)) * inner(n, to_double(normal)) / norm(n);
    }
    return -0.5 * sum;
}

/// Part k of n * n equal ones.
Corners part(const Corners& t, uint32_t n, uint32_t k) {
    Corners out;
    const PatchCorners c = PatchPlace::of_index(n, k).corners(n);
    for (size_t i = 0; i < 3; ++i) out[i] = t[0] * (1 - c[i].u - c[i].v) + t[1] * c[i].u + t[2] * c[i].v;
    return out;
}

Corners corners_from(const Scene& scene, uint32_t triangle, Vec3 x) {
    Corners out;
    for (size_t i = 0; i < 3; ++i) out[i] = scene.vertices()[scene.indices()[triangle][i]] - x;
    return out;
}

/// A wall in x = 0 that a square lamp in z = 0 touches, a ball of many triangles, and a small lamp elsewhere.
SceneBuilder wall_and_lamps() {
    SceneBuilder b;
    const uint32_t white = b.material(matt(0.5f));
    b.shape(white).quad({0, -2, 0}, {0, 4, 0}, {0, 0, 4});
    b.shape(white, grey(1)).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    b.shape(white, grey(0.7f)).sphere({0.51f, -1, 1}, 0.5f, 2, false);
    b.shape(white, grey(2)).triangle({1, 1, 3}, {1, 1.2f, 3.1f}, {1, 1.1f, 3.3f});
    return b;
}

/// Places on the wall: next to the shared edge and its end, on the level of the lamp beside it, next to the ball, away from all.
constexpr std::array<Square, 7> kPlaces{{{0.6f, 1e-3f}, {0.6f, 0.1f}, {0.01f, 0.01f}, {-0.05f, 1e-4f}, {-1, 1}, {-0.9f, 0.7f}, {0.3f, 2}}};

Surface wall_at(const Accel& accel, Square at) {
    return {accel.scene(), accel.intersect({{0.005f, at.u, at.v}, {-1, 0, 0}}).point(), false};
}

}  // namespace

TEST(SphericalTriangle, solid_angles) {
    const Corners octant{{{1, 0, 0}, {0, 0, 5}, {0, 0.2f, 0}}};
    EXPECT_NEAR(SphericalTriangle(octant[0], octant[1], octant[2]).solid_angle(), 0.5f * kPi, 1e-6f);
    EXPECT_EQ(SphericalTriangle(octant[0], octant[2], octant[1]).solid_angle(), 0) << "from behind";
    EXPECT_EQ(SphericalTriangle({1, 0, 0}, {2, 1, 0}, {2, 3, 0}).solid_angle(), 0) << "in its plane";
    // Directly under a large triangle the whole hemisphere.
    EXPECT_NEAR(SphericalTriangle({-1000, -1000, 1e-3f}, {0, 1000, 1e-3f}, {1000, -1000, 1e-3f}).solid_angle(), 2 * kPi, 1e-4f);
    Rng rng(5);
    const auto corner = [&] { return Vec3{rng.uniform() - 0.5f, rng.uniform() - 0.5f, rng.uniform() - 0.5f}; };
    for (int i = 0; i < 1000; ++i) {
        Corners t{corner(), corner(), corner()};
        if (dot(cross(t[0], t[1]), t[2]) > 0) std::swap(t[0], t[1]);
        const double truth = girard(t);
        ASSERT_NEAR(SphericalTriangle(t[0], t[1], t[2]).solid_angle(), truth, 1e-6 * truth + 1e-7);
    }
}

TEST(SphericalTriangle, samples_are_uniform_by_solid_angle) {
    constexpr uint32_t kParts = 6;
    constexpr int kDraws = 50000;
    const std::array<Corners, 8> triangles{{
        {{{1, 0, 0}, {0, 0, 5}, {0, 0.2f, 0}}},
        {{{-1, -1, 0.01f}, {0.1f, 1, 0.01f}, {1, -1, 0.01f}}},             // nearly a hemisphere
        {{{-1, 0, 1e-4f}, {0.4f, 2, 1e-4f}, {1, 0, 1e-4f}}},               // next to the edge from a to c
        {{{0.4f, 2, 1e-4f}, {1, 0, 1e-4f}, {-1, 0, 1e-4f}}},               // the same, from b to c
        {{{1, 0, 1e-4f}, {-1, 0, 1e-4f}, {0.4f, 2, 1e-4f}}},               // the same, from a to b
        {{{0, 0, 1e-3f}, {1e-3f, 1, 0.5f}, {1, 0.2f, 0}}},                 // next to a corner
        {{{1, 1, 1}, {1, 1.0001f, 1.0002f}, {1.0001f, 0.9999f, 1.0001f}}}, // tiny
        {{{1, 0, 0.1f}, {-1, 1e-4f, 0.1f}, {-1, 0, 0.1f}}},                // a needle
    }};
    for (size_t k = 0; k < triangles.size(); ++k) {
        Corners t = triangles[k];
        if (dot(cross(t[0], t[1]), t[2]) > 0) std::swap(t[0], t[1]);
        const SphericalTriangle seen(t[0], t[1], t[2]);
        ASSERT_GT(seen.solid_angle(), 0) << k;
        std::vector<double> expected, observed(kParts * kParts);
        for (uint32_t i = 0; i < kParts * kParts; ++i) {
            const Corners p = part(t, kParts, i);
            expected.push_back(kDraws * double{SphericalTriangle(p[0], p[1], p[2]).solid_angle() / seen.solid_angle()});
        }
        Rng rng(40 + k);
        for (int i = 0; i < kDraws; ++i) {
            const Square b = seen.sample(square(rng));
            ASSERT_TRUE(b.u >= 0 && b.v >= 0 && b.u + b.v < 1 + 1e-6f) << k;
            ++observed[PatchPlace::of_point(kParts, b.u, b.v).index(kParts)];
        }
        EXPECT_GT(chi_square_p(observed, expected), 1e-4) << "triangle " << k;
    }
}

TEST(LampView, samples_of_near_lamps_have_their_density) {
    // Cells are the triangles of the lamps in 16 parts; their mass is the integral of pdf_w over still smaller parts.
    constexpr uint32_t kCells = 4, kFine = 8, kAll = kCells * kCells;
    constexpr int kDraws = 100000;
    const Scene scene = wall_and_lamps().build(100);
    const Accel accel(scene);
    for (Square place : kPlaces) {
        const Surface x = wall_at(accel, place);
        const LampView view(scene, x);
        std::vector<double> expected(scene.triangles() * kAll), observed(expected.size());
        double inside = 0;
        for (uint32_t t = 0; t < scene.triangles(); ++t)
            for (uint32_t k = 0; scene.lamp_of(t) >= 0 && k < kAll * kFine * kFine; ++k) {
                const Corners p = part(corners_from(scene, t, x.x), kCells * kFine, k);
                const Vec3 to = (p[0] + p[1] + p[2]) / 3;
                const PatchCorners c = PatchPlace::of_index(kCells * kFine, k).corners(kCells * kFine);
                const uint32_t cell =
                    PatchPlace::of_point(kCells, (c[0].u + c[1].u + c[2].u) / 3, (c[0].v + c[1].v + c[2].v) / 3).index(kCells);
                const double mass = double{view.pdf_w(t, normalize(to), length(to))} *
                                    double{SphericalTriangle(p[0], p[1], p[2]).solid_angle()};
                expected[t * kAll + cell] += mass * kDraws, inside += mass;
            }
        expected.push_back((1 - inside) * kDraws), observed.push_back(0);
        EXPECT_LT(inside, 1 + 1e-4);
        Rng rng(22);
        for (int i = 0; i < kDraws; ++i) {
            const float choice = rng.uniform();
            const LampSample s = view.sample(choice, square(rng));
            // From close to the lamp, since lamps may hide each other.
            const Hit hit = s.pdf_w > 0 ? accel.intersect({x.x + 0.9f * length(s.target - x.x) * s.wi, s.wi}) : Hit{};
            if (hit.is_miss())
                ++observed.back();
            else
                ++observed[hit.triangle * kAll + PatchPlace::of_point(kCells, hit.u, hit.v).index(kCells)];
        }
        EXPECT_GT(chi_square_p(observed, expected), 1e-4) << "at " << place.u << ", " << place.v;
    }
}

TEST(LampView, irradiance_next_to_lamps) {
    // Every draw is bounded: the error is small, and what it says. Of the ball, only few of the triangles face the places next to it.
    const Scene scene = wall_and_lamps().build(100);
    const Accel accel(scene);
    for (Square place : kPlaces) {
        const Surface x = wall_at(accel, place);
        double truth = 0;
        for (uint32_t t = 0; t < scene.triangles(); ++t) {
            const Corners c = corners_from(scene, t, x.x);
            if (scene.lamp_of(t) >= 0 && dot(scene.geometric_normal(t), c[0]) < 0)
                truth += double{lum(scene.emission(t))} * lambert(c, x.normal);
        }
        const LampView view(scene, x);
        std::vector<double> values;
        Rng rng(3);
        for (int i = 0; i < 40000; ++i) {
            const float choice = rng.uniform();
            const LampSample s = view.sample(choice, square(rng));
            values.push_back(s.pdf_w > 0 ? std::max(0.0, lum(s.radiance) * double{dot(s.wi, x.normal)} / double{s.pdf_w}) : 0);
        }
        const Mean m = mean_of(values);
        EXPECT_GT(m.p_value(truth), 1e-4) << m.value << " +- " << m.error << ", truth " << truth << " at " << place.u << ", " << place.v;
        const bool at_ball = place.u < -0.5f;
        EXPECT_LT(m.error, (at_ball ? 0.05 : 0.02) * truth) << "at " << place.u << ", " << place.v;
    }
}

TEST(LampView, points_of_a_far_ball_are_chosen_on_what_faces_there) {
    SceneBuilder b;
    const uint32_t white = b.material(matt(0.5f));
    b.shape(white).quad({0, -2, -2}, {0, 4, 0}, {0, 0, 4});
    b.shape(white, grey(1)).sphere({1, 0.3f, -0.2f}, 0.1f, 3, false);
    const Scene scene = b.build(100);
    const Accel accel(scene);
    const Surface x = wall_at(accel, {0, 0});
    double truth = 0;
    for (uint32_t t = 0; t < scene.triangles(); ++t)
        if (scene.lamp_of(t) >= 0 && dot(scene.geometric_normal(t), x.x - scene.position({t, 0, 0})) > 0)
            truth += lambert(corners_from(scene, t, x.x), x.normal);
    const LampView view(scene, x);
    constexpr int kDraws = 20000;
    double sum = 0, squares = 0;
    Rng rng(23);
    for (int i = 0; i < kDraws; ++i) {
        const float choice = rng.uniform();
        const LampSample s = view.sample(choice, square(rng));
        const double value = s.pdf_w > 0 ? double{dot(x.normal, s.wi) / s.pdf_w} : 0;
        sum += value, squares += value * value;
    }
    const double mean = sum / kDraws, deviation = std::sqrt(squares / kDraws - mean * mean);
    EXPECT_NEAR(mean, truth, 4 * deviation / std::sqrt(kDraws));
    // Evenly on the whole ball it would be sqrt(5/3).
    EXPECT_LT(deviation, 0.5 * mean);
}

TEST(NearLamps, no_patch_has_more_light_than_the_brightest_lamp_can_give) {
    // A lamp cuts a wall: what 4 samples of a patch say there has no bound, but none may say more than all of them.
    SceneBuilder b;
    b.shape(b.material(matt(0.5f))).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(b.material(matt(0)), grey(10)).sphere({0, 0.5f, 0.5f}, 0.1f, 2, false, true);
    const Stage stage(b.build(300));
    constexpr uint32_t kSamples = 4;
    float most = 0;
    for (uint64_t seed = 1; seed <= 200; ++seed) {
        Emitters emitters(stage.scene);
        for (Rgb irradiance : direct_irradiance(stage.accel, stage.defensive, kSamples, seed, emitters))
            most = std::max(most, irradiance.y);
    }
    EXPECT_LE(most, kSamples * 10 * kPi * 1.0001f);
}
