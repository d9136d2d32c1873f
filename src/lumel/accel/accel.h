// Ray queries against the undivided triangles of a scene.
#pragma once

#include <array>
#include <memory>
#include <utility>

#include "lumel/math/vec_array.h"
#include "lumel/scene/scene.h"

namespace lumel {

struct Ray {
    Vec3 origin, direction;  ///< any length of direction; `reach` counts in it
    float reach = INFINITY;
};

struct Hit {
    static constexpr uint32_t kMiss = 0xffffffffu;

    uint32_t triangle = kMiss;
    float u = 0, v = 0;
    bool back = false;  ///< the ray came from behind the triangle

    bool is_miss() const { return triangle == kMiss; }
    SurfacePoint point() const { return {triangle, u, v}; }
};

/// Rays side by side, for many queries at once.
struct RayBlock {
    static constexpr uint32_t kMost = 2048, kRoom = kMost + kSideBySide;

    uint32_t size = 0;
    Vec3Array<kRoom> origin, direction;
    alignas(32) std::array<int32_t, kRoom> traced;  ///< -1, or 0 for a ray that is left out

    Ray operator[](uint32_t i) const { return {origin[i], direction[i]}; }
    void push(Vec3 from, Vec3 along) {
        origin.set(size, from), direction.set(size, along);
        traced[size++] = -1;
    }
    bool is_full() const { return size == kMost; }
};

/// What the rays of a block hit; what was left out misses.
struct HitBlock {
    static constexpr uint32_t kRoom = RayBlock::kRoom;

    alignas(32) std::array<uint32_t, kRoom> triangle;
    alignas(32) std::array<float, kRoom> u, v;
    alignas(32) std::array<int32_t, kRoom> back;

    Hit operator[](uint32_t i) const { return {triangle[i], u[i], v[i], back[i] != 0}; }
    void set(uint32_t i, const Hit& hit) { triangle[i] = hit.triangle, u[i] = hit.u, v[i] = hit.v, back[i] = hit.back; }
};
/// Which segments of a block are blocked.
using BlockedBlock = std::array<bool, RayBlock::kRoom>;

/// Flush denormals on this thread while it traces, as Embree wants.
class FlushDenormals {
public:
    FlushDenormals();
    ~FlushDenormals();
    FlushDenormals(const FlushDenormals&) = delete;
    FlushDenormals& operator=(const FlushDenormals&) = delete;

private:
    unsigned saved_;
};

/// What neighbours in a block have in common: nothing that helps, about their origins alone, so that they are traced in the order of their
/// directions, or their directions too, as rays from one eye have.
enum class Coherence { kNone, kOrigins, kRays };

/// Instruction sets that Embree traces with. Where rays meet edges, and in the last digits of hits, they differ by rounding.
enum class Isa { kAvx2, kAvx512 };
inline constexpr std::array<std::pair<const char*, Isa>, 2> kIsas{{{"avx2", Isa::kAvx2}, {"avx512", Isa::kAvx512}}};
/// Does this processor have it?
bool has(Isa isa);
/// The fastest that this processor has.
inline Isa best_isa() { return has(Isa::kAvx512) ? Isa::kAvx512 : Isa::kAvx2; }

/// An acceleration structure; safe to use from many threads.
class Accel {
public:
    /// Build over `scene`, which must outlive the structure, to trace with `isa`, which this processor must have.
    explicit Accel(const Scene& scene, Isa isa = best_isa());
    ~Accel();
    Accel(Accel&&) noexcept;

    Hit intersect(const Ray& ray) const;
    /// Closest hits of all rays of a block, many at a time: faster than one by one where neighbours start near each other.
    void intersect(const RayBlock& rays, HitBlock& hits, Coherence coherence = Coherence::kOrigins) const;
    /// Closest hit among the area lamps, as if there were nothing else.
    Hit intersect_lamps(const Ray& ray) const;
    void intersect_lamps(const RayBlock& rays, HitBlock& hits) const;
    bool occluded(const Ray& ray) const;
    /// For all rays of a block that are traced, whether anything is met between origin and origin + direction.
    void occluded(const RayBlock& segments, BlockedBlock& blocked) const;
    /// Do two points see each other? Both must already be off their surfaces.
    bool visible(Vec3 a, Vec3 b) const { return !occluded({a, b - a, 1.0f}); }

    const Scene& scene() const { return *scene_; }

private:
    struct Embree;
    const Scene* scene_;
    std::unique_ptr<Embree> embree_;
};

}  // namespace lumel
