// What shoots in one step of a transport: diffuse flux and a few recorded directions for every side.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lumel/scene/scene.h"

namespace lumel {

/// Instead of the number of a part: all of a side.
inline constexpr uint32_t kWhole = Scene::kNone;

/// Light that a glossy side received from one direction and sends on through its specular lobe.
struct Record {
    Vec3 wi;          ///< where it came from
    Rgb flux;         ///< W that arrived (shading cosine included)
    float power = 0;  ///< lum of what the lobe sends on, W; 0: no record
    uint32_t part = 0;  ///< of the side, that it came to

    /// Does it belong to a part? All belong to the whole.
    bool is_of(uint32_t other) const { return other == kWhole || part == other; }
};

/// Records of a side: first those of light straight from lamps, then those of light from other surfaces.
inline constexpr int kLampRecords = 4;
inline constexpr int kSurfaceRecords = 4;
inline constexpr int kRecords = kLampRecords + kSurfaceRecords;

/// Lobes narrower than this are hardly met by directions that are spread over the hemisphere: bundles leave their light to rays.
inline constexpr float kSharpest = 0.05f;
inline bool is_sharp(const Material& material) { return material.is_glossy() && material.alpha < kSharpest; }

struct Emitters {
    std::vector<Rgb> diffuse;        ///< per side: W sent by the Lambertian lobe (reflected, or emitted)
    std::vector<Rgb>
        behind_mirror;  ///< per side or empty: W of lamps that counts only after a perfect mirror (the first shot has the rest)
    std::vector<Rgb> of_part;  ///< of `diffuse`, what each part of the divided sides sends; empty where that is spread over the side
    Rgb homogeneous{};  ///< L0: sides emit (1 - a(wo)) L0, so that the radiance in a closed scene is L0 everywhere (for tests)
    bool point_lamps = false;  ///< point lamps shoot too,
    bool point_lamps_direct = false;  ///< and what they shoot counts without a mirror as well

    explicit Emitters(const Scene& scene)
        : diffuse(scene.sides()),
          of_part(size_t{scene.divided_sides()} * PatchParts::kParts),
          records_(size_t{scene.glossy_sides()} * kRecords),
          recorded_(scene.glossy_sides()) {}

    /// The part of a side that sends from a point, given in its triangle.
    uint32_t part_of(const Scene& scene, uint32_t side, Square p) const {
        return !of_part.empty() && scene.is_divided(side) ? scene.parts(side)->part_of(p) : kWhole;
    }
    /// What the parts of a side send of its diffuse flux; empty where it is spread over the side.
    std::span<Rgb> parts_of(const Scene& scene, uint32_t side) {
        if (of_part.empty() || !scene.is_divided(side)) return {};
        return std::span(of_part).subspan(size_t{scene.divided_index(side)} * PatchParts::kParts, PatchParts::kParts);
    }
    /// Diffuse flux of a part, W.
    Rgb diffuse_of(const Scene& scene, uint32_t side, uint32_t part) const {
        return part == kWhole ? diffuse[side] : of_part[size_t{scene.divided_index(side)} * PatchParts::kParts + part];
    }
    /// Let divided sides send the same from everywhere.
    void spread_over_parts(const Scene& scene) {
        for (uint32_t side = 0; side < scene.sides(); ++side) {
            const std::span<Rgb> parts = parts_of(scene, side);
            for (uint32_t part = 0; part < parts.size(); ++part) parts[part] = diffuse[side] * scene.parts(side)->share(part);
        }
    }
    /// Records of a side; empty where it has none.
    std::span<const Record> records_of(const Scene& scene, uint32_t side) const {
        const uint32_t glossy = scene.glossy_index(side);
        return glossy == Scene::kNone || !recorded_[glossy] ? std::span<const Record>{} : records(glossy);
    }
    /// Room for the kRecords records of a glossy side, as they are; without power where it had none. Empty where the side is not glossy.
    std::span<Record> open_records(const Scene& scene, uint32_t side) {
        const uint32_t glossy = scene.glossy_index(side);
        if (glossy == Scene::kNone) return {};
        const auto all = std::span(records_).subspan(size_t{glossy} * kRecords, kRecords);
        if (!recorded_[glossy]) std::fill(all.begin(), all.end(), Record{});
        recorded_[glossy] = 1;
        return all;
    }
    void clear_records(const Scene& scene, uint32_t side) {
        if (const uint32_t glossy = scene.glossy_index(side); glossy != Scene::kNone) recorded_[glossy] = 0;
    }
    /// Multiply all that is sent.
    void scale(float factor) {
        for (Rgb& flux : diffuse) flux *= factor;
        for (Rgb& flux : of_part) flux *= factor;
        for (Record& record : records_) record.flux *= factor, record.power *= factor;
    }
    /// Luminous power of all that a side or a part of it sends, W: the chance that a ray starts there is proportional to it.
    double power(const Scene& scene, uint32_t side, uint32_t part = kWhole) const {
        const float share = part == kWhole ? 1.0f : scene.parts(side)->share(part);
        double sum = lum(diffuse_of(scene, side, part));
        if (!behind_mirror.empty()) sum += lum(behind_mirror[side]) * share;
        if (max_component(homogeneous) > 0) sum += lum(homogeneous) * kPi * scene.side_area(side) * share;
        for (const Record& record : records_of(scene, side))
            if (record.is_of(part)) sum += record.power;
        return sum;
    }

private:
    std::span<const Record> records(uint32_t glossy) const { return std::span(records_).subspan(size_t{glossy} * kRecords, kRecords); }

    std::vector<Record> records_;  // kRecords per glossy side
    std::vector<uint8_t> recorded_;  // per glossy side: whether they count
};

}  // namespace lumel
