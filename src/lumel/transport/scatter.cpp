#include "lumel/transport/scatter.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "lumel/sampling/hash.h"
#include "lumel/scene/surface.h"

namespace lumel {

namespace {

/// Light of one transfer with the adjoint factor of the shading normal, W, and its specular power.
struct Incident {
    Rgb flux;
    float power = 0;
    uint32_t part = 0;
};

/// A side that receives light.
class Receiver {
public:
    Receiver(const Scene& scene, uint32_t side)
        : scene_(&scene),
          triangle_(scene.triangle_of_side(side)),
          material_(&scene.material(triangle_)),
          sign_(scene.is_back(side) ? -1.0f : 1.0f),
          normal_(scene.geometric_normal(triangle_) * sign_),
          glossy_(scene.glossy_index(side) != Scene::kNone),
          smooth_(scene.is_smooth(triangle_)),
          parts_(scene.parts(side)) {}

    Incident receive(const Transfer& transfer) const {
        const Vec3 shading = smooth_ ? scene_->shading_normal({triangle_, transfer.u, transfer.v}) * sign_ : normal_;
        const Rgb flux = smooth_ ? transfer.flux * adjoint(shading, normal_, transfer.wi) : transfer.flux;
        return {flux, glossy_ ? lum(flux * material_->albedo_s(dot(shading, transfer.wi))) : 0.0f,
                parts_ ? parts_->part_of({transfer.u, transfer.v}) : 0};
    }

private:
    const Scene* scene_;
    uint32_t triangle_;
    const Material* material_;
    float sign_;
    Vec3 normal_;
    bool glossy_, smooth_;
    const PatchParts* parts_;
};

/// Neighbours that send on together what they received together. Sides with hits enough stay alone, as do those that walls divide; where
/// there are few hits, a single one would make a small patch far too bright.
struct Group {
    uint32_t first, last;  // positions in the order of sides
};
constexpr size_t kEnoughHits = 16;
constexpr uint32_t kMostSides = 256;
constexpr double kSmall = 0.25;  // of the mean patch

std::vector<Group> group_by_hits(const Scene& scene, const Transfers& transfers) {
    const SideOrder& order = scene.side_order();
    std::vector<Group> groups;
    size_t hits = 0;
    for (uint32_t i = 0; i < order.size(); ++i) {
        const size_t here = transfers.arrivals(order.side(i));
        const bool is_divided = scene.is_divided(order.side(i)) || (i > 0 && scene.is_divided(order.side(i - 1)));
        const bool joins = !groups.empty() && !order.starts_run(i) && !is_divided && hits < kEnoughHits && here < kEnoughHits &&
                           i - groups.back().first < kMostSides;
        if (!joins) groups.push_back({i, i}), hits = 0;
        groups.back().last = i + 1;
        hits += here;
    }
    return groups;
}

/// Light that a group received, with a running sum of its specular power.
struct Light {
    Vec3 wi;
    Rgb flux;
    double power_so_far;
    uint32_t part;  // of the side
};

/// Draw the records of one side: even steps through the running sum of the specular power of its group.
void draw_records(const std::vector<Light>& lights, double share, uint64_t stream, std::span<Record> records) {
    const double power = lights.back().power_so_far, step = power / kSurfaceRecords, sent = step * share;
    double next = step * to_unit(static_cast<uint32_t>(stream >> 32)), before = 0;
    int drawn = 0;
    for (const Light& light : lights) {
        for (; drawn < kSurfaceRecords && next < light.power_so_far; next += step)
            records[kLampRecords + drawn++] = {light.wi, light.flux * static_cast<float>(sent / (light.power_so_far - before)),
                                               static_cast<float>(sent), light.part};
        before = light.power_so_far;
    }
}

/// Let each part of a divided side send what came to it.
void send_from_parts(const Scene& scene, const Transfers& transfers, uint32_t side, Emitters& next) {
    const std::span<Rgb> parts = next.parts_of(scene, side);
    if (parts.empty()) return;
    std::array<Rgb64, PatchParts::kParts> sums{};
    const Receiver receiver(scene, side);
    for (const Transfer& transfer : transfers.placed(side)) {
        const Incident light = receiver.receive(transfer);
        sums[light.part] += light.flux;
    }
    for (size_t part = 0; part < parts.size(); ++part)
        parts[part] = sums[part].to_float() * scene.material(scene.triangle_of_side(side)).diffuse;
}

/// Sum what each side of a group received, and let the group send it on. The Lambertian share of small sides is spread over these by area;
/// others keep theirs. The specular share is spread over the small sides and those that were hit: the others may lie where no light
/// comes, under a box. `lights` is room to work.
void scatter_group(const Scene& scene, const Transfers& transfers, std::span<const uint32_t> sides, uint64_t stream,
                   std::vector<Rgb>& received, Emitters& next, std::vector<Light>& lights) {
    const double small_area = scene.total_area() / scene.patches() * kSmall;
    const auto is_small = [&](uint32_t side) {
        return sides.size() > 1 && scene.open_share(side) > 0 && double{scene.patch_area(scene.patch_of_side(side))} < small_area;
    };
    const auto takes_part = [&](uint32_t side) { return scene.scatters(side) && (is_small(side) || transfers.arrivals(side) > 0); };
    double area = 0, area_of_small = 0;
    Rgb64 light_of_small;
    lights.clear();
    for (uint32_t side : sides) {
        Rgb64 sum = transfers.plain_flux(side);
        if (!transfers.placed(side).empty()) {
            const Receiver receiver(scene, side);
            for (const Transfer& transfer : transfers.placed(side)) {
                const Incident light = receiver.receive(transfer);
                sum += light.flux;
                if (light.power > 0)
                    lights.push_back(
                        {transfer.wi, light.flux, (lights.empty() ? 0.0 : lights.back().power_so_far) + double{light.power}, light.part});
            }
        }
        received[side] = scene.open_share(side) > 0 ? sum.to_float() : Rgb{};
        if (is_small(side)) light_of_small += sum, area_of_small += double{scene.side_area(side)};
        if (takes_part(side)) area += double{scene.side_area(side)};
    }
    for (uint32_t side : sides) {
        const double size = double{scene.side_area(side)};
        const Rgb sent = is_small(side) ? (light_of_small * (size / area_of_small)).to_float() : received[side];
        next.diffuse[side] = scene.scatters(side) ? sent * scene.material(scene.triangle_of_side(side)).diffuse : Rgb{};
        send_from_parts(scene, transfers, side, next);
        next.clear_records(scene, side);
        if (takes_part(side) && !lights.empty()) draw_records(lights, size / area, key(stream, side), next.open_records(scene, side));
    }
}

}  // namespace

void scatter(const Scene& scene, const Transfers& transfers, uint64_t stream, std::vector<Rgb>& received, Emitters& next) {
    received.resize(scene.sides());
    const std::vector<Group> groups = group_by_hits(scene, transfers);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, groups.size(), 512), [&](const auto& range) {
        std::vector<Light> lights;
        for (size_t i = range.begin(); i < range.end(); ++i)
            scatter_group(scene, transfers, scene.side_order().sides(groups[i].first, groups[i].last), stream, received, next, lights);
    });
}

void merge_records(const Scene& scene, const Emitters& generation, uint64_t stream, Emitters& total) {
    tbb::parallel_for(tbb::blocked_range<uint32_t>(0, scene.sides(), 4096), [&](const auto& range) {
        for (uint32_t side = range.begin(); side < range.end(); ++side) {
            const auto candidates = generation.records_of(scene, side);
            if (candidates.empty()) continue;
            const auto kept = total.open_records(scene, side);
            Rng rng(key(stream, side));
            for (int i = kLampRecords; i < kRecords; ++i) {
                if (!(candidates[i].power > 0)) continue;
                const float sum = kept[i].power + candidates[i].power;
                if (rng.uniform() * sum >= kept[i].power) kept[i] = candidates[i];
                kept[i].flux *= sum / kept[i].power;
                kept[i].power = sum;
            }
        }
    });
}

}  // namespace lumel
