// Surfaces that have an inside.
#pragma once

#include "lumel/scene/scene.h"

namespace lumel {

/// Number of the closed surface of every triangle, or Scene::kNone. A surface is closed where its triangles, connected by their edges, meet
/// every edge as often one way as the other.
std::vector<uint32_t> closed_surfaces(const Scene& scene);

}  // namespace lumel
