// Every transport with every estimator, gathering or not, on every analytic scene; and equal bytes for any number of threads.
#include <gtest/gtest.h>

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <cstring>

#include "lobe.h"
#include "lumel/solver/session.h"

using namespace lumel;
using namespace lumel::test;

TEST(Matrix, every_transport_area_and_estimator_on_every_analytic_scene) {
    struct Analytic {
        std::string name;
        PatchInSphere scene;
        bool is_reflecting;  // else there is nothing left after the first shot
    };
    const Analytic scenes[] = {
        {"even, grey", {0.5f, 0.3f, even}, true}, {"ramp, grey", {0.6f, 0.15f, ramp}, true}, {"ramp, black", {0, 0.4f, ramp}, false}};
    constexpr int kTests = 5 * 2 * 2 * 4;
    for (const Analytic& analytic : scenes)
        for (Transport transport : kTransports)
            for (bool first_shot : {false, true})
                for (float gather : {0.0f, 2.0f}) {
                    if (first_shot && !analytic.is_reflecting) continue;
                    const SolverConfig config{
                        .transport = transport, .defensive = 0.3f, .gather = gather, .first_shot = first_shot, .seed = 31};
                    expect_truth(ratios_to_truth(analytic.scene, {config}), kTests,
                                 analytic.name + ", " + name_of(transport) + (first_shot ? ", first shot" : "") +
                                     (gather > 0 ? ", gathering" : ""));
                }
}

TEST(Estimators, are_found_by_name) {
    for (const Estimator& e : estimators()) {
        EXPECT_EQ(find_estimator(e.name), &e);
        EXPECT_FALSE(e.summary.empty());
        // Without a sample nothing is NaN, and a ratio says that it stands for nothing.
        const Estimate nothing = e.estimate({});
        EXPECT_EQ(lum(nothing.value), 0);
        EXPECT_EQ(lum(nothing.variance), 0);
    }
    EXPECT_FALSE(find_estimator("weighted")->estimate({}).valid);
    EXPECT_EQ(find_estimator("no such"), nullptr);
}

TEST(Estimators, weighted_is_the_ratio_with_its_linearised_variance) {
    const Samples s{.f = {2, 4, 6},
                    .g = 0.5,
                    .plain = {1, 0, 0},
                    .var_f = {0.1, 0.2, 0.3},
                    .cov_fg = {0.01, 0.02, 0.03},
                    .var_plain = {0.5, 0, 0},
                    .var_g = 0.004,
                    .hits = 9};
    const Estimate w = find_estimator("weighted")->estimate(s), c = find_estimator("classical")->estimate(s);
    EXPECT_DOUBLE_EQ(w.value.x, 5);
    EXPECT_DOUBLE_EQ(w.value.z, 12);
    EXPECT_NEAR(w.variance.x, (0.1 - 2 * 4 * 0.01 + 16 * 0.004) / 0.25 + 0.5, 1e-12);
    EXPECT_DOUBLE_EQ(c.value.x, 3);
    EXPECT_DOUBLE_EQ(c.variance.x, 0.6);
}

namespace {

template <class T>
void append(std::string& bytes, const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// All channels of a small render, as bytes.
std::string render(Transport transport, int threads) {
    const tbb::global_control control(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(threads));
    tbb::task_arena arena(threads);
    std::string bytes;
    arena.execute([&] {
        SceneBuilder b;
        const uint32_t wall = b.material(matt(0.5f)), gloss = b.material(glossy(grey(0.2f), {0.7f, 0.5f, 0.3f}, 0.2f)),
                       mirrors = b.material(mirror(0.9f));
        b.shape(wall).face(0, {0, 0, 0}, {1, 1, 1}, true).face(2, {0, 0, 0}, {1, 1, 1}, true).face(3, {0, 0, 0}, {1, 1, 1}, true);
        b.shape(gloss).face(4, {0, 0, 0}, {1, 1, 1}, true).sphere({0.5f, 0.5f, 0.3f}, 0.2f, 2, false, true);
        b.shape(mirrors).face(1, {0, 0, 0}, {1, 1, 1}, true);
        b.shape(wall, grey(5)).quad({0.3f, 0.3f, 0.9f}, {0, 0.3f, 0}, {0.3f, 0, 0});
        b.point_lamp({0.2f, 0.8f, 0.7f}, {0.1f, 0.2f, 0.3f});
        const Camera camera{.origin = {0.1f, 0.1f, 0.6f},
                            .right = normalize({1, -1, 0}),
                            .up = {0, 0, 1},
                            .forward = normalize({1, 1, 0}),
                            .tan_x = 0.9f,
                            .tan_y = 0.6f,
                            .width = 24,
                            .height = 16};
        Session session(b.build(2000), {camera}, {.solver = {.transport = transport, .defensive = 0.2f, .gather = 0.5f, .seed = 77}});
        for (int replica = 0; replica < 2; ++replica) {
            session.solver().begin_replica(20000);
            for (int step = 0; step < 3; ++step) session.solver().step(work_of(transport, 30000));
            session.solver().end_replica();
        }
        for (const SideField& field : {session.solver().indirect(), session.solver().direct()})
            append(bytes, field.mean), append(bytes, field.variance);
        const PatchAreas& areas = session.solver().areas();
        std::vector<Rgb64> f;
        std::vector<double> g;
        for (uint32_t area = 0; area < areas.size(); ++area) {
            const Samples s = areas.samples(0, area);
            f.insert(f.end(), {s.f, s.plain, s.var_f, s.cov_fg}), g.insert(g.end(), {s.g, s.var_g, static_cast<double>(s.hits)});
        }
        append(bytes, f), append(bytes, g);
        const SolverStats& stats = session.solver().stats();
        append(bytes, std::vector<double>{static_cast<double>(stats.rays), static_cast<double>(stats.escaped), stats.lost_flux});
        session.reconstruct();
        for (int pass = 0; pass < 3; ++pass) EXPECT_TRUE(session.eye_pass(0, 4));
        const Film& film = session.film(0);
        append(bytes, film.sum);
        std::vector<Rgb> corrected;
        for (size_t pixel = 0; pixel < film.pixels(); ++pixel)
            corrected.insert(corrected.end(), {film.mean(pixel).radiance(), film.standard_error(pixel)});
        append(bytes, corrected);
    });
    return bytes;
}

}  // namespace

TEST(Determinism, equal_bytes_for_any_number_of_threads) {
    for (Transport transport : kTransports) {
        const std::string one = render(transport, 1);
        EXPECT_GT(one.size(), 100000u);
        for (int threads : {1, 2, 8})
            EXPECT_TRUE(render(transport, threads) == one) << name_of(transport) << " with " << threads << " threads";
    }
    EXPECT_FALSE(render(Transport::kWalk, 2) == render(Transport::kRays, 2));
}
