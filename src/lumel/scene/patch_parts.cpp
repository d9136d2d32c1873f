#include "lumel/scene/patch_parts.h"

#include "lumel/sampling/warp.h"

namespace lumel {

namespace {

constexpr float kAlike = 1e-4f;  // lines whose values differ by less are one

std::array<float, 3> values_at(const WallLine& line, const PatchCorners& corners) {
    std::array<float, 3> values;
    float most = 0;
    for (int k = 0; k < 3; ++k) values[k] = line.at(corners[k]), most = std::max(most, std::abs(values[k]));
    for (float& value : values) value = most > 0 ? value / most : 0;
    return values;
}

bool are_alike(const std::array<float, 3>& a, const std::array<float, 3>& b) {
    const auto differ = [&](float sign) {
        return std::max({std::abs(a[0] - sign * b[0]), std::abs(a[1] - sign * b[1]), std::abs(a[2] - sign * b[2])});
    };
    return std::min(differ(1), differ(-1)) < kAlike;
}

}  // namespace

void PartPolygon::keep(const std::array<float, 3>& values, bool positive) {
    const float sign = positive ? 1.0f : -1.0f;
    const auto value = [&](Square b) { return sign * (values[0] * (1 - b.u - b.v) + values[1] * b.u + values[2] * b.v); };
    std::array<Square, kMost> kept;
    uint32_t size = 0;
    const auto add = [&](Square b) {
        if (size < kMost) kept[size++] = b;
    };
    for (uint32_t k = 0; k < size_; ++k) {
        const Square a = corner_[k], b = corner_[(k + 1) % size_];
        const float from = value(a), to = value(b);
        if (from >= 0) add(a);
        if ((from < 0) == (to < 0)) continue;
        const float t = from / (from - to);
        add({a.u + t * (b.u - a.u), a.v + t * (b.v - a.v)});
    }
    corner_ = kept, size_ = size;
}

float PartPolygon::share_of_fan(uint32_t k) const {
    const Square a = corner_[0], b = corner_[k], c = corner_[k + 1];
    return std::abs((b.u - a.u) * (c.v - a.v) - (c.u - a.u) * (b.v - a.v));
}

float PartPolygon::share() const {
    float sum = 0;
    for (uint32_t k = 1; k + 1 < size_; ++k) sum += share_of_fan(k);
    return sum;
}

Square PartPolygon::point(Square s) const {
    // Choose a triangle of the fan around the first corner; what is left of the random number is uniform again.
    float left = s.u * share();
    uint32_t k = 1;
    for (; k + 2 < size_ && left >= share_of_fan(k); ++k) left -= share_of_fan(k);
    const float own = share_of_fan(k);
    const Square in = square_to_triangle({own > 0 ? std::clamp(left / own, 0.0f, 1.0f) : 0.0f, s.v}), a = corner_[0], b = corner_[k],
                 c = corner_[k + 1];
    return {a.u + in.u * (b.u - a.u) + in.v * (c.u - a.u), a.v + in.u * (b.v - a.v) + in.v * (c.v - a.v)};
}

void PatchParts::add(WallLine line, const PatchCorners& corners) {
    const std::array<float, 3> values = values_at(line, corners);
    PartPolygon before, behind;
    before.keep(values, true), behind.keep(values, false);
    if (lines_ == kLines || std::min(before.share(), behind.share()) < kLeast) return;
    for (uint32_t i = 0; i < lines_; ++i)
        if (are_alike(at_corner_[i], values)) return;
    line_[lines_] = line, at_corner_[lines_] = values;
    ++lines_;
    find_shares();
}

void PatchParts::find_shares() {
    std::array<float, kParts> whole{};
    for (uint32_t part = 0; part < 1u << lines_; ++part) whole[part] = polygon(part).share();
    share_ = {};
    for (uint32_t part = 0; part < kParts; ++part) {
        // A part too small to send from belongs to the largest of those beyond one line.
        uint32_t owner = part;
        if (whole[part] < kLeast) {
            for (uint32_t i = 0; i < lines_; ++i)
                if (whole[part ^ 1u << i] > whole[owner]) owner = part ^ 1u << i;
            if (whole[owner] < kLeast) owner = static_cast<uint32_t>(std::max_element(whole.begin(), whole.end()) - whole.begin());
        }
        owner_[part] = static_cast<uint8_t>(owner);
        if (owner == part) share_[part] = whole[part];
    }
}

PartPolygon PatchParts::polygon(uint32_t part) const {
    PartPolygon polygon;
    for (uint32_t i = 0; i < lines_; ++i) polygon.keep(at_corner_[i], (part >> i & 1) != 0);
    return polygon;
}

}  // namespace lumel
