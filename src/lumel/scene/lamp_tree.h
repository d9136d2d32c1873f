// A binary tree over the lamps of a scene: among very many, one is chosen from the root downwards.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/math/vec.h"

namespace lumel {

/// What the tree needs of a lamp.
struct LampBall {
    Vec3 centre;
    float radius = 0;  ///< all of the lamp is within it, m
    float power = 0;   ///< lum, in one measure for all lamps
};

/// Lamps that are near each other share a node. Leaves hold one lamp each.
class LampTree {
public:
    static constexpr uint32_t kNone = 0xffffffffu;
    struct Node {
        LampBall ball;
        uint32_t parent = kNone;
        uint32_t left = kNone, right = kNone;  ///< kNone in a leaf
        uint32_t lamp = kNone;                 ///< of a leaf

        bool is_leaf() const { return left == kNone; }
    };

    LampTree() = default;
    explicit LampTree(std::span<const LampBall> lamps);

    const Node& node(uint32_t index) const { return nodes_[index]; }
    /// The root is node 0; there is none without lamps.
    bool is_empty() const { return nodes_.empty(); }
    uint32_t leaf_of(uint32_t lamp) const { return leaf_[lamp]; }
    uint32_t sibling(uint32_t index) const {
        const Node& parent = nodes_[nodes_[index].parent];
        return parent.left == index ? parent.right : parent.left;
    }

private:
    uint32_t build(std::span<const LampBall> lamps, std::span<uint32_t> of, uint32_t parent);

    std::vector<Node> nodes_;
    std::vector<uint32_t> leaf_;  // per lamp
};

}  // namespace lumel
