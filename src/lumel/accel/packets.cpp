#include "lumel/accel/packets.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace lumel::packets {

namespace {

template <uint32_t kWidth>
struct Packet;
template <>
struct Packet<8> {
    using Rays = RTCRay8;
    using RayHits = RTCRayHit8;
};
template <>
struct Packet<16> {
    using Rays = RTCRay16;
    using RayHits = RTCRayHit16;
};

constexpr uint32_t kWidest = 16;
constexpr uint16_t kNobody = RayBlock::kMost;  // fills the last packet
static_assert(kNobody == RayBlock::kMost && kNobody < RayBlock::kRoom);
/// Rays of a block in the order in which they enter packets.
using Order = std::array<uint16_t, RayBlock::kMost + kWidest>;

void in_order_of_index(const RayBlock& rays, Order& order) { std::iota(order.begin(), order.begin() + rays.size, uint16_t{0}); }

/// Rays that go nearly the same way come together, by the signs of their directions and the largest axis: they meet much the same nodes of
/// the hierarchy, in the same order.
void in_order_of_direction(const RayBlock& rays, Order& order) {
    constexpr size_t kWays = 24;
    std::array<uint8_t, RayBlock::kMost> way;
    for (uint32_t i = 0; i < rays.size; ++i) {
        const Vec3 w = rays.direction[i];
        const float x = std::abs(w.x), y = std::abs(w.y), z = std::abs(w.z);
        const int axis = z > std::max(x, y) ? 16 : y > x ? 8 : 0;
        way[i] = static_cast<uint8_t>(axis + (w.x < 0 ? 1 : 0) + (w.y < 0 ? 2 : 0) + (w.z < 0 ? 4 : 0));
    }
    std::array<uint16_t, kWays + 1> place{};
    for (uint32_t i = 0; i < rays.size; ++i) ++place[way[i] + size_t{1}];
    std::partial_sum(place.begin(), place.end(), place.begin());
    for (uint32_t i = 0; i < rays.size; ++i) order[place[way[i]]++] = static_cast<uint16_t>(i);
}

/// Hand the rays to `trace(valid, order)` packet by packet, with those of `query` filled in.
template <uint32_t kWidth, class Trace>
void for_each_packet(const RayBlock& rays, Coherence coherence, float reach, typename Packet<kWidth>::Rays& query, const Trace& trace) {
    Order order;
    if (coherence == Coherence::kOrigins)
        in_order_of_direction(rays, order);
    else
        in_order_of_index(rays, order);
    std::fill_n(order.begin() + rays.size, kWidest, kNobody);
    for (uint32_t k = 0; k < kWidth; ++k)
        query.tnear[k] = 0, query.time[k] = 0, query.mask[k] = 0xffffffffu, query.id[k] = 0, query.flags[k] = 0;
    alignas(64) std::array<int, kWidth> valid;
    for (uint32_t first = 0; first < rays.size; first += kWidth) {
        const uint16_t* ray = &order[first];
        for (uint32_t k = 0; k < kWidth; ++k) {
            const uint32_t i = ray[k];
            valid[k] = i != kNobody ? rays.traced[i] : 0;
            query.org_x[k] = rays.origin.x[i], query.org_y[k] = rays.origin.y[i], query.org_z[k] = rays.origin.z[i];
            query.dir_x[k] = rays.direction.x[i], query.dir_y[k] = rays.direction.y[i], query.dir_z[k] = rays.direction.z[i];
            query.tfar[k] = reach;
        }
        trace(valid.data(), ray);
    }
}

template <uint32_t kWidth>
void intersect(RTCScene scene, const RayBlock& rays, Coherence coherence, HitBlock& hits) {
    typename Packet<kWidth>::RayHits query{};
    for_each_packet<kWidth>(rays, coherence, INFINITY, query.ray, [&](const int* valid, const uint16_t* ray) {
        for (uint32_t k = 0; k < kWidth; ++k) query.hit.geomID[k] = query.hit.instID[0][k] = query.hit.primID[k] = RTC_INVALID_GEOMETRY_ID;
        embree::intersect(valid, scene, coherence != Coherence::kNone, query);
        for (uint32_t k = 0; k < kWidth; ++k) {
            const uint32_t i = ray[k];
            const float along = query.hit.Ng_x[k] * query.ray.dir_x[k] + query.hit.Ng_y[k] * query.ray.dir_y[k] +
                                query.hit.Ng_z[k] * query.ray.dir_z[k];
            hits.triangle[i] = query.hit.primID[k];
            hits.u[i] = query.hit.u[k], hits.v[i] = query.hit.v[k], hits.back[i] = along > 0;
        }
    });
}

}  // namespace

void intersect(RTCScene scene, bool wide, const RayBlock& rays, Coherence coherence, HitBlock& hits) {
    if (wide && coherence != Coherence::kNone)
        intersect<16>(scene, rays, coherence, hits);
    else
        intersect<8>(scene, rays, coherence, hits);
}

void occluded(RTCScene scene, const RayBlock& segments, BlockedBlock& blocked) {
    RTCRay8 query{};
    for_each_packet<8>(segments, Coherence::kNone, 1, query, [&](const int* valid, const uint16_t* ray) {
        embree::occluded(valid, scene, query);
        for (uint32_t k = 0; k < 8; ++k) blocked[ray[k]] = query.tfar[k] < 0;
    });
}

}  // namespace lumel::packets
