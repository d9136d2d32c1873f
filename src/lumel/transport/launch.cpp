#include "lumel/transport/launch.h"

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kPoint = 1, kDirection, kOffset = 4 };

constexpr float kMostInvPdf = 1e30f;  // m2 sr; what is drawn less often than that carries no sample

}  // namespace

/// The rays that are launched together, and a random point and direction for each.
struct Launcher::Block {
    uint32_t first, count;
    Flights& flights;
    std::array<float, Flights::kMost> point_u, point_v, direction_u, direction_v;

    Square point(uint32_t i) const { return {point_u[i], point_v[i]}; }
    Square direction(uint32_t i) const { return {direction_u[i], direction_v[i]}; }
    void set(uint32_t i, const Ray& ray, Rgb flux, Rgb behind_mirror, float inv_pdf) {
        flights.rays.origin.set(i, ray.origin), flights.rays.direction.set(i, ray.direction);
        flights.flux.set(i, flux), flights.behind_mirror.set(i, behind_mirror);
        flights.inv_pdf[i] = inv_pdf;
        flights.rays.traced[i] = inv_pdf > 0 || max_component(flux + behind_mirror) > 0 ? -1 : 0;
    }
};

Launcher::Launcher(const Shot& shot)
    : shot_(shot),
      point_stream_(key(shot.stream, kPoint)),
      direction_stream_(key(shot.stream, kDirection)),
      offset_(double{to_unit(static_cast<uint32_t>(key(shot.stream, kOffset) >> 32))}) {}

void Launcher::operator()(uint32_t first, uint32_t count, Flights& flights) {
    Block block{.first = first, .count = count, .flights = flights};
    flights.rays.size = count;
    for (uint32_t i = 0; i < count; ++i) {
        const Square point = sobol2d(first + i, point_stream_), direction = sobol2d(first + i, direction_stream_);
        block.point_u[i] = point.u, block.point_v[i] = point.v;
        block.direction_u[i] = direction.u, block.direction_v[i] = direction.v;
    }
    // The kinds of rays follow each other; each call launches all that leave one place.
    for (uint32_t i = 0; i < count;) {
        const uint32_t index = first + i;
        if (index < shot_.from_power)
            i += by_power(block, i);
        else if (index < shot_.from_power + shot_.from_defensive)
            i += by_area(block, i);
        else
            i += from_point_lamp(block, i);
    }
}

/// Systematic choice: rays take even steps through the running sum of power, and so visit the sides in order.
uint32_t Launcher::by_power(Block& block, uint32_t i) {
    const uint32_t end = std::min(block.count, shot_.from_power - block.first);
    choose_side(shot_.by_power, block, i, end, [&](uint32_t k) { return (block.first + k + offset_) / shot_.rays_per_watt; });
    source_->draw_points(leaving_);
    source_->draw_directions(leaving_);
    leave(block, i);
    return leaving_.size;
}

/// The same through the running sum of area, with cosine-weighted directions.
uint32_t Launcher::by_area(Block& block, uint32_t i) {
    const double per_ray = shot_.defensive.area() / shot_.from_defensive;
    const auto position = [&](uint32_t k) { return (block.first + k - shot_.from_power + offset_) * per_ray; };
    if (position(i) >= shot_.defensive.by_area.total()) return from_sky(block, i);
    choose_side(shot_.defensive.by_area, block, i, std::min(block.count, shot_.from_power + shot_.from_defensive - block.first), position);
    source_->draw_points(leaving_);
    source_->draw_cosine(leaving_);
    leave(block, i);
    return leaving_.size;
}

/// Go to the side that owns the position of ray `i`, and let those of the rays up to `end` leave it that it owns as well.
template <class Position>
void Launcher::choose_side(const Distribution& shares, const Block& block, uint32_t i, uint32_t end, const Position& position) {
    const double first = position(i);
    uint32_t side = source_ ? source_->side() : 0;
    if (!source_ || !(first >= shares.before(side) && first < shares.upto(side))) {
        side = shares.find(first);
        source_.emplace(shot_.scene, shot_.emitters, side, shot_.rays_per_watt);
    }
    const double before = shares.before(side), upto = shares.upto(side);
    uint32_t n = 0;
    do {
        leaving_.at[n] = position(i + n) - before;
        leaving_.point_u[n] = block.point_u[i + n], leaving_.point_v[n] = block.point_v[i + n];
        leaving_.direction_u[n] = block.direction_u[i + n], leaving_.direction_v[n] = block.direction_v[i + n];
        ++n;
    } while (n < Leaving::kMost && i + n < end && position(i + n) < upto);
    leaving_.size = n;
}

/// Evaluate what leaves the side: radiance over the density of all ways to shoot that very ray, the defensive one included.
void Launcher::leave(Block& block, uint32_t i) {
    Leaving& rays = leaving_;
    source_->evaluate(rays);
    const Vec3 normal = source_->normal(), offset = normal * shot_.scene.epsilon();
    const float defensive = shot_.defensive_density(source_->side());
    const Rgb behind_mirror = source_->behind_mirror();
    // A perfect mirror that shines: what it reflects has the density of these directions, so its own light stays outside the ratios.
    const uint32_t side = source_->side();
    const bool shining_mirror = shot_.scene.scatters(side) && shot_.scene.material(shot_.scene.triangle_of_side(side)).is_perfect_mirror();
    const bool has_density = !shot_.beside_bundles && !shining_mirror;
    Flights& flights = block.flights;
    const uint32_t count = rays.size;
    for (uint32_t k = 0; k < count; ++k) {
        const Vec3 w = rays.w[k];
        const float cos = dot(normal, w), density = rays.pdf_aw[k] + defensive * cos;
        // cos(theta_y) / (n p_y): étendue keeps it to where the ray ends ([WIS] 3.1, with its cosine).
        const float quotient = cos / density, inv_pdf = cos > 1e-6f && quotient < kMostInvPdf ? quotient : 0.0f;
        flights.rays.origin.set(i + k, rays.y[k] + offset), flights.rays.direction.set(i + k, w);
        // Bundles carry what goes straight from side to side, but for sharp lobes.
        const Rgb radiance = rays.radiance[k], direct = shot_.beside_bundles ? source_->sharp(radiance) : radiance;
        flights.flux.set(i + k, direct * inv_pdf), flights.behind_mirror.set(i + k, (radiance - direct + behind_mirror) * inv_pdf);
        flights.inv_pdf[i + k] = has_density ? inv_pdf : 0;
        flights.rays.traced[i + k] = inv_pdf > 0 ? -1 : 0;
    }
}

/// A defensive ray from the sphere around an open scene; it carries no light.
uint32_t Launcher::from_sky(Block& block, uint32_t i) const {
    const Vec3 inward = -square_to_sphere(block.point(i));
    const Vec3 w = Frame(inward).to_world(square_to_cosine_hemisphere(block.direction(i)));
    block.set(i, {shot_.scene.centre() - inward * shot_.scene.radius(), w}, {}, {}, 1.0f / shot_.defensive_density());
    return 1;
}

/// Light of a point lamp has no density. Without `point_lamps_direct` it counts once it has passed a mirror.
uint32_t Launcher::from_point_lamp(Block& block, uint32_t i) const {
    double at = (block.first + i - shot_.from_power - shot_.from_defensive + offset_) / shot_.from_points * shot_.point_power;
    const PointLamp* lamp = nullptr;
    for (const PointLamp& candidate : shot_.scene.point_lamps()) {
        lamp = &candidate;
        if ((at -= 4 * kPi * lum(candidate.intensity)) < 0) break;
    }
    const Rgb flux = lamp->intensity * static_cast<float>(shot_.point_power / (shot_.from_points * double{lum(lamp->intensity)}));
    const bool direct = shot_.emitters.point_lamps_direct;
    block.set(i, {lamp->position, square_to_sphere(block.direction(i))}, direct ? flux : Rgb{}, direct ? Rgb{} : flux, 0);
    return 1;
}

}  // namespace lumel
