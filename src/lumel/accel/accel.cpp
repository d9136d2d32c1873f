#include "lumel/accel/accel.h"

#include <pmmintrin.h>
#include <xmmintrin.h>

#include <array>
#include <stdexcept>
#include <string>

#include "lumel/accel/embree.h"
#include "lumel/accel/packets.h"

namespace lumel {

namespace {

constexpr unsigned kFlush = _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON;

RTCRay to_embree(const Ray& ray) {
    RTCRay r;
    r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
    r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
    r.tnear = 0, r.tfar = ray.reach, r.time = 0;
    r.mask = 0xffffffffu, r.id = 0, r.flags = 0;
    return r;
}

Hit closest(RTCScene scene, const Ray& ray) {
    RTCRayHit query;
    query.ray = to_embree(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree::intersect(scene, query);
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const bool back = dot({query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}, ray.direction) > 0;
    return {query.hit.primID, query.hit.u, query.hit.v, back};
}

}  // namespace

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlush); }
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

struct Accel::Embree {
    RTCDevice device = nullptr;
    RTCScene all = nullptr, lamps = nullptr;
    bool wide = false;                     // does the processor hold sixteen rays side by side?
    std::vector<uint32_t> lamp_triangles;  // of the primitives of `lamps`

    ~Embree() {
        for (RTCScene scene : {all, lamps})
            if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
    /// A structure over triangles of a scene.
    RTCScene build(const Scene& scene, std::span<const Indices> triangles) const {
        RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
        // Embree reads 16 bytes from the last vertex on, so it gets a copy with its own padding.
        const auto& vertices = scene.vertices();
        auto* v = static_cast<Vec3*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), vertices.size()));
        auto* i = static_cast<Indices*>(
            rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Indices), triangles.size()));
        if (!v || !i) throw std::runtime_error("Embree is out of memory");
        std::copy(vertices.begin(), vertices.end(), v);
        std::copy(triangles.begin(), triangles.end(), i);
        rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
        rtcCommitGeometry(geometry);
        RTCScene built = rtcNewScene(device);
        rtcSetSceneFlags(built, RTC_SCENE_FLAG_ROBUST);
        rtcSetSceneBuildQuality(built, RTC_BUILD_QUALITY_MEDIUM);
        rtcAttachGeometry(built, geometry);
        rtcReleaseGeometry(geometry);
        rtcCommitScene(built);
        return built;
    }
};

bool has(Isa isa) {
    // What Embree asks for.
    if (isa == Isa::kAvx2) return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi2");
    return has(Isa::kAvx2) && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
}

Accel::Accel(const Scene& scene, Isa isa) : scene_(&scene), embree_(std::make_unique<Embree>()) {
    if (!has(isa)) throw std::invalid_argument(isa == Isa::kAvx2 ? "this processor has no AVX2" : "this processor has no AVX-512");
    embree_->device = rtcNewDevice(isa == Isa::kAvx2 ? "isa=avx2" : "isa=avx512");
    if (!embree_->device) throw std::runtime_error("Embree cannot be started (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
    embree_->wide = isa == Isa::kAvx512;
    embree_->all = embree_->build(scene, scene.indices());
    std::vector<Indices> lamps;
    for (const AreaLamp& lamp : scene.area_lamps())
        for (uint32_t triangle : lamp.triangles) embree_->lamp_triangles.push_back(triangle), lamps.push_back(scene.indices()[triangle]);
    if (!lamps.empty()) embree_->lamps = embree_->build(scene, lamps);
    if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree cannot build the scene (error " + std::to_string(error) + ")");
}

Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;

Hit Accel::intersect(const Ray& ray) const { return closest(embree_->all, ray); }

Hit Accel::intersect_lamps(const Ray& ray) const {
    if (!embree_->lamps) return {};
    Hit hit = closest(embree_->lamps, ray);
    if (!hit.is_miss()) hit.triangle = embree_->lamp_triangles[hit.triangle];
    return hit;
}

void Accel::intersect_lamps(const RayBlock& rays, HitBlock& hits) const {
    if (!embree_->lamps) {
        std::fill_n(hits.triangle.begin(), rays.size, Hit::kMiss);
        return;
    }
    packets::intersect(embree_->lamps, embree_->wide, rays, Coherence::kNone, hits);
    for (uint32_t i = 0; i < rays.size; ++i)
        if (hits.triangle[i] != Hit::kMiss) hits.triangle[i] = embree_->lamp_triangles[hits.triangle[i]];
}

void Accel::intersect(const RayBlock& rays, HitBlock& hits, Coherence coherence) const {
    packets::intersect(embree_->all, embree_->wide, rays, coherence, hits);
}

bool Accel::occluded(const Ray& ray) const {
    RTCRay query = to_embree(ray);
    embree::occluded(embree_->all, query);
    return query.tfar < 0;
}

void Accel::occluded(const RayBlock& segments, BlockedBlock& blocked) const { packets::occluded(embree_->all, segments, blocked); }

}  // namespace lumel
