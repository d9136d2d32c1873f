#include "lumel/transport/shoot.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <optional>

#include "lumel/sampling/hash.h"
#include "lumel/transport/side_source.h"

namespace lumel {

namespace {

constexpr uint32_t kBlock = 2048;  // rays a work item

enum Stream : uint64_t { kPoint = 1, kDirection, kMirror, kOffset };

/// A ray under way with what it carries. `inv_pdf` is 0 for light that has no density.
struct Flight {
    Ray ray;
    Rgb flux, behind_mirror;
    float inv_pdf = 0;

    bool is_empty() const { return inv_pdf == 0 && max_component(flux + behind_mirror) == 0; }
};

/// Evaluate what leaves `y` along `w`: radiance over the density of all ways to shoot that very ray, the defensive one included.
Flight launch(const Shot& shot, uint32_t side, const SideSource& source, const Surface& y, Vec3 w) {
    const float cos = dot(y.normal, w);
    if (!(cos > 1e-6f)) return {};
    const SideSource::Emission e = source.evaluate(y, w);
    const float inv_pdf = cos / (e.pdf_aw + shot.defensive_density(side) * cos);
    if (!std::isfinite(inv_pdf)) return {};
    if (shot.beside_bundles)
        return {{y.off(shot.scene.epsilon()), w}, e.sharp * inv_pdf, (e.radiance - e.sharp + e.behind_mirror) * inv_pdf, 0};
    // A perfect mirror that shines: what it reflects has the density of these directions, so its own light stays outside the ratios.
    if (y.scatters && y.material->is_perfect_mirror())
        return {{y.off(shot.scene.epsilon()), w}, e.radiance * inv_pdf, e.behind_mirror * inv_pdf, 0};
    return {{y.off(shot.scene.epsilon()), w}, e.radiance * inv_pdf, e.behind_mirror * inv_pdf, inv_pdf};
}

/// A defensive ray from the sphere around an open scene; it carries no light.
Flight launch_from_sky(const Shot& shot, Square point, Square direction) {
    const Vec3 inward = -square_to_sphere(point);
    const Vec3 w = Frame(inward).to_world(square_to_cosine_hemisphere(direction));
    return {{shot.scene.centre() - inward * shot.scene.radius(), w}, {}, {}, 1.0f / shot.defensive_density()};
}

Flight launch_from_point_lamp(const Shot& shot, uint32_t index, double offset, Square direction) {
    double at = (index + offset) / shot.from_points * shot.point_power;
    const PointLamp* lamp = nullptr;
    for (const PointLamp& candidate : shot.scene.point_lamps()) {
        lamp = &candidate;
        if ((at -= 4 * kPi * lum(candidate.intensity)) < 0) break;
    }
    const Rgb flux = lamp->intensity * static_cast<float>(shot.point_power / (shot.from_points * double{lum(lamp->intensity)}));
    const Flight flight{{lamp->position, square_to_sphere(direction)}, {}, flux, 0};
    return shot.emitters.point_lamps_direct ? Flight{flight.ray, flux, {}, 0} : flight;
}

/// The end of a flight on `side`; nothing where it neither carries light nor counts for a density.
Transfer arrive(const Scene& scene, const Hit& hit, const Flight& flight) {
    if (flight.inv_pdf == 0 && max_component(flight.flux) == 0) return {};
    return {scene.side_of(hit.point(), hit.back), hit.u, hit.v, -flight.ray.direction, flight.flux, flight.inv_pdf};
}

/// Follow a flight over perfect mirrors to the side where it is measured. Choosing between a surface's mirror and the rest
/// of it, and roulette, multiply the density.
Transfer follow(const Shot& shot, Flight flight, uint32_t ray, uint64_t& escaped, double& lost) {
    const Scene& scene = shot.scene;
    std::optional<Rng> rng;
    for (int mirrors = 0; mirrors < kMostMirrors; ++mirrors) {
        const Hit hit = shot.accel.intersect(flight.ray);
        if (hit.is_miss()) {
            ++escaped;
            lost += lum(flight.flux);
            return {};
        }
        if (!scene.has_mirrors()) return arrive(scene, hit, flight);
        const Material& material = scene.material(hit.triangle);
        if (!material.is_mirror() || (hit.back && !material.two_sided)) return arrive(scene, hit, flight);

        // Decide between the mirror and the rest. Light over a partial mirror has a second way into the same transfer, from the
        // surface's own lobes, whose density is not known here: it goes outside the ratios.
        if (!rng) rng.emplace(key(shot.stream, ray, kMirror));
        const Surface m(scene, hit.point(), hit.back);
        const float choice = material.mirror_choice();
        if (choice < 1) {
            const bool mirrored = rng->uniform() < choice;
            const float scale = 1 / (mirrored ? choice : 1 - choice);
            flight.flux *= scale, flight.behind_mirror *= scale, flight.inv_pdf *= mirrored ? 0 : scale;
            if (!mirrored) return arrive(scene, hit, flight);
        }
        const Vec3 wi = -flight.ray.direction;
        const float cos = dot(m.shading, wi);
        const Vec3 out = reflect(wi, m.shading);
        if (!(cos > 0) || !(dot(out, m.normal) > 0)) return {};
        const Rgb tint = material.mirror_reflectance(cos);
        const float survive = std::min(1.0f, max_component(tint));
        if (!(rng->uniform() < survive)) return {};
        flight.flux = (flight.flux + flight.behind_mirror) * tint * (1 / survive);
        flight.behind_mirror = {};
        flight.inv_pdf /= survive;
        flight.ray = {m.off(scene.epsilon()), out};
    }
    return {};
}

/// Launch ray `index` of the shot. `source` is the side that the last ray of this work item came from.
class Launcher {
public:
    Launcher(const Shot& shot) : shot_(shot), offset_(to_unit(static_cast<uint32_t>(key(shot.stream, kOffset) >> 32))) {}

    Flight operator()(uint32_t index) {
        const Square point = sobol2d(index, point_stream_), direction = sobol2d(index, direction_stream_);
        if (index < shot_.from_power) return by_power(index, point, direction);
        index -= shot_.from_power;
        if (index < shot_.from_defensive) return by_area(index, point, direction);
        return launch_from_point_lamp(shot_, index - shot_.from_defensive, offset_, direction);
    }

private:
    /// Systematic choice: rays take even steps through the running sum of power, and so visit the sides in order.
    Flight by_power(uint32_t index, Square point, Square direction) {
        const double at = (index + double{offset_}) / shot_.rays_per_watt;
        go_to(shot_.by_power, at);
        const Surface y = source_->draw_point(point);
        return launch(shot_, side_, *source_, y, source_->draw_direction(y, at - shot_.by_power.before(side_), direction));
    }
    Flight by_area(uint32_t index, Square point, Square direction) {
        const double at = (index + double{offset_}) / shot_.from_defensive * shot_.defensive.area();
        if (at >= shot_.defensive.by_area.total()) return launch_from_sky(shot_, point, direction);
        go_to(shot_.defensive.by_area, at);
        const Surface y = source_->draw_point(point);
        return launch(shot_, side_, *source_, y, SideSource::draw_cosine(y, direction));
    }
    void go_to(const Distribution& distribution, double at) {
        const bool here = source_ && at < distribution.upto(side_) && at >= distribution.before(side_);
        if (here) return;
        side_ = distribution.find(at);
        source_.emplace(shot_.scene, shot_.emitters, side_, shot_.rays_per_watt);
    }

    const Shot& shot_;
    const uint64_t point_stream_ = key(shot_.stream, kPoint), direction_stream_ = key(shot_.stream, kDirection);
    float offset_;
    uint32_t side_ = 0;
    std::optional<SideSource> source_;
};

}  // namespace

void shoot(const Shot& shot, Transfers& transfers) {
    const uint32_t rays = shot.rays(), blocks = (rays + kBlock - 1) / kBlock;
    transfers.all.resize(rays);
    transfers.rays = shot.from_power + shot.from_defensive;
    std::vector<uint64_t> escaped(blocks);
    std::vector<double> lost(blocks);

    // Every block of rays is a work item of its own: what a ray does depends on its index alone.
    tbb::parallel_for(uint32_t{0}, blocks, [&](uint32_t block) {
        const FlushDenormals flush;
        Launcher launcher(shot);
        for (uint32_t i = block * kBlock; i < std::min(rays, (block + 1) * kBlock); ++i) {
            const Flight flight = launcher(i);
            transfers.all[i] = flight.is_empty() ? Transfer{} : follow(shot, flight, i, escaped[block], lost[block]);
        }
    });
    transfers.escaped = 0, transfers.lost_flux = 0;
    for (uint32_t block = 0; block < blocks; ++block) transfers.escaped += escaped[block], transfers.lost_flux += lost[block];
    transfers.group_by_side(shot.scene.sides());
}

std::vector<Ray> departures(const Shot& shot) {
    std::vector<Ray> rays;
    rays.reserve(shot.rays());
    Launcher launcher(shot);
    for (uint32_t i = 0; i < shot.rays(); ++i)
        if (const Flight flight = launcher(i); !flight.is_empty()) rays.push_back(flight.ray);
    return rays;
}

}  // namespace lumel
