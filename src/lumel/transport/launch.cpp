#include "lumel/transport/launch.h"

#include "lumel/sampling/hash.h"

namespace lumel {

namespace {

enum Stream : uint64_t { kPoint = 1, kDirection, kOffset = 4 };

constexpr float kMostInvPdf = 1e30f;  // m2 sr; what is drawn less often than that carries no sample

/// Launch rays that leave one side as flights from `i` on. `defensive`: n p_y / cos(theta_y) of the defensive rays.
void launch(const Leaving& __restrict rays, Vec3 normal, Vec3 offset, float defensive, Rgb behind_mirror, Flights& __restrict flights,
            size_t i) {
    const size_t count = padded(rays.size);
    for (size_t k = 0; k < count; ++k) {
        const Vec3 w = rays.w[k];
        const float cos = dot(normal, w), density = rays.pdf_aw[k] + defensive * cos;
        // cos(theta_y) / (n p_y): étendue keeps it to where the ray ends ([WIS] 3.1, with its cosine).
        const float quotient = cos / density, inv_pdf = (cos > 1e-6f && quotient < kMostInvPdf) ? quotient : 0.0f;
        flights.rays.origin.set(i + k, rays.y[k] + offset), flights.rays.direction.set(i + k, w);
        flights.flux.set(i + k, rays.radiance[k] * inv_pdf), flights.behind_mirror.set(i + k, behind_mirror * inv_pdf);
        flights.inv_pdf[i + k] = inv_pdf;
        flights.rays.traced[i + k] = -static_cast<int32_t>(inv_pdf > 0);
    }
}

}  // namespace

/// The rays that are launched together, and a random point and direction for each.
struct Launcher::Block {
    static constexpr uint32_t kRoom = Flights::kRoom;

    uint32_t first, count;
    Flights& flights;
    std::array<float, kRoom> point_u, point_v, direction_u, direction_v;
    std::array<double, kRoom> position;  // in the running sum by which the side is chosen

    Square point(uint32_t i) const { return {point_u[i], point_v[i]}; }
    Square direction(uint32_t i) const { return {direction_u[i], direction_v[i]}; }
    void set(uint32_t i, const Ray& ray, Rgb flux, Rgb behind_mirror, float inv_pdf) {
        flights.rays.origin.set(i, ray.origin), flights.rays.direction.set(i, ray.direction);
        flights.flux.set(i, flux), flights.behind_mirror.set(i, behind_mirror);
        flights.inv_pdf[i] = inv_pdf, flights.covered[i] = false;
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
    const size_t room = padded(count) + kSideBySide;
    for (size_t k = 0; k < room; ++k) {
        const auto i = static_cast<uint32_t>(k);
        const Square point = sobol2d(first + i, point_stream_), direction = sobol2d(first + i, direction_stream_);
        block.point_u[i] = point.u, block.point_v[i] = point.v;
        block.direction_u[i] = direction.u, block.direction_v[i] = direction.v;
    }
    // The kinds of rays follow each other; each call launches all that leave one place.
    const auto end_of = [&](uint32_t rays) { return rays > first ? std::min(rays - first, count) : 0; };
    const uint32_t power = end_of(shot_.from_power), area = end_of(shot_.from_power + shot_.from_defensive);
    const auto index = [&](uint32_t i) { return static_cast<double>(static_cast<int32_t>(first + i)); };
    for (uint32_t i = 0; i < power; ++i) block.position[i] = (index(i) + offset_) / shot_.rays_per_watt;
    const double area_per_ray = shot_.defensive.area() / shot_.from_defensive;
    for (uint32_t i = power; i < area; ++i) block.position[i] = (index(i) - shot_.from_power + offset_) * area_per_ray;
    uint32_t i = 0;
    while (i < power) i += by_power(block, i, power);
    while (i < area) i += by_area(block, i, area);
    while (i < count) i += from_point_lamp(block, i);
}

/// Systematic choice: rays take even steps through the running sum of power, and so visit the sides in order.
uint32_t Launcher::by_power(Block& block, uint32_t i, uint32_t end) {
    const auto power_of = [&](uint32_t side, uint32_t part) { return shot_.emitters.power(shot_.scene, side, part); };
    choose(owner(shot_.by_power, block.position[i], power_of), block, i, end);
    source_->draw_points(leaving_);
    source_->draw_directions(leaving_);
    leave(block, i);
    return leaving_.size;
}

/// The same through the running sum of area, with cosine-weighted directions.
uint32_t Launcher::by_area(Block& block, uint32_t i, uint32_t end) {
    if (block.position[i] >= shot_.defensive.by_area.total()) return from_sky(block, i);
    const auto share_of = [&](uint32_t side, uint32_t part) { return double{shot_.scene.parts(side)->share(part)}; };
    choose(owner(shot_.defensive.by_area, block.position[i], share_of), block, i, end);
    source_->draw_points(leaving_);
    source_->draw_cosine(leaving_);
    leave(block, i);
    return leaving_.size;
}

/// What owns a position. The parts of a side divide what it owns by their weights.
template <class WeightOf>
Launcher::Owner Launcher::owner(const Distribution& shares, double position, const WeightOf& weight_of) const {
    const uint32_t side = shares.find(position, source_ ? source_->side() : 0);
    Owner own{side, kWhole, shares.before(side), shares.upto(side)};
    if (shot_.emitters.of_part.empty() || !shot_.scene.is_divided(side)) return own;

    std::array<double, PatchParts::kParts> weight;
    double sum = 0;
    for (uint32_t part = 0; part < weight.size(); ++part) sum += weight[part] = weight_of(side, part);
    const double begin = own.before, scale = sum > 0 ? (own.upto - own.before) / sum : 0;
    double before = 0;
    for (uint32_t part = 0; part < weight.size(); ++part) {
        if (!(weight[part] > 0)) continue;
        own = {side, part, begin + before * scale, begin + (before + weight[part]) * scale};
        if (position < own.upto) break;
        before += weight[part];
    }
    return own;
}

/// Go to what owns the position of ray `i`, and let those of the rays up to `end` leave it that it owns as well.
void Launcher::choose(const Owner& owner, const Block& block, uint32_t i, uint32_t end) {
    const double* position = &block.position[i];
    if (!source_ || owner.side != source_->side() || owner.part != source_->part())
        source_.emplace(shot_.scene, shot_.emitters, owner.side, shot_.rays_per_watt, owner.part);
    const double before = owner.before, upto = owner.upto;
    const uint32_t most = std::min(Leaving::kMost, end - i);
    uint32_t n = 1;
    while (n < most && position[n] < upto) ++n;
    leaving_.size = n;
    const size_t count = padded(n), from = i;
    for (size_t k = 0; k < count; ++k) {
        leaving_.at[k] = position[k] - before;
        leaving_.point_u[k] = block.point_u[from + k], leaving_.point_v[k] = block.point_v[from + k];
        leaving_.direction_u[k] = block.direction_u[from + k], leaving_.direction_v[k] = block.direction_v[from + k];
    }
}

/// Evaluate what leaves the side: radiance over the density of all ways to shoot that very ray, the defensive one included.
void Launcher::leave(Block& block, uint32_t i) {
    source_->evaluate(leaving_);
    const uint32_t side = source_->side();
    Flights& flights = block.flights;
    const Vec3 normal = source_->normal();
    launch(leaving_, normal, normal * shot_.scene.epsilon(), shot_.defensive_density(side), source_->behind_mirror(), flights, i);

    std::copy_n(leaving_.covered.begin(), leaving_.size, flights.covered.begin() + i);

    // Bundles carry what goes straight from side to side, but for sharp lobes.
    if (shot_.beside_bundles)
        for (uint32_t k = 0; k < leaving_.size; ++k) {
            const Rgb radiance = leaving_.radiance[k], direct = source_->sharp(radiance);
            const float inv_pdf = flights.inv_pdf[i + k];
            flights.flux.set(i + k, direct * inv_pdf);
            flights.behind_mirror.set(i + k, (radiance - direct + source_->behind_mirror()) * inv_pdf);
        }
    // A perfect mirror that shines: what it reflects has the density of these directions, so its own light stays outside the ratios.
    const bool shining_mirror = shot_.scene.has_mirrors() && shot_.scene.scatters(side) &&
                                shot_.scene.material(shot_.scene.triangle_of_side(side)).is_perfect_mirror();
    if (shot_.beside_bundles || shining_mirror) std::fill_n(&flights.inv_pdf[i], leaving_.size, 0.0f);
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
