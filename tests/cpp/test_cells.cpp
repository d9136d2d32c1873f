// Cells that are divided differently: addressing, interpolation across their edges, and where patches are dealt to.
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numeric>

#include "lumel/eye/reconstruction.h"
#include "lumel/scene/deal_out.h"
#include "lumel/solver/refine.h"
#include "runs.h"

namespace lumel::test {

namespace {

/// A closed room of 3 m with a lamp under its ceiling and a box on its floor, one material.
SceneBuilder room_with_box(const Material& material) {
    SceneBuilder b;
    const uint32_t surface = b.material(material);
    b.shape(surface).box({0, 0, 0}, {3, 3, 3}, true);
    b.shape(surface).box({1.2f, 0, 1.2f}, {1.8f, 0.6f, 1.8f}, false);
    b.shape(surface, grey(4)).quad({1, 2.8f, 1}, {1, 0, 0}, {0, 0, 1});
    return b;
}

Camera above_the_box() {
    return {.origin = {1.5f, 2.5f, 1.5f}, .right = {1, 0, 0}, .up = {0, 0, -1}, .forward = {0, -1, 0}, .width = 64, .height = 64};
}

/// Divisions of cells by chance, with the balance that dealing keeps.
std::vector<uint8_t> by_chance(const Scene& cells, uint64_t seed) {
    const CellEdges edges(cells, Lattice(cells));
    Rng rng(seed);
    std::vector<double> error(cells.patches());
    for (double& e : error) e = std::pow(static_cast<double>(rng.uniform()), 40);
    return deal_out(edges, error, cells.patches() * 6);
}

Scene divided_by_chance(Scene scene, uint64_t seed) {
    scene.divide(Tessellation(scene.tessellation(), by_chance(scene, seed)));
    return scene;
}

/// A field that is known without noise: of every side, by its centre.
template <class Value>
SideField known(const Scene& scene, const Value& value) {
    SideField field{std::vector<Rgb>(scene.sides()), std::vector<Rgb>(scene.sides())};
    for (uint32_t side = 0; side < scene.sides(); ++side)
        field.mean[side] = grey(value(scene.position(scene.centre_of_patch(scene.patch_of_side(side)))));
    return field;
}

Reconstruction reconstructed(const Accel& accel, const Lattice& lattice, const SideField& field) {
    const PatchAreas none = no_areas(accel.scene());
    return {accel, lattice, Solution{field, field, none}, *find_estimator("classical")};
}

/// Root mean square error on the floor of `room_with_box`, up to 0.3 m around the box, relative to the mean of the truth.
double error_at_contact(const Scene& scene, const Reconstruction& found, const Scene& fine, const Reconstruction& truth) {
    const auto at = [](const Scene& s, Vec3 x) {
        for (uint32_t t = 0; t < s.triangles(); ++t) {
            const Vec3 a = s.vertices()[s.indices()[t][0]], u = s.vertices()[s.indices()[t][1]] - a,
                       v = s.vertices()[s.indices()[t][2]] - a;
            if (s.geometric_normal(t).y < 0.9f || a.y != 0) continue;
            const float whole = u.x * v.z - u.z * v.x, p = ((x - a).x * v.z - (x - a).z * v.x) / whole,
                        q = (u.x * (x - a).z - u.z * (x - a).x) / whole;
            if (p >= 0 && q >= 0 && p + q <= 1) return SurfacePoint{t, p, q};
        }
        return SurfacePoint{};
    };
    Rng rng(5);
    double square = 0, mean = 0;
    int count = 0;
    while (count < 4000) {
        const Vec3 x{0.9f + 1.2f * rng.uniform(), 0, 0.9f + 1.2f * rng.uniform()};
        if (std::max(std::abs(x.x - 1.5f), std::abs(x.z - 1.5f)) < 0.3f) continue;
        const double expected = double{lum(truth.irradiance(truth.stencil(at(fine, x), false)).value)};
        square += std::pow(double{lum(found.irradiance(found.stencil(at(scene, x), false)).value)} - expected, 2), mean += expected,
            ++count;
    }
    return std::sqrt(square / count) / (mean / count);
}

}  // namespace

TEST(Cells, every_point_belongs_to_one_patch) {
    const Scene scene = divided_by_chance(room_with_box(matt(0.5f)).build(900), 1);
    const Tessellation& tessellation = scene.tessellation();
    ASSERT_FALSE(tessellation.is_uniform());
    double area = 0;
    std::array<int, 9> kinds{};
    for (uint32_t cell = 0; cell < tessellation.cells(); ++cell) ++kinds[tessellation.divisions(cell)];
    for (uint32_t n : {1u, 2u, 4u, 8u}) EXPECT_GT(kinds[n], 5) << n;
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        const uint32_t triangle = scene.triangle_of_patch(patch);
        const PatchCorners c = tessellation.corners(patch);
        const auto at = [&](Square s) { return scene.position({triangle, s.u, s.v}); };
        const Vec3 n = cross(at(c[1]) - at(c[0]), at(c[2]) - at(c[0]));
        ASSERT_NEAR(0.5f * length(n), scene.patch_area(patch), 1e-4f * scene.patch_area(patch));
        ASSERT_GT(dot(n, scene.geometric_normal(triangle)), 0) << "corners turn like the triangle";
        ASSERT_EQ(scene.patch_of(scene.centre_of_patch(patch)), patch);
        ASSERT_GE(patch, scene.first_patch(triangle));
        ASSERT_LT(patch, scene.first_patch(triangle) + tessellation.count(triangle));
        area += scene.patch_area(patch);
    }
    EXPECT_NEAR(area, scene.total_area(), 1e-5 * area);

    // The patch of a point holds it, up to rounding; on edges too.
    Rng rng(2);
    for (int i = 0; i < 100000; ++i) {
        Square s = square_to_triangle(square(rng));
        if (i % 3 == 0) s.u = std::floor(s.u * 16) / 16;
        const uint32_t triangle = static_cast<uint32_t>(i) % scene.triangles(), patch = scene.patch_of({triangle, s.u, s.v});
        ASSERT_EQ(scene.triangle_of_patch(patch), triangle);
        const PatchCorners c = tessellation.corners(patch);
        for (size_t k = 0; k < 3; ++k) {
            const Square a = c[k], b = c[(k + 1) % 3];
            ASSERT_GT((b.u - a.u) * (s.v - a.v) - (b.v - a.v) * (s.u - a.u), -1e-6f);
        }
    }
}

TEST(Cells, interpolation_has_no_steps_and_keeps_linear_fields) {
    const Scene scene = divided_by_chance(room_with_box(matt(0.5f)).build(900), 3);
    const Accel accel(scene);
    const Lattice lattice(scene);
    ASSERT_GT(lattice.hanging().size(), 100u);
    const auto linear = [](Vec3 x) { return 1 + 0.3f * x.x - 0.2f * x.y + 0.1f * x.z; };
    const SideField even = known(scene, linear);
    Rng rng(4);
    const SideField wild = known(scene, [&](Vec3) { return rng.uniform(); });
    const Reconstruction smooth = reconstructed(accel, lattice, even), rough = reconstructed(accel, lattice, wild);
    for (int i = 0; i < 20000; ++i) {
        // Points across the edges of patches, inside a wall of the room: its vertices on the border pool patches on one side.
        const auto patch = static_cast<uint32_t>(rng.uniform() * static_cast<float>(scene.patches()));
        const uint32_t triangle = scene.triangle_of_patch(patch);
        const PatchCorners c = scene.tessellation().corners(patch);
        const float w = rng.uniform(), off = 1e-5f;
        const auto on_edge = [&](float shift) {
            return SurfacePoint{triangle, w * c[0].u + (1 - w) * c[1].u + shift * (c[2].u - c[0].u),
                                w * c[0].v + (1 - w) * c[1].v + shift * (c[2].v - c[0].v)};
        };
        const SurfacePoint in = on_edge(off), out = on_edge(-off);
        if (out.u < 0 || out.v < 0 || out.u + out.v > 1) continue;
        EXPECT_NEAR(rough.irradiance(rough.stencil(in, false)).value.x, rough.irradiance(rough.stencil(out, false)).value.x, 2e-3f);
        const Vec3 x = scene.position(in), border{std::min(x.x, 3 - x.x), std::min(x.y, 3 - x.y), std::min(x.z, 3 - x.z)};
        const float nearest = std::min({border.x, border.y, border.z}),
                    next = border.x + border.y + border.z - nearest - max_component(border);
        if (scene.triangle_area(triangle) < 4 || next < 0.7f) continue;
        EXPECT_NEAR(smooth.irradiance(smooth.stencil(in, false)).value.x, linear(x), 2e-5f);
    }
}

TEST(Cells, dealing_keeps_to_its_budget_and_its_balance) {
    const Scene cells = room_with_box(matt(0.5f)).build(900);
    const CellEdges edges(cells, Lattice(cells));
    std::vector<double> error(cells.patches(), 1e-9);
    error[17] = 1;
    for (uint64_t patches : {uint64_t{0}, uint64_t{cells.patches()}, uint64_t{1000}, uint64_t{3000}, uint64_t{100'000}}) {
        const auto divisions = deal_out(edges, error, patches);
        uint64_t count = 0;
        for (uint32_t cell = 0; cell < cells.patches(); ++cell) {
            count += uint64_t{divisions[cell]} * divisions[cell];
            for (uint32_t other : edges.neighbours(cell)) EXPECT_LE(divisions[cell], 2 * divisions[other]);
        }
        EXPECT_LE(count, std::max<uint64_t>(patches, cells.patches()));
        EXPECT_GE(count + 250, std::min<uint64_t>(patches, uint64_t{64} * cells.patches()));
        EXPECT_TRUE(patches < 1000 || divisions[17] == kMostDivisions);
    }
}

TEST(Cells, equal_scenes_are_divided_alike_whatever_the_threads) {
    std::vector<float> first;
    for (size_t threads : {1, 2, 8}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
        Scene scene = room_with_box(matt(0.6f)).build(3000);
        const Accel accel(scene);
        refine(scene, accel, std::array{above_the_box()}, 3000, true);
        std::vector<float> areas(scene.patches());
        for (uint32_t patch = 0; patch < scene.patches(); ++patch) areas[patch] = scene.patch_area(patch);
        if (first.empty()) first = areas;
        EXPECT_EQ(areas, first);
    }
    EXPECT_NEAR(static_cast<double>(first.size()), 3000, 200);
}

TEST(Cells, patches_go_where_light_bends_and_errors_fall) {
    // Around the foot of a box indirect light falls off within a few centimetres.
    const RunConfig config{.solver = {.transport = Transport::kRays, .defensive = 0, .seed = 1}, .replicas = 4, .rays = 1 << 20};
    const Material material = matt(0.7f);
    const Stage fine(room_with_box(material).build(30000));
    const Solver solved_fine = solved(fine, config, no_areas(fine.scene));
    const SideField light = solved_fine.indirect();
    const Reconstruction truth = reconstructed(fine.accel, fine.lattice, light);
    std::array<double, 2> errors{};
    for (const bool adaptive : {false, true}) {
        Scene scene = room_with_box(material).build(2400);
        if (adaptive) refine(scene, Accel(scene), std::array{above_the_box()}, 2400, true);
        const Stage stage(std::move(scene));
        const Solver solver = solved(stage, config, no_areas(stage.scene));
        const SideField found = solver.indirect();
        errors[adaptive] = error_at_contact(stage.scene, reconstructed(stage.accel, stage.lattice, found), fine.scene, truth);
    }
    EXPECT_LT(errors[1], 0.6 * errors[0]);
}

TEST(Cells, a_closed_room_keeps_its_light) {
    // Mean irradiance is the power of the lamp over what is absorbed, however the walls are divided.
    for (float rho : {0.3f, 0.8f}) {
        SceneBuilder b;
        const uint32_t surface = b.material(matt(rho));
        b.shape(surface).box({0, 0, 0}, {3, 3, 3}, true).shape(surface, grey(4)).quad({1, 2.8f, 1}, {1, 0, 0}, {0, 0, 1});
        Scene scene = b.build(2000);
        refine(scene, Accel(scene), {}, 2000, true);
        ASSERT_FALSE(scene.tessellation().is_uniform());
        const Stage stage(std::move(scene));
        const double truth = lamp_power(stage.scene) / (stage.defensive.by_area.total() * (1 - double{rho}));
        for (Transport transport : kRayTransports) {
            const RunConfig config{.solver = {.transport = transport, .defensive = 0.1f, .direct_samples = 16, .seed = 1}, .replicas = 8};
            const Mean m = mean_irradiance(stage, config, {reachable(stage)})[0];
            EXPECT_LT(m.error, 5e-3 * truth);
            EXPECT_NEAR(m.value, truth, 4 * m.error + 1e-3 * truth) << name_of(transport);
        }
    }
}

}  // namespace lumel::test
