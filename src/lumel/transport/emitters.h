// What shoots in one step of a transport: diffuse flux and a few recorded directions for every side.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "lumel/scene/scene.h"

namespace lumel {

/// Light that a glossy side received from one direction and sends on through its specular lobe.
struct Record {
    Vec3 wi;          ///< where it came from
    Rgb flux;         ///< W that arrived (shading cosine included)
    float power = 0;  ///< lum of what the lobe sends on, W; 0: no record
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
    Rgb homogeneous{};  ///< L0: sides emit (1 - a(wo)) L0, so that the radiance in a closed scene is L0 everywhere (for tests)
    bool point_lamps = false;  ///< point lamps shoot too,
    bool point_lamps_direct = false;  ///< and what they shoot counts without a mirror as well

    explicit Emitters(const Scene& scene)
        : diffuse(scene.sides()), records_(size_t{scene.glossy_sides()} * kRecords), recorded_(scene.glossy_sides()) {}

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
        for (Record& record : records_) record.flux *= factor, record.power *= factor;
    }
    /// Luminous power of all that a side sends, W: the chance that a ray starts there is proportional to it.
    double power(const Scene& scene, uint32_t side) const {
        double sum = lum(diffuse[side]);
        if (!behind_mirror.empty()) sum += lum(behind_mirror[side]);
        if (max_component(homogeneous) > 0) sum += lum(homogeneous) * kPi * scene.side_area(side);
        for (const Record& record : records_of(scene, side)) sum += record.power;
        return sum;
    }

private:
    std::span<const Record> records(uint32_t glossy) const { return std::span(records_).subspan(size_t{glossy} * kRecords, kRecords); }

    std::vector<Record> records_;  // kRecords per glossy side
    std::vector<uint8_t> recorded_;  // per glossy side: whether they count
};

}  // namespace lumel
