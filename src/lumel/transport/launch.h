// How the rays of a shot leave: drawn block by block, with what each of them carries.
#pragma once

#include <optional>

#include "lumel/transport/shot.h"
#include "lumel/transport/side_source.h"

namespace lumel {

/// Rays under way with what they carry. One that carries nothing is not traced.
struct Flights {
    static constexpr uint32_t kMost = RayBlock::kMost, kRoom = RayBlock::kRoom;

    RayBlock rays;
    Vec3Array<kRoom> flux;                         ///< W
    Vec3Array<kRoom> behind_mirror;                ///< W that counts once a mirror has been passed
    alignas(32) std::array<float, kRoom> inv_pdf;  ///< cos(theta) / (n p), m2 sr; 0 for light that has no density
    std::array<bool, kRoom> covered;               ///< whether no light can reach where the ray starts
};

/// Launches the rays of a shot. What a ray does depends on its index alone.
class Launcher {
public:
    explicit Launcher(const Shot& shot);

    /// Launch `count` rays from index `first` on, Flights::kMost at most.
    void operator()(uint32_t first, uint32_t count, Flights& flights);

private:
    struct Block;
    uint32_t by_power(Block& block, uint32_t i, uint32_t end);
    uint32_t by_area(Block& block, uint32_t i, uint32_t end);
    uint32_t from_sky(Block& block, uint32_t i) const;
    uint32_t from_point_lamp(Block& block, uint32_t i) const;
    /// What owns positions from `before` to `upto`: a side, or a part of one.
    struct Owner {
        uint32_t side, part;
        double before, upto;
    };
    template <class WeightOf>
    Owner owner(const Distribution& shares, double position, const WeightOf& weight_of) const;
    void choose(const Owner& owner, const Block& block, uint32_t i, uint32_t end);
    void leave(Block& block, uint32_t i);

    const Shot& shot_;
    uint64_t point_stream_, direction_stream_;
    double offset_;  // of all systematic choices, in rays
    std::optional<SideSource> source_;
    Leaving leaving_{};
};

}  // namespace lumel
