#include "lumel/areas/irradiance.h"

namespace lumel {

SideField SideMoments::field(uint32_t replicas) const {
    const double r = std::max(1u, replicas);
    SideField field{std::vector<Rgb>(sum_.size()), std::vector<Rgb>(sum_.size())};
    for (size_t side = 0; side < sum_.size(); ++side) {
        const Rgb64 mean = sum_[side] * (1 / r);
        field.mean[side] = mean.to_float();
        if (replicas < 2) continue;
        const Rgb64 spread = (squares_[side] - mean * mean * r) * (1 / (r * (r - 1)));
        field.variance[side] = Rgb64{std::max(0.0, spread.x), std::max(0.0, spread.y), std::max(0.0, spread.z)}.to_float();
    }
    return field;
}

}  // namespace lumel
