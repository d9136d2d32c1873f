#include "lumel/scene/tessellation.h"

namespace lumel {

namespace {

constexpr double kMostDivisions = 4096;

double divisions(double area, double patch_area) { return std::clamp(std::round(std::sqrt(area / patch_area)), 1.0, kMostDivisions); }

}  // namespace

std::vector<uint16_t> divisions_by_area(std::span<const float> areas, uint64_t patches) {
    double total = 0;
    for (float area : areas) total += area;
    std::vector<uint16_t> n(areas.size(), 1);
    if (!(total > 0)) return n;

    // The count falls with the patch area: bisect its logarithm.
    double low = std::log(total) - 60, high = std::log(total) + 1;
    for (int step = 0; step < 60; ++step) {
        const double middle = 0.5 * (low + high), patch_area = std::exp(middle);
        double count = 0;
        for (float area : areas) count += sqr(static_cast<float>(divisions(area, patch_area)));
        (count > static_cast<double>(patches) ? low : high) = middle;
    }
    for (size_t t = 0; t < areas.size(); ++t) n[t] = static_cast<uint16_t>(divisions(areas[t], std::exp(high)));
    return n;
}

}  // namespace lumel
