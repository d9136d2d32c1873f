// Patches that lie partly under something: what light reaches of them, and where it goes.
#include <gtest/gtest.h>

#include "lumel/solver/session.h"
#include "lumel/transport/covers.h"
#include "runs.h"

namespace lumel::test {

namespace {

constexpr float kAlbedo = 0.8f;

/// A closed room with a lamp at the ceiling and a block that is sunk into the floor, in coarse patches.
Scene room_with_block(uint64_t patches, Vec3 lower, Vec3 upper, const Material& walls = matt(kAlbedo)) {
    SceneBuilder b;
    b.shape(b.material(walls)).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(b.material(matt(kAlbedo))).box(lower, upper, false);
    b.shape(b.material(matt(0)), grey(10)).quad({0.1f, 0.1f, 0.99f}, {0, 0.2f, 0}, {0.2f, 0, 0});
    return b.build(patches);
}

/// Two slabs stick out a little of a block, `gap` apart: they face each other within it and outside.
Scene slabs_in_block(float gap) {
    SceneBuilder b;
    b.shape(b.material(matt(0.9f))).box({0, 0, 0}, {1, 1, 1}, false);
    b.shape(b.material(matt(0.9f)))
        .box({0.9f, 0.2f, 0.2f}, {1.02f, 0.3f, 0.8f}, false)
        .box({0.9f, 0.3f + gap, 0.2f}, {1.02f, 0.4f + gap, 0.8f}, false);
    b.shape(b.material(matt(0)), grey(10)).quad({2, 0, 0}, {0, 0, 1}, {0, 1, 0});
    return b.build(600);
}
uint32_t barely_open(const Scene& scene) {
    uint32_t count = 0;
    for (uint32_t side = 0; side < scene.sides(); ++side) count += scene.open_share(side) > 0 && scene.open_share(side) < 0.3f;
    return count;
}
double power(const Scene& scene, const Emitters& emitters) {
    double sum = 0;
    for (uint32_t side = 0; side < scene.sides(); ++side) sum += emitters.power(scene, side);
    return sum;
}

}  // namespace

TEST(Covers, no_light_grows_inside_of_what_covers) {
    // What starts within the block comes to patches that are open in part. It counted as light that came to the open part, made up for what
    // is covered, and grew in each generation.
    Session session(slabs_in_block(0.08f), {}, {});
    EXPECT_GT(barely_open(session.scene()), 4u);
    const DefensiveStarts starts = survey(session.accel(), 7);
    for (uint64_t seed = 1; seed <= 10; ++seed) {
        Emitters sent = Illumination(session.accel(), starts, {.stream = seed}).emitters();
        Transfers transfers;
        std::vector<Rgb> received;
        double before = power(session.scene(), sent);
        for (uint64_t generation = 0; generation < 8; ++generation) {
            Emitters next(session.scene());
            shoot(Shot(session.accel(), sent, starts, {100000, 0, key(seed, generation)}), transfers);
            scatter(session.scene(), transfers, key(seed, generation, 1), received, next);
            EXPECT_LT(power(session.scene(), next), 0.9 * before);
            before = power(session.scene(), next), sent = next;
        }
    }
}

TEST(Covers, walks_end_where_it_is_not_known_what_is_covered) {
    // In a narrow gap rays hardly tell what is covered. No generation of a walk has more light than the one before, but where roulette
    // made it as much as the fewest rays can carry.
    constexpr uint64_t kFewest = 64;
    Session session(slabs_in_block(0.03f), {}, {});
    const DefensiveStarts starts = survey(session.accel(), 7);
    for (uint64_t seed = 1; seed <= 20; ++seed) {
        const Illumination light(session.accel(), starts, {.stream = seed});
        double before = power(session.scene(), light.emitters());
        walk(session.accel(), starts, light.emitters(), {.rays = 10000, .defensive = 0, .stream = seed}, [&](const Generation& g) {
            EXPECT_LE(power(session.scene(), g.next), g.transfers.shot > kFewest ? 1.00001 * before : INFINITY);
            before = power(session.scene(), g.next);
        });
    }
}

TEST(Covers, count_what_a_block_leaves_open) {
    const Scene scene = room_with_block(600, {0.31f, 0.33f, -0.1f}, {0.72f, 0.69f, 0.4f});
    const Accel accel(scene);
    const std::vector<Cover> covers = find_covers(accel, survey(accel, 7));
    ASSERT_EQ(covers.size(), scene.sides());
    double floor = 0;
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        const uint32_t triangle = scene.triangle_of_patch(patch);
        const Vec3 x = scene.position(scene.centre_of_patch(patch));
        if (scene.shape(triangle) == 0 && x.z < 1e-3f) floor += double{covers[patch].open_share} * double{scene.patch_area(patch)};
        // Inside of the block and outside of the room there is no light; walls and the ceiling are free.
        if (scene.shape(triangle) < 2) {
            EXPECT_EQ(covers[patch + scene.patches()].open_share, 0);
        }
        if (scene.shape(triangle) == 0 && x.z > 0.5f) {
            EXPECT_EQ(covers[patch].open_share, 1);
        }
    }
    EXPECT_NEAR(floor, 1 - 0.41 * 0.36, 0.01);
}

TEST(Covers, little_light_is_lost_under_a_block) {
    // What surfaces absorb is what the lamp sends. Patches a third as large as the block would lose 3 % of it without covers; with them,
    // less than 1 % and five standard errors of the mean over seeds.
    constexpr int kSeeds = 8;
    double sum = 0, squares = 0;
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
        Session session(room_with_block(200, {0.31f, 0.33f, -0.1f}, {0.72f, 0.69f, 0.4f}), {},
                        {.solver = {.direct_samples = 256, .seed = seed}});
        const double share = absorbed_share(session);
        sum += share, squares += share * share;
    }
    const double mean = sum / kSeeds, stderr_ = std::sqrt((squares / kSeeds - mean * mean) / (kSeeds - 1));
    EXPECT_GT(mean, 0.99 - 5 * stderr_);
    EXPECT_LT(mean, 1 + 5 * stderr_);
    EXPECT_LT(stderr_, 2e-3);
}

TEST(Covers, points_under_a_block_are_no_part_of_what_gathers) {
    // The density of areas that the block covers in part integrates to 1 over what is open of them: with 64 points that tell how much that
    // is, to 1 %, and five standard errors over seeds. It was 1.3 when points under the block counted.
    constexpr int kSeeds = 6;
    const Camera camera = camera_over_floor(0.5f);
    for (Transport transport : kTransports) {
        std::vector<double> densities;
        for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
            Session session(room_with_block(600, {0.31f, 0.33f, -0.1f}, {0.72f, 0.69f, 0.2f}, glossy(grey(0.4f), grey(0.4f), 0.2f)),
                            {camera}, {.solver = {.transport = transport, .gather = 4000, .seed = seed}});
            run_replica(session.solver(), {.solver = {.transport = transport}, .rays = 100000, .solve_rays = 50000});
            const PatchAreas& areas = session.solver().areas();
            double density = 0, size = 0;
            for (uint32_t area = 0; area < areas.size(); ++area) {
                const float open = session.scene().open_share(areas.sides()[area]);
                EXPECT_GT(open, 0);
                if (!(areas.albedo(0, area) > 0) || open == 1) continue;
                const double counts = areas.area(area) * areas.albedo(0, area);
                density += areas.samples(0, area).g * counts, size += counts;
            }
            ASSERT_GT(size, 0);
            densities.push_back(density / size);
        }
        const Mean mean = mean_of(densities);
        EXPECT_NEAR(mean.value, 1, 0.01 + 5 * mean.error) << name_of(transport);
        EXPECT_LT(mean.error, 0.02) << name_of(transport);
    }
}

TEST(Covers, light_over_a_thin_ceiling_is_not_seen_below) {
    // A sheet divides a room, and the patches of its walls: what is seen of these right under the sheet has no light from above it. It was
    // 80 % of that. What is left are the rays that such patches send from below the sheet.
    SceneBuilder b;
    b.shape(b.material(matt(kAlbedo))).box({0, 0, 0}, {1, 1, 1}, true);
    b.shape(b.material(matt(kAlbedo))).quad({0, 0, 0.517f}, {1, 0, 0}, {0, 1, 0});
    b.shape(b.material(matt(0)), grey(10)).quad({0.1f, 0.1f, 0.99f}, {0, 0.2f, 0}, {0.2f, 0, 0});
    Session session(b.build(1000), {}, {.solver = {.seed = 1}});
    run_replica(session.solver(), {.rays = 100000, .solve_rays = 50000});
    session.reconstruct();
    double above = 0, below = 0;
    for (int i = 1; i < 64; ++i)
        for (float offset : {0.004f, 0.012f, 0.02f}) {
            const auto at = [&](float z) {
                const Hit hit = session.accel().intersect({{0.5f, static_cast<float>(i) / 64, z}, {-1, 0, 0}});
                const Reconstruction& light = session.reconstruction();
                return double{lum(light.total_irradiance(light.stencil(hit.point(), hit.back)))};
            };
            above += at(0.517f + offset), below += at(0.517f - offset);
        }
    EXPECT_LT(below, 0.08 * above);
}

TEST(Covers, what_no_walk_meets_is_not_covered) {
    // A lamp far away, and a block that is small for it: no walk comes there, but the block sees the sky, the plane and the lamp. Its
    // inside sees the plane in which it stands, too, and is covered all the same.
    SceneBuilder b;
    b.shape(b.material(matt(kAlbedo))).quad({-3, -3, 0}, {6, 0, 0}, {0, 6, 0});
    b.shape(b.material(matt(kAlbedo))).box({-0.1f, -0.1f, -0.05f}, {0.1f, 0.1f, 0.2f}, false);
    b.shape(b.material(matt(0)), grey(1000)).quad({-400, -5, 300}, {0, 10, 0}, {10, 0, -10});
    const Scene scene = b.build(400);
    const Accel accel(scene);
    const DefensiveStarts starts = survey(accel, 7);
    const std::vector<Cover> covers = find_covers(accel, starts);
    for (uint32_t patch = 0; patch < scene.patches(); ++patch) {
        if (scene.shape(scene.triangle_of_patch(patch)) != 1) continue;
        EXPECT_TRUE(starts.reaches(scene, scene.triangle_of_patch(patch), false));
        EXPECT_GT(covers[patch].open_share, 0);
        EXPECT_EQ(covers[patch + scene.patches()].open_share, 0);
    }
}

/// Largest and least coordinate along an axis of the corners of a patch.
std::pair<float, float> extent(const Scene& scene, uint32_t patch, float Vec3::* axis) {
    float low = std::numeric_limits<float>::max(), high = -low;
    for (const Square& corner : scene.tessellation().corners(patch)) {
        const float at = scene.position({scene.triangle_of_patch(patch), corner.u, corner.v}).*axis;
        low = std::min(low, at), high = std::max(high, at);
    }
    return {low, high};
}

TEST(Covers, are_found_wherever_a_body_or_the_outside_of_a_room_is) {
    // A plane through blocks in the open, some of them side by side; or through the walls of a room, so that it lies in the dark outside.
    const auto covers_of = [](bool in_room, const auto& use) {
        SceneBuilder b;
        b.shape(b.material(matt(kAlbedo))).quad({-2, -2, 0}, {4, 0, 0}, {0, 4, 0});
        b.shape(b.material(matt(kAlbedo)));
        if (in_room)
            b.box({-1, -1, -1}, {1, 1, 1}, true);
        else
            for (const float x : {-1.5f, -0.9f, 0.5f, 1.2f}) b.box({x, -0.5f, -0.3f}, {x + 0.5f, 0.5f, 0.3f}, false);
        b.shape(b.material(matt(0)), grey(10)).quad({-0.1f, -0.1f, 0.9f}, {0, 0.2f, 0}, {0.2f, 0, 0});
        b.quad({-0.1f, -0.1f, -0.9f}, {0.2f, 0, 0}, {0, 0.2f, 0});
        const Scene scene = b.build(4000);
        const Accel accel(scene);
        const std::vector<Cover> covers = find_covers(accel, survey(accel, 7));
        ASSERT_EQ(covers.size(), scene.sides());
        for (uint32_t patch = 0; patch < scene.patches(); ++patch)
            if (scene.shape(scene.triangle_of_patch(patch)) == 0) use(scene, patch, covers[patch]);
    };
    uint32_t in = 0, out = 0, across = 0, found = 0;
    covers_of(false, [&](const Scene& scene, uint32_t patch, const Cover& cover) {
        const auto [x0, x1] = extent(scene, patch, &Vec3::x);
        const auto [y0, y1] = extent(scene, patch, &Vec3::y);
        bool is_in = false, is_out = true;
        for (const float x : {-1.5f, -0.9f, 0.5f, 1.2f}) {
            is_in |= x0 >= x && x1 <= x + 0.5f && y0 >= -0.5f && y1 <= 0.5f;
            is_out &= x1 <= x || x0 >= x + 0.5f || y1 <= -0.5f || y0 >= 0.5f;
        }
        if (is_in) {
            EXPECT_EQ(cover.open_share, 0);
            ++in;
        }
        if (is_out) {
            EXPECT_EQ(cover.open_share, 1);
            ++out;
        }
        across += !is_in && !is_out;
        found += !is_in && !is_out && cover.open_share < 1;
    });
    EXPECT_GT(in, 100u);
    EXPECT_GT(out, 500u);
    EXPECT_GT(across, 50u);
    EXPECT_GT(found, 0.8 * across);
    in = out = 0;
    uint32_t dark = 0;
    covers_of(true, [&](const Scene& scene, uint32_t patch, const Cover& cover) {
        const auto [x0, x1] = extent(scene, patch, &Vec3::x);
        const auto [y0, y1] = extent(scene, patch, &Vec3::y);
        if (x0 >= -1 && x1 <= 1 && y0 >= -1 && y1 <= 1) {
            EXPECT_EQ(cover.open_share, 1);
            ++in;
        }
        // Rays tell where they meet the wall from behind, so not far from it.
        if (x0 >= 1 && x1 <= 1.3f && y0 >= -1 && y1 <= 1) {
            dark += cover.open_share < 0.6f;
            ++out;
        }
    });
    EXPECT_GT(in, 100u);
    EXPECT_GT(out, 20u);
    EXPECT_GE(dark + 4, out) << "but at the corners of the room";
}

TEST(Covers, nothing_is_covered_in_an_open_scene) {
    SceneBuilder b;
    b.shape(b.material(matt(kAlbedo))).quad({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    b.shape(b.material(matt(0)), grey(10)).quad({0, 0, 1}, {0, 1, 0}, {1, 0, 0});
    const Scene scene = b.build(100);
    const Accel accel(scene);
    EXPECT_TRUE(find_covers(accel, survey(accel, 7)).empty());
}

}  // namespace lumel::test
