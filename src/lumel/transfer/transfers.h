// Transfers: light under way from one point to another, as it arrives; what transports make and areas of interest measure.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lumel/math/buffer.h"
#include "lumel/scene/scene.h"
#include "lumel/transfer/by_side.h"

namespace lumel {

/// What a transfer (x, wi, L_in, p) carries. It is all that counts on a plain side (see Scene::is_plain).
struct Carried {
    Rgb flux;           ///< L_in cos(theta_x) / (n p), W: what the transfer carries of the light, over n rays of one step
    float inv_pdf = 0;  ///< cos(theta_x) / (n p), m2 sr; 0: the transfer has no density, it stays outside all ratios
};

/// One transfer that ended on a surface, with the place, in the form that measuring needs.
struct Transfer : Carried {
    float u = 0, v = 0;  ///< barycentrics of x in its triangle
    Vec3 wi;             ///< where the light came from
};

/// The transfers of a block of rays in the order of these: those that ended on plain sides, and all others with their places.
struct TransferBlock {
    static constexpr uint32_t kMost = 2048;

    uint32_t plain_size, placed_size;
    std::array<uint32_t, kMost> plain_side, placed_side;
    std::array<Carried, kMost> plain;
    std::array<Transfer, kMost> placed;

    BySide<Carried>::List plain_list() const { return {{plain_side.data(), plain_size}, {plain.data(), plain_size}}; }
    BySide<Transfer>::List placed_list() const { return {{placed_side.data(), placed_size}, {placed.data(), placed_size}}; }
};

/// The transfers of one step, by the side that they ended on.
class Transfers {
public:
    uint64_t shot = 0;      ///< rays of the step
    uint64_t rays = 0;      ///< n of the densities: rays shot from surfaces and the enclosing sphere
    uint64_t escaped = 0;   ///< rays that left the scene
    double lost_flux = 0;   ///< luminous part of the flux that left the scene, W

    /// Make room for `blocks` blocks of rays, each to be written (by any thread).
    void open(size_t blocks);
    TransferBlock& block(size_t i) { return blocks_[i]; }
    /// Sort what was written by side, and sum what plain sides got: the same for any number of threads.
    void group_by_side(uint32_t sides);

    /// How many landed on a side.
    size_t arrivals(uint32_t side) const { return placed(side).size() + plain_[side].arrivals; }
    /// Flux that a side got if it is plain, W; 0 otherwise.
    Rgb64 plain_flux(uint32_t side) const { return plain_[side].flux; }
    /// Those that landed on any other side, in the order of their rays.
    std::span<const Transfer> placed(uint32_t side) const { return placed_.of(side); }

    /// Group what landed on plain sides one by one as well, into `sorted`: few ask for it.
    void group_plain(BySide<Carried>& sorted) const;

private:
    struct Sum {
        Rgb64 flux;
        uint64_t arrivals = 0;
    };
    void sum_plain(uint32_t sides);

    size_t size_ = 0;  // blocks of this step
    Buffer<TransferBlock> blocks_;
    BySide<Transfer> placed_;
    std::vector<Sum> plain_;  // per side
    Buffer<Sum> parts_;       // of parts of the blocks
};

}  // namespace lumel
