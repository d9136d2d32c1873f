// An order of all sides in which those that are alike and near follow each other.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace lumel {

class Scene;

/// Runs of neighbours: sides of one material and about the same normal, along the curve through the scene.
class SideOrder {
public:
    SideOrder() = default;
    explicit SideOrder(const Scene& scene);

    uint32_t size() const { return static_cast<uint32_t>(order_.size()); }
    uint32_t side(uint32_t position) const { return order_[position]; }
    std::span<const uint32_t> sides(uint32_t first, uint32_t last) const { return {order_.data() + first, order_.data() + last}; }
    /// Whether the side at `position` is no neighbour of the one before it.
    bool starts_run(uint32_t position) const { return starts_run_[position]; }
    /// End a run before each of `positions`.
    void start_runs(std::span<const uint32_t> positions) {
        for (uint32_t position : positions) starts_run_[position] = 1;
    }

private:
    std::vector<uint32_t> order_;
    std::vector<uint8_t> starts_run_;
};

}  // namespace lumel
