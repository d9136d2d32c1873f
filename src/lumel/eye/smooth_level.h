// One level of smoothing: places with noisy light, and what touches what. The first level are sides of patches, the next are groups of
// those below.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lumel/eye/linear_fit.h"
#include "lumel/math/vec.h"

namespace lumel {

/// A side, or the mean of a group.
struct SmoothNode {
    Vec3 x, normal;       ///< the mean normal of a group is shorter than 1
    double area = 0;      ///< 0: takes no part
    Rgb64 light;
    double variance = 0;  ///< of its luminance
    double spread2 = 0;   ///< mean square distance of its area from x, m2

    double value() const { return lum(light); }
};

/// Do two nodes face about the same way?
inline bool are_alike(const SmoothNode& a, const SmoothNode& b) {
    constexpr float kSameSide = 0.8f;  // least cosine between their normals
    const float cosine = dot(a.normal, b.normal);
    return cosine > 0 && sqr(cosine) > sqr(kSameSide) * dot(a.normal, a.normal) * dot(b.normal, b.normal);
}

/// Lists of numbers, one a node.
class NodeLists {
public:
    /// Append the list of the next node.
    void add(std::span<const uint32_t> list) {
        all_.insert(all_.end(), list.begin(), list.end());
        first_.push_back(static_cast<uint32_t>(all_.size()));
    }
    /// Append the lists of more nodes.
    void add(const NodeLists& more) {
        const uint32_t before = first_.back();
        all_.insert(all_.end(), more.all_.begin(), more.all_.end());
        for (size_t i = 1; i < more.first_.size(); ++i) first_.push_back(before + more.first_[i]);
    }
    std::span<const uint32_t> of(uint32_t node) const { return {all_.data() + first_[node], all_.data() + first_[node + 1]}; }

private:
    std::vector<uint32_t> all_, first_{0};
};

/// Light that is about linear around a node, in its normal and its position.
struct LinearLight {
    Rgb64 light;
    std::array<Rgb64, kFitTerms - 1> slope{};  ///< by the normal, and by the position, 1/m
    double variance = 0;                       ///< of its luminance at the node
};

class SmoothLevel {
public:
    /// `touching`: for every node those that it touches and that face about the same way, itself among them.
    SmoothLevel(std::vector<SmoothNode> nodes, NodeLists touching);

    /// The light of all nodes without noise, as far as that can be told: see `smoothed`.
    std::vector<LinearLight> smooth() const;

private:
    struct Groups {
        NodeLists members;
        std::vector<uint32_t> of;  ///< per node
        uint32_t count = 0;
    };
    /// What a coarser level says at every node; empty where there is none.
    struct Coarse {
        std::vector<LinearLight> at;
        Groups groups;
        std::vector<double> unit;   ///< per node: variance of a unit of area
        std::vector<double> bias2;  ///< per group: square of what it is off beyond noise
    };
    /// A fit, and the numbers by which it followed the nodes.
    struct Fitted {
        LinearLight light;
        double used;
    };

    std::vector<uint32_t> rings(uint32_t node) const;
    /// Does their light differ by no more than noise explains? `unit`: variance of a unit of area.
    bool agree(uint32_t a, double unit_a, uint32_t b, double unit_b) const;
    double mean_unit(std::span<const uint32_t> nodes) const;
    /// Nodes around one that agree with it, itself first.
    std::vector<uint32_t> alike(uint32_t node) const;
    Groups groups() const;
    SmoothLevel merged(const Groups& groups) const;
    Coarse coarse() const;
    /// What the nodes around `node` say of the light at another place.
    LinearLight blended(const SmoothNode& at, uint32_t node, const std::vector<LinearLight>& lights) const;
    /// Rays bring about equal shares of the light, so the variance of what a unit of area received is in proportion to its light. What is
    /// measured of it around gives the factor, and the coarser level the light, since where few rays came most nodes have neither.
    std::vector<double> units(const Coarse& coarse, const SmoothLevel& above) const;
    std::vector<double> bias2(const Coarse& coarse, const SmoothLevel& above) const;
    /// `unit(node)`: variance of a unit of area. `scale`: of positions, 1/m.
    template <class Unit>
    Fitted fitted(uint32_t node, std::span<const uint32_t> around, const Unit& unit, double scale) const;
    LinearLight smooth(uint32_t node, const Coarse& coarse) const;

    struct Around {
        double value = 0, area = 0;
    };
    std::vector<SmoothNode> nodes_;
    NodeLists touching_;
    std::vector<Around> around_;  // means over all that touch: noise of single nodes is skewed, and picking by it would darken
};

}  // namespace lumel
