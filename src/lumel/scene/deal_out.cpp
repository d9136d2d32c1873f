#include "lumel/scene/deal_out.h"

#include <algorithm>
#include <queue>

namespace lumel {

namespace {

/// A cell that may be halved, and what it takes away of the error a patch.
struct Offer {
    double gain;
    uint32_t cell;
    uint8_t divisions;  // for which it was made

    bool operator<(const Offer& other) const { return gain != other.gain ? gain < other.gain : cell > other.cell; }
};

}  // namespace

std::vector<uint8_t> deal_out(const CellEdges& edges, std::span<const double> error, uint64_t patches) {
    std::vector<uint8_t> divisions(edges.cells(), 1);
    std::priority_queue<Offer> offers;
    // Halving takes away 7/8 of an error that falls as n^-3, and adds 3 n^2 patches: n^-5, but for a factor that all share.
    const auto offer = [&](uint32_t cell) {
        const double n = divisions[cell];
        if (divisions[cell] < kMostDivisions && error[cell] > 0) offers.push({error[cell] / (n * n * n * n * n), cell, divisions[cell]});
    };
    for (uint32_t cell = 0; cell < edges.cells(); ++cell) offer(cell);
    uint64_t count = edges.cells();
    std::vector<uint32_t> halved;
    while (!offers.empty()) {
        const Offer best = offers.top();
        offers.pop();
        if (divisions[best.cell] != best.divisions) continue;
        // Coarser neighbours go along, and theirs.
        halved.assign(1, best.cell);
        uint64_t added = 0;
        for (size_t i = 0; i < halved.size(); ++i) {
            const uint8_t n = divisions[halved[i]];
            added += uint64_t{3} * n * n;
            for (uint32_t other : edges.neighbours(halved[i]))
                if (divisions[other] < n && std::find(halved.begin(), halved.end(), other) == halved.end()) halved.push_back(other);
        }
        if (count + added > patches) continue;
        count += added;
        for (uint32_t cell : halved) {
            divisions[cell] = static_cast<uint8_t>(2 * divisions[cell]);
            offer(cell);
        }
    }
    return divisions;
}

}  // namespace lumel
