// Three hot paths on a small scene, one at a time, for a profiler that counts instructions (see kernels.py).
#include <tbb/global_control.h>

#include <cstdio>
#include <cstring>

#include "lumel/solver/session.h"
#include "scenes.h"

using namespace lumel;

namespace {

constexpr uint64_t kRays = 1 << 16;

/// A glossy ball in a closed room with a glossy floor, seen by as many eyes.
Session room(uint32_t eyes) {
    test::SceneBuilder b;
    const uint32_t wall = b.material(test::matt(0.6f)), gloss = b.material(test::glossy(test::grey(0.2f), test::grey(0.5f), 0.15f));
    for (int face : {0, 1, 3, 4, 5}) b.shape(wall).face(face, {-1, -1, -1}, {1, 1, 1}, true);
    b.shape(gloss).face(2, {-1, -1, -1}, {1, 1, 1}, true);
    b.shape(wall, {8, 8, 8}).face(2, {-0.25f, 0.98f, -0.25f}, {0.25f, 0.99f, 0.25f}, false);
    b.shape(gloss).sphere({0, -0.3f, 0}, 0.5f, 4, false, true);
    std::vector<Camera> cameras;
    for (uint32_t i = 0; i < eyes; ++i) {
        const Vec3 origin{0.05f * static_cast<float>(i), 0, 0.95f};
        cameras.push_back({.origin = origin, .right = {1, 0, 0}, .up = {0, 1, 0}, .forward = {0, 0, -1}, .width = 64, .height = 48});
    }
    SessionConfig config;
    config.solver.defensive = -1;
    return Session(b.build(10000), std::move(cameras), config);
}

}  // namespace

// The profiler counts what happens inside these two, by their names.
extern "C" {
[[gnu::noinline]] void counted_step(Session& session) { session.solver().step(kRays); }
[[gnu::noinline]] void counted_eye_pass(Session& session) { session.eye_pass(0, 8); }
}

int main(int count, char** arguments) {
    const char* kernel = count == 2 ? arguments[1] : "";
    const bool one = std::strcmp(kernel, "shoot") == 0, many = std::strcmp(kernel, "shoot-16") == 0, eye = std::strcmp(kernel, "eye") == 0;
    if (!one && !many && !eye) {
        std::fprintf(stderr, "usage: lumel_kernels shoot|shoot-16|eye\n");
        return 2;
    }
    const tbb::global_control serial(tbb::global_control::max_allowed_parallelism, 1);
    Session session = room(many ? 16 : 1);
    session.solver().begin_replica(kRays);
    if (eye)
        session.solver().step(kRays);
    else
        counted_step(session);
    session.solver().end_replica();
    if (!eye) return 0;
    session.reconstruct();
    counted_eye_pass(session);
    return 0;
}
