// Walls without thickness that stand across patches: light stays where it is.
#include <gtest/gtest.h>

#include "lumel/sampling/warp.h"
#include "lumel/solver/session.h"
#include "lumel/transport/covers.h"
#include "lumel/transport/walls.h"
#include "runs.h"

namespace lumel::test {

namespace {

constexpr float kAlbedo = 0.8f;

/// A closed room that two sheets divide, one of them oblique: a red lamp in the first of three parts, a blue one in the last.
Scene divided_room(uint64_t patches, const Material& walls) {
    SceneBuilder b;
    b.shape(b.material(walls)).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(b.material(walls)).quad({0.27f, 0, 0}, {0.21f, 1, 0}, {0, 0, 1});
    b.shape(b.material(walls)).quad({0.517f, 0, 0}, {0, 1, 0}, {0, 0, 1});
    b.shape(b.material(matt(0)), {10, 0, 0}).quad({0.05f, 0.1f, 0.99f}, {0, 0.1f, 0}, {0.1f, 0, 0});
    b.shape(b.material(matt(0)), {0, 0, 10}).quad({0.8f, 0.1f, 0.99f}, {0, 0.1f, 0}, {0.1f, 0, 0});
    return b.build(patches);
}
/// Part of that room that a point is in.
int part_of_room(Vec3 x) { return x.x < 0.27f + 0.21f * x.y ? 0 : x.x < 0.517f ? 1 : 2; }

Rgb irradiance_of(const Session& session, uint32_t side, const SideField& direct, const SideField& indirect) {
    return session.scene().is_divided(side) ? Rgb{} : direct.mean[side] + indirect.mean[side];
}

}  // namespace

TEST(PatchParts, points_lie_in_their_part_and_are_uniform) {
    const PatchCorners corners{{{0.2f, 0.1f}, {0.6f, 0.1f}, {0.2f, 0.5f}}};
    PatchParts parts(0);
    for (const WallLine line : {WallLine{1, 0.3f, -0.38f}, WallLine{-0.2f, 1, -0.12f}, WallLine{1, 0.3f, -0.38f}, WallLine{1, 1, -5}})
        parts.add(line, corners);
    constexpr uint32_t kPoints = 1 << 14;
    std::array<double, PatchParts::kParts> count{}, u{}, v{};
    for (uint32_t i = 0; i < kPoints; ++i) {
        const Square b = square_to_triangle(sobol2d(i, 5));
        const uint32_t part = parts.part_of(within(corners, b));
        ++count[part], u[part] += double{b.u}, v[part] += double{b.v};
    }
    int found = 0;
    for (uint32_t part = 0; part < PatchParts::kParts; ++part) {
        EXPECT_NEAR(count[part] / kPoints, parts.share(part), 0.003);
        if (!(parts.share(part) > 0)) continue;
        ++found;
        const PartPolygon polygon = parts.polygon(part);
        double mean_u = 0, mean_v = 0;
        uint32_t outside = 0;
        for (uint32_t i = 0; i < kPoints; ++i) {
            const Square b = polygon.point(sobol2d(i, 6));
            outside += parts.part_of(within(corners, b)) != part;
            mean_u += double{b.u} / kPoints, mean_v += double{b.v} / kPoints;
        }
        EXPECT_LE(outside, 3u);  // rounding
        EXPECT_NEAR(mean_u, u[part] / count[part], 0.005);
        EXPECT_NEAR(mean_v, v[part] / count[part], 0.005);
    }
    EXPECT_EQ(found, 4);  // one line came twice, and one does not meet the patch
}

TEST(Walls, let_no_light_through) {
    // Nothing of the other lamp's colour in either part, and nothing at all between the sheets. It was some 2 % of the light.
    for (const Material& walls : {matt(kAlbedo), glossy(grey(0.4f), grey(0.4f), 0.2f)})
        for (Transport transport : kRayTransports) {
            Session session(divided_room(2000, walls), {}, {.solver = {.transport = transport, .defensive = 0.1f, .seed = 3}});
            const RunConfig config{.solver = {.transport = transport}, .rays = 100000, .solve_rays = 50000};
            for (int replica = 0; replica < 2; ++replica) run_replica(session.solver(), config);
            const SideField direct = session.solver().direct(), indirect = session.indirect();
            const Scene& scene = session.scene();
            EXPECT_GT(scene.divided_sides(), 100u);
            std::array<Rgb64, 3> light{};
            for (uint32_t side = 0; side < scene.patches(); ++side)
                if (scene.shape(scene.triangle_of_side(side)) == 0)
                    light[part_of_room(scene.position(scene.centre_of_patch(side)))] += irradiance_of(session, side, direct, indirect) *
                                                                                        scene.side_area(side);
            const double least = 1e-4 * std::min(light[0].x, light[2].z);
            EXPECT_GT(least, 1e-5);
            EXPECT_LT(light[0].z, least) << name_of(transport);
            EXPECT_LT(light[1].x, least) << name_of(transport);
            EXPECT_LT(light[1].z, least) << name_of(transport);
            EXPECT_LT(light[2].x, least) << name_of(transport);
        }
}

TEST(Walls, lose_no_light_under_them) {
    // Walls that are sheets stand on a floor that is larger than the room: what surfaces absorb is what the lamp sends, to five standard
    // errors and a thousandth. 2 % were lost.
    constexpr int kSeeds = 6;
    std::vector<double> shares;
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
        SceneBuilder b;
        const uint32_t white = b.material(matt(kAlbedo));
        b.shape(white).quad({-0.13f, -0.17f, 0}, {1.3f, 0, 0}, {0, 1.3f, 0});
        b.shape(white).quad({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
        b.shape(white).quad({0, 0, 0}, {0, 0, 1}, {1, 0, 0}).quad({0, 1, 0}, {1, 0, 0}, {0, 0, 1});
        b.shape(white).quad({0, 0, 0}, {0, 1, 0}, {0, 0, 1}).quad({1, 0, 0}, {0, 0, 1}, {0, 1, 0});
        b.shape(b.material(matt(0)), grey(10)).quad({0.1f, 0.1f, 0.99f}, {0, 0.2f, 0}, {0.2f, 0, 0});
        Session session(b.build(300), {}, {.solver = {.direct_samples = 256, .seed = seed}});
        shares.push_back(absorbed_share(session));
    }
    const Mean mean = mean_of(shares);
    EXPECT_NEAR(mean.value, 1, 1e-3 + 5 * mean.error);
    EXPECT_LT(mean.error, 2e-3);
}

TEST(Walls, parts_have_the_density_that_rays_count_with) {
    // The density of what comes to areas of the first part integrates to 1, whether it is shot alone or gathered as well: both must agree
    // on what each part of a side sends.
    constexpr int kSeeds = 6;
    const Camera camera = camera_over_floor(0.1f);
    for (float gather : {0.0f, 4000.0f})
        for (Transport transport : kRayTransports) {
            std::vector<double> densities;
            for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
                Session session(divided_room(600, glossy(grey(0.4f), grey(0.4f), 0.2f)), {camera},
                                {.solver = {.transport = transport, .defensive = 0.3f, .gather = gather, .seed = seed}});
                run_replica(session.solver(), {.solver = {.transport = transport}, .rays = 200000, .solve_rays = 50000});
                const PatchAreas& areas = session.solver().areas();
                double density = 0, size = 0;
                for (uint32_t area = 0; area < areas.size(); ++area) {
                    const uint32_t side = areas.sides()[area];
                    const Vec3 x = session.scene().position(session.scene().centre_of_patch(session.scene().patch_of_side(side)));
                    if (!(areas.albedo(0, area) > 0) || session.scene().is_divided(side) || part_of_room(x) != 0) continue;
                    const double counts = areas.area(area) * areas.albedo(0, area);
                    density += areas.samples(0, area).g * counts, size += counts;
                }
                ASSERT_GT(size, 0);
                densities.push_back(density / size);
            }
            const Mean mean = mean_of(densities);
            EXPECT_NEAR(mean.value, 1, 0.005 + 5 * mean.error) << name_of(transport) << " gather " << gather;
            EXPECT_LT(mean.error, 0.02) << name_of(transport);
        }
}

}  // namespace lumel::test
