#include "lumel/raster/raster_scene.h"

#include "lumel/scene/closed_surfaces.h"

namespace lumel {

RasterScene::RasterScene(const Scene& scene) : scene_(&scene), triangles_(scene.triangles()) {
    static_assert(kOpen == Scene::kNone);
    const std::vector<uint32_t> closed = closed_surfaces(scene);
    for (uint32_t t = 0; t < scene.triangles(); ++t)
        triangles_[t] = {scene.indices()[t], scene.divisions(t), scene.first_patch(t), closed[t]};
}

}  // namespace lumel
