#include "lumel/scene/lamp_tree.h"

#include <numeric>

namespace lumel {

LampTree::LampTree(std::span<const LampBall> lamps) : leaf_(lamps.size()) {
    std::vector<uint32_t> all(lamps.size());
    std::iota(all.begin(), all.end(), 0u);
    nodes_.reserve(2 * lamps.size());
    if (!all.empty()) build(lamps, all, kNone);
}

uint32_t LampTree::build(std::span<const LampBall> lamps, std::span<uint32_t> of, uint32_t parent) {
    const auto index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back({.parent = parent});
    if (of.size() == 1) {
        nodes_[index].ball = lamps[of[0]], nodes_[index].lamp = of[0];
        return leaf_[of[0]] = index;
    }

    // Split at the median along the longest side of the box around the centres.
    Vec3 lower = lamps[of[0]].centre, upper = lower;
    for (uint32_t lamp : of) lower = min(lower, lamps[lamp].centre), upper = max(upper, lamps[lamp].centre);
    const Vec3 size = upper - lower;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const size_t half = of.size() / 2;
    std::nth_element(of.begin(), of.begin() + static_cast<std::ptrdiff_t>(half), of.end(), [&](uint32_t a, uint32_t b) {
        const float ca = lamps[a].centre[axis], cb = lamps[b].centre[axis];
        return ca < cb || (ca == cb && a < b);
    });
    const uint32_t left = build(lamps, of.first(half), index), right = build(lamps, of.subspan(half), index);
    const LampBall &a = nodes_[left].ball, &b = nodes_[right].ball;
    LampBall ball{0.5f * (lower + upper), 0, a.power + b.power};
    ball.radius = std::max(length(a.centre - ball.centre) + a.radius, length(b.centre - ball.centre) + b.radius);
    nodes_[index].ball = ball, nodes_[index].left = left, nodes_[index].right = right;
    return index;
}

}  // namespace lumel
