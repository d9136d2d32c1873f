#include "lumel/accel/accel.h"

#include <pmmintrin.h>
#include <xmmintrin.h>

#include <array>
#include <stdexcept>
#include <string>

#ifdef LUMEL_EMBREE4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

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

}  // namespace

FlushDenormals::FlushDenormals() : saved_(_mm_getcsr()) { _mm_setcsr(saved_ | kFlush); }
FlushDenormals::~FlushDenormals() { _mm_setcsr(saved_); }

struct Accel::Embree {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;

    ~Embree() {
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }
};

Accel::Accel(const Scene& scene) : scene_(&scene), embree_(std::make_unique<Embree>()) {
    embree_->device = rtcNewDevice(nullptr);
    if (!embree_->device) throw std::runtime_error("Embree cannot be started (error " + std::to_string(rtcGetDeviceError(nullptr)) + ")");
    RTCGeometry geometry = rtcNewGeometry(embree_->device, RTC_GEOMETRY_TYPE_TRIANGLE);

    // Embree reads 16 bytes from the last vertex on, so it gets a copy with its own padding.
    const auto& vertices = scene.vertices();
    auto* v = static_cast<Vec3*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), vertices.size()));
    auto* i = static_cast<Indices*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Indices), scene.triangles()));
    if (!v || !i) throw std::runtime_error("Embree is out of memory");
    std::copy(vertices.begin(), vertices.end(), v);
    std::copy(scene.indices().begin(), scene.indices().end(), i);
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_MEDIUM);
    rtcCommitGeometry(geometry);
    embree_->scene = rtcNewScene(embree_->device);
    rtcSetSceneFlags(embree_->scene, RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(embree_->scene, RTC_BUILD_QUALITY_MEDIUM);
    rtcAttachGeometry(embree_->scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(embree_->scene);
    if (const RTCError error = rtcGetDeviceError(embree_->device); error != RTC_ERROR_NONE)
        throw std::runtime_error("Embree cannot build the scene (error " + std::to_string(error) + ")");
}

Accel::~Accel() = default;
Accel::Accel(Accel&&) noexcept = default;

Hit Accel::intersect(const Ray& ray) const {
    RTCRayHit query;
    query.ray = to_embree(ray);
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
#ifdef LUMEL_EMBREE4
    rtcIntersect1(embree_->scene, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(embree_->scene, &context, &query);
#endif
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
    const bool back = dot({query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z}, ray.direction) > 0;
    return {query.hit.primID, query.hit.u, query.hit.v, back};
}

void Accel::intersect(const RayBlock& rays, HitBlock& hits) const {
    constexpr uint32_t kLanes = 8;
    RTCRayHit8 query{};
    alignas(32) std::array<int, kLanes> valid;
    for (uint32_t first = 0; first < rays.size; first += kLanes) {
        for (uint32_t k = 0; k < kLanes; ++k) {
            const uint32_t i = first + k;
            valid[k] = i < rays.size ? rays.traced[i] : 0;
            query.ray.org_x[k] = rays.origin.x[i], query.ray.org_y[k] = rays.origin.y[i], query.ray.org_z[k] = rays.origin.z[i];
            query.ray.dir_x[k] = rays.direction.x[i], query.ray.dir_y[k] = rays.direction.y[i], query.ray.dir_z[k] = rays.direction.z[i];
            query.ray.tnear[k] = 0, query.ray.tfar[k] = INFINITY, query.ray.time[k] = 0;
            query.ray.mask[k] = 0xffffffffu, query.ray.id[k] = 0, query.ray.flags[k] = 0;
            query.hit.geomID[k] = query.hit.instID[0][k] = query.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
        }
#ifdef LUMEL_EMBREE4
        rtcIntersect8(valid.data(), embree_->scene, &query);
#else
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        rtcIntersect8(valid.data(), embree_->scene, &context, &query);
#endif
        for (uint32_t k = 0; k < kLanes; ++k) {
            const uint32_t i = first + k;
            const float along = query.hit.Ng_x[k] * query.ray.dir_x[k] + query.hit.Ng_y[k] * query.ray.dir_y[k] +
                                query.hit.Ng_z[k] * query.ray.dir_z[k];
            hits.triangle[i] = query.hit.primID[k];
            hits.u[i] = query.hit.u[k], hits.v[i] = query.hit.v[k], hits.back[i] = along > 0;
        }
    }
}

bool Accel::occluded(const Ray& ray) const {
    RTCRay query = to_embree(ray);
#ifdef LUMEL_EMBREE4
    rtcOccluded1(embree_->scene, &query);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(embree_->scene, &context, &query);
#endif
    return query.tfar < 0;
}

}  // namespace lumel
