// Lamps as seen from a point, and a patch as a source of rays: draws have the densities that are claimed.
#include <gtest/gtest.h>

#include "lumel/scene/lamp_sampler.h"
#include "lumel/transport/side_source.h"
#include "scenes.h"
#include "stats.h"

using namespace lumel;
using namespace lumel::test;

namespace {

/// Solid angle of a triangle seen from the origin, sr (van Oosterom and Strackee 1983); positive if its front is seen.
double solid_angle(Vec3 a, Vec3 b, Vec3 c) {
    const double la = length(a), lb = length(b), lc = length(c);
    const double above = -dot(a, cross(b, c)), below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return 2 * std::atan2(above, below);
}

/// A floor at z = 0 under lamps that do not hide each other: two rectangles, a ball, a slanted triangle.
SceneBuilder floor_and_lamps() {
    SceneBuilder b;
    const uint32_t white = b.material(matt(0.5f));
    b.shape(white).quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
    b.shape(white, grey(3)).quad({-0.5f, -0.5f, 1.5f}, {0, 1, 0}, {1, 0, 0});
    b.shape(white, {9, 1, 4}).quad({2, -0.2f, 0.2f}, {0, 0, 0.5f}, {0, 0.6f, 0});
    b.shape(white, grey(1)).sphere({-1.2f, 0.3f, 0.6f}, 0.3f, 1, false);
    b.shape(white, {0.1f, 8, 0.2f}).triangle({0.2f, 1, 0.3f}, {0.8f, 1.2f, 0.4f}, {0.5f, 1.1f, 0.9f});
    return b;
}

Surface floor_at(const Accel& accel, Vec3 at) {
    return {accel.scene(), accel.intersect({at + Vec3{0, 0, 1e-3f}, {0, 0, -1}}).point(), false};
}

/// Mean of 1/pdf over samples is the solid angle of all lamps above the horizon, and pdf_w says what sample said.
void expect_solid_angle(const SceneBuilder& builder, Vec3 at) {
    const Scene scene = builder.build(100);
    const Accel accel(scene);
    const Surface x = floor_at(accel, at);
    const LampView view(scene, x);
    double truth = 0;
    for (uint32_t t = 0; t < scene.triangles(); ++t) {
        const auto [i, j, k] = scene.indices()[t];
        if (scene.lamp_of(t) >= 0)
            truth += std::max(0.0, solid_angle(scene.vertices()[i] - x.x, scene.vertices()[j] - x.x, scene.vertices()[k] - x.x));
    }
    std::vector<double> values;
    Rng rng(8);
    int traced = 0, elsewhere = 0;
    for (int i = 0; i < 40000; ++i) {
        const float choice = rng.uniform();
        const LampSample s = view.sample(choice, square(rng));
        values.push_back(s.pdf_w > 0 ? 1 / double{s.pdf_w} : 0);
        if (!(s.pdf_w > 0)) continue;
        ASSERT_NEAR(length(s.wi), 1, 1e-5);
        ASSERT_TRUE(accel.visible(x.off(scene.epsilon()), s.target));
        // At the very edge of a lamp, rounding leads the ray to its neighbour or past it.
        const Hit hit = accel.intersect({x.off(scene.epsilon()), s.wi});
        const bool same = !hit.is_miss() && scene.emission(hit.triangle) == s.radiance &&
                          std::abs(view.pdf_w(hit.triangle, s.wi, length(scene.position(hit.point()) - x.x)) / s.pdf_w - 1) < 2e-3f;
        ++traced, elsewhere += !same;
    }
    EXPECT_LT(elsewhere, traced / 200);
    EXPECT_GT(mean_of(values).p_value(truth), 1e-4) << mean_of(values).value << " +- " << mean_of(values).error << ", truth " << truth;
}

}  // namespace

TEST(LampView, samples_have_their_density) {
    // Cells are 16 small triangles of every triangle of a lamp; their mass is the integral of pdf_w over their solid angle.
    constexpr uint32_t kCells = 4, kFine = 8;
    constexpr int kDraws = 100000;
    const Scene scene = floor_and_lamps().build(100);
    const Accel accel(scene);
    for (Vec3 at : {Vec3{0, 0, 0}, Vec3{-1.0f, -0.4f, 0}, Vec3{1.5f, 0.3f, 0}}) {
        const Surface x = floor_at(accel, at);
        const LampView view(scene, x);
        std::vector<double> expected(scene.triangles() * kCells * kCells), observed(expected.size());
        double inside = 0;
        for (uint32_t t = 0; t < scene.triangles(); ++t)
            for (uint32_t k = 0; scene.lamp_of(t) >= 0 && k < kCells * kFine * kCells * kFine; ++k) {
                const PatchCorners c = PatchPlace::of_index(kCells * kFine, k).corners(kCells * kFine);
                const SurfacePoint y{t, (c[0].u + c[1].u + c[2].u) / 3, (c[0].v + c[1].v + c[2].v) / 3};
                const Vec3 to = scene.position(y) - x.x, wi = normalize(to);
                const double solid = -dot(scene.geometric_normal(t), wi) / dot(to, to) * scene.triangle_area(t) /
                                     (kCells * kFine * kCells * kFine);
                const double mass = view.pdf_w(t, wi, length(to)) * solid;
                expected[t * kCells * kCells + PatchPlace::of_point(kCells, y.u, y.v).index(kCells)] += mass * kDraws;
                inside += mass;
            }
        expected.push_back((1 - inside) * kDraws), observed.push_back(0);
        Rng rng(21);
        for (int i = 0; i < kDraws; ++i) {
            const float choice = rng.uniform();
            const LampSample s = view.sample(choice, square(rng));
            const Hit hit = s.pdf_w > 0 ? accel.intersect({x.off(scene.epsilon()), s.wi}) : Hit{};
            if (hit.is_miss()) {
                ++observed.back();
            } else {
                ++observed[hit.triangle * kCells * kCells + PatchPlace::of_point(kCells, hit.u, hit.v).index(kCells)];
            }
        }
        EXPECT_GT(chi_square_p(observed, expected), 1e-4) << "at " << at.x;
        EXPECT_LT(inside, 1 + 1e-4);
    }
}

TEST(LampView, covers_all_lamps) {
    expect_solid_angle(floor_and_lamps(), {0.1f, 0.2f, 0});
    expect_solid_angle(floor_and_lamps(), {-1.8f, -0.9f, 0});
}

TEST(LampView, irradiance_of_area_and_point_lamps_together) {
    // E = I cos/d^2 of the point lamp + the sampled integral of L cos of the area lamps, which a fine quadrature of triangles tells.
    SceneBuilder b = floor_and_lamps();
    b.point_lamp({0.5f, -0.7f, 0.8f}, grey(0.7f)).point_lamp({0.5f, -0.7f, -0.8f}, grey(50));
    const Scene scene = b.build(100);
    const Accel accel(scene);
    const Surface x = floor_at(accel, {0.1f, 0.2f, 0});
    const Vec3 to = Vec3{0.5f, -0.7f, 0.8f} - x.x;
    double truth = lum(grey(0.7f)) * to.z / std::pow(length(to), 3);
    constexpr int kFine = 64;
    for (const AreaLamp& lamp : scene.area_lamps())
        for (uint32_t t : lamp.triangles)
            for (uint32_t k = 0; k < kFine * kFine; ++k) {
                const PatchCorners c = PatchPlace::of_index(kFine, k).corners(kFine);
                const Vec3 d = scene.position({t, (c[0].u + c[1].u + c[2].u) / 3, (c[0].v + c[1].v + c[2].v) / 3}) - x.x;
                const double cos_y = -dot(scene.geometric_normal(t), d) / length(d), cos_x = d.z / length(d);
                if (cos_y > 0) truth += lum(lamp.radiance) * cos_x * cos_y * scene.triangle_area(t) / (kFine * kFine) / dot(d, d);
            }
    const LampView view(scene, x);
    std::vector<double> values;
    Rng rng(3);
    for (int i = 0; i < 100000; ++i) {
        const float choice = rng.uniform();
        const LampSample s = view.sample(choice, square(rng));
        values.push_back(s.pdf_w > 0 ? lum(s.radiance) * double{s.wi.z} / double{s.pdf_w} : 0);
    }
    const Mean m = mean_of(values);
    EXPECT_GT(m.p_value(truth), 1e-4) << m.value << " +- " << m.error << ", truth " << truth;
    EXPECT_LT(m.error, 0.01 * truth);
}

namespace {

/// A glossy smooth sphere with diffuse flux and three records on every side.
struct GlossySource {
    Scene scene;
    Emitters emitters{scene};
    uint32_t side = 5;

    static Scene make(bool smooth) {
        SceneBuilder b;
        b.shape(b.material(glossy({0.3f, 0.2f, 0.1f}, {0.4f, 0.5f, 0.6f}, 0.25f))).sphere({}, 1, 1, false, smooth);
        return b.build(80);
    }
    explicit GlossySource(bool smooth) : scene(make(smooth)) {
        const Frame frame(scene.shading_normal(scene.centre_of_patch(side)));
        const Material& m = scene.material(0);
        emitters.diffuse[side] = {1, 2, 3};
        const auto records = emitters.open_records(scene, side);
        const std::array<Vec3, 3> from{normalize({0.3f, 0.1f, 1}), normalize({-1, 0.2f, 0.5f}), normalize({0.1f, -1, 0.2f})};
        for (size_t k = 0; k < 3; ++k) {
            const Rgb flux{2, 1.0f + static_cast<float>(k), 4};
            records[k] = {frame.to_world(from[k]), flux, lum(flux * m.albedo_s(from[k].z))};
        }
    }
};

/// One ray of a source: `at` in its power, W, or negative for the cosine lobe.
Leaving leave(const SideSource& source, double at, Square point, Square direction) {
    Leaving rays;
    rays.size = 1;
    rays.at[0] = at;
    rays.point_u[0] = point.u, rays.point_v[0] = point.v;
    rays.direction_u[0] = direction.u, rays.direction_v[0] = direction.v;
    source.draw_points(rays);
    source.draw_directions(rays);
    source.evaluate(rays);
    return rays;
}

}  // namespace

TEST(SideSource, draws_have_the_density_of_all_lobes_together) {
    for (bool smooth : {false, true}) {
        const GlossySource s(smooth);
        const double power = s.emitters.power(s.scene, s.side), rays = 1000;
        const SideSource source(s.scene, s.emitters, s.side, rays / power);
        for (Square where : {Square{0.2f, 0.3f}, Square{0.9f, 0.5f}}) {
            const Vec3 shading = leave(source, -1, where, {}).shading[0];
            // Draws below both horizons are lost, and there the density is 0.
            const auto draw = [&](Rng& rng) {
                const double at = double{rng.uniform()} * power;
                const Vec3 w = leave(source, at, where, square(rng)).w[0];
                return dot(w, shading) > 0 || dot(w, source.normal()) > 0 ? w : Vec3{};
            };
            const auto pdf = [&](Vec3 w) { return source.evaluate(shading, w).pdf_aw / rays * double{s.scene.side_area(s.side)}; };
            EXPECT_GT(chi_square_directions(draw, pdf, shading, 200000, smooth ? 31 : 32), 1e-4) << "smooth " << smooth;
        }
    }
}

TEST(SideSource, evaluates_many_rays_as_it_does_one) {
    const GlossySource s(true);
    const double power = s.emitters.power(s.scene, s.side);
    const SideSource source(s.scene, s.emitters, s.side, 1000 / power);
    Leaving rays;
    rays.size = Leaving::kMost;
    Rng rng(8);
    for (uint32_t i = 0; i < rays.size; ++i) {
        const Square point = square(rng), direction = square(rng);
        rays.at[i] = power * i / rays.size;
        rays.point_u[i] = point.u, rays.point_v[i] = point.v;
        rays.direction_u[i] = direction.u, rays.direction_v[i] = direction.v;
    }
    source.draw_points(rays);
    source.draw_directions(rays);
    source.evaluate(rays);
    for (uint32_t i = 0; i < rays.size; ++i) {
        const Leaving one = leave(source, rays.at[i], {rays.point_u[i], rays.point_v[i]}, {rays.direction_u[i], rays.direction_v[i]});
        EXPECT_EQ(rays.y[i], one.y[0]);
        EXPECT_EQ(rays.w[i], one.w[0]);
        const SideSource::Emission e = source.evaluate(rays.shading[i], rays.w[i]);
        EXPECT_NEAR(rays.pdf_aw[i], e.pdf_aw, 1e-5f * e.pdf_aw);
        EXPECT_NEAR(lum(rays.radiance[i]), lum(e.radiance), 1e-5f * lum(e.radiance));
    }
}

TEST(SideSource, points_are_uniform_on_the_patch) {
    const GlossySource s(false);
    const SideSource source(s.scene, s.emitters, s.side, 1);
    Rng rng(6);
    Vec3 mean;
    for (int i = 0; i < 20000; ++i) mean += leave(source, -1, square(rng), {}).y[0] / 20000.0f;
    const Vec3 centre = s.scene.position(s.scene.centre_of_patch(s.side));
    // A coordinate of a uniform point varies by less than a quarter of the size: 4 standard errors.
    EXPECT_LT(length(mean - centre), 4 * std::sqrt(3.0f) * 0.25f * std::sqrt(s.scene.side_area(s.side)) / std::sqrt(20000.0f));
}

TEST(SideSource, radiance_carries_the_power_of_its_lobes) {
    // The integral of L cos over the hemisphere and the patch is the diffuse flux and the specular share of every record.
    const GlossySource s(false);
    const SideSource source(s.scene, s.emitters, s.side, 1);
    Rgb64 truth = to_double(s.emitters.diffuse[s.side]);
    for (const Record& record : s.emitters.records_of(s.scene, s.side))
        truth += to_double(record.flux) * to_double(s.scene.material(0).albedo_s(dot(record.wi, source.normal())));
    constexpr int kSide = 512;
    Rgb64 sum;
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            const Square direction{(static_cast<float>(i) + 0.5f) / kSide, (static_cast<float>(j) + 0.5f) / kSide};
            sum += to_double(leave(source, -1, {0.4f, 0.4f}, direction).radiance[0]) *
                   (double{kPi} * double{s.scene.side_area(s.side)} / (kSide * kSide));
        }
    EXPECT_NEAR(sum.x / truth.x, 1, 2e-3);
    EXPECT_NEAR(sum.y / truth.y, 1, 2e-3);
    EXPECT_NEAR(sum.z / truth.z, 1, 2e-3);
}

TEST(LampView, covers_very_many_lamps) {
    // More than are weighed one by one: ceiling, wall and some below the horizon.
    SceneBuilder b;
    const uint32_t white = b.material(matt(0.5f));
    b.shape(white).quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
    for (int i = 0; i < 12; ++i)
        for (int j = 0; j < 12; ++j) {
            const float x = -1.65f + 0.3f * static_cast<float>(i), y = -1.65f + 0.3f * static_cast<float>(j);
            b.shape(white, {1 + static_cast<float>(i), 2 + static_cast<float>(j), 1}).quad({x, y, 1.5f}, {0, 0.1f, 0}, {0.1f, 0, 0});
        }
    b.shape(white, grey(3)).quad({0, 0, -1}, {0, 0.1f, 0}, {0.1f, 0, 0});
    for (Vec3 at : {Vec3{0.03f, 0.01f, 0}, Vec3{-1.7f, 1.2f, 0}}) expect_solid_angle(b, at);
}
