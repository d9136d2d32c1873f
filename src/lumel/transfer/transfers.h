// Transfers: light under way from one point to another, as it arrives; what transports make and areas of interest measure.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/math/vec.h"
#include "lumel/scene/scene.h"

namespace lumel {

/// One transfer (x, wi, L_in, p) that ended on a surface, in the form that measuring needs.
struct Transfer {
    static constexpr uint32_t kLost = 0xffffffffu;

    uint32_t side = kLost;  ///< side that holds x; kLost where the ray left the scene or carried no sample
    float u = 0, v = 0;     ///< barycentrics of x in its triangle
    Vec3 wi;                ///< where the light came from
    Rgb flux;               ///< L_in cos(theta_x) / (n p), W: what the transfer carries of the light, over n rays of one step
    float inv_pdf = 0;      ///< cos(theta_x) / (n p), m2 sr; 0: the transfer has no density, it stays outside all ratios
};

/// The transfers of one step in the order of their rays, and an order that groups them by side and keeps rays in order within.
class Transfers {
public:
    std::vector<Transfer> all;
    uint64_t rays = 0;            ///< n of the densities: rays shot from surfaces and the enclosing sphere
    uint64_t escaped = 0;         ///< rays that left the scene
    double lost_flux = 0;         ///< luminous part of the flux that left the scene, W

    void resize(uint32_t n) { all.resize(n), side_.resize(n); }
    void set(uint32_t ray, const Transfer& transfer) { all[ray] = transfer, side_[ray] = transfer.side; }
    /// Sort by side (counting sort, stable: the same order for any number of threads).
    void group_by_side(uint32_t sides);

    class Group;
    /// The transfers that landed on a side.
    Group group(uint32_t side) const;

private:
    static constexpr uint32_t kAhead = 8;

    std::vector<uint32_t> side_;   // of every ray again: sorting reads these alone
    std::vector<uint32_t> first_;  // sides + 1: group of side s is order_[first_[s]] .. order_[first_[s+1]]
    std::vector<uint32_t> order_;  // with kAhead more entries at the end
};

/// A range of transfers. Groups lie scattered in memory: going through them in the order of the sides fetches the next ones ahead.
class Transfers::Group {
public:
    class Iterator {
    public:
        Iterator(const Transfer* all, const uint32_t* at) : all_(all), at_(at) {}
        const Transfer& operator*() const { return all_[*at_]; }
        Iterator& operator++() {
            const auto* next = reinterpret_cast<const char*>(all_ + at_[kAhead]);
            __builtin_prefetch(next);
            __builtin_prefetch(next + sizeof(Transfer) - 1);
            ++at_;
            return *this;
        }
        bool operator==(const Iterator& other) const { return at_ == other.at_; }

    private:
        const Transfer* all_;
        const uint32_t* at_;
    };

    Group(const Transfer* all, std::span<const uint32_t> order) : all_(all), order_(order) {}
    size_t size() const { return order_.size(); }
    bool empty() const { return order_.empty(); }
    Iterator begin() const { return {all_, order_.data()}; }
    Iterator end() const { return {all_, order_.data() + order_.size()}; }

private:
    const Transfer* all_;
    std::span<const uint32_t> order_;
};

inline Transfers::Group Transfers::group(uint32_t side) const {
    return {all.data(), std::span(order_).subspan(first_[side], first_[side + 1] - first_[side])};
}

}  // namespace lumel
