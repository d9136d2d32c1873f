#include "lumel/transport/solved_sight.h"

#include "lumel/transport/side_source.h"

namespace lumel {

void SolvedSight::see(std::span<const Look> looks, std::span<Seen> seen) const {
    const Scene& scene = accel_->scene();
    for (size_t i = 0; i < looks.size(); ++i) {
        seen[i] = {};
        const Hit hit = accel_->intersect({looks[i].origin, looks[i].direction});
        if (hit.is_miss()) continue;
        const Surface y(scene, hit.point(), hit.back);
        const uint32_t side = scene.side_of(hit.point(), hit.back);
        const SideSource source(scene, *emitters_, side, 0, emitters_->part_of(scene, side, {hit.u, hit.v}));
        const SideSource::Emission e = source.evaluate(y.shading, -looks[i].direction);
        seen[i].radiance = e.radiance - e.sharp;
        seen[i].dark = !(max_component(e.radiance) > 0) && !reachable_->reaches(scene, hit.triangle, hit.back);
    }
}

}  // namespace lumel
