"""The cube: six diffuse faces, one of which emits, with a known radiosity for each.

With one element a face, B = 1.11900169, .28347386, .24743321, .13071364, .20992539, .3185206; when the faces are tessellated their
means go to 1.1327, .2684, .2477, .1285, .2075, .3194 (W/m2).
"""

from __future__ import annotations

import math

from ..scene import Camera, Scene
from .implicit import Vec
from .parts import matte, mesh, plate

ALBEDO = (0.5, 0.7, 0.6, 0.3, 0.5, 0.8)
EXITANCE = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # W/m2


def scene() -> Scene:
    """A closed unit cube, fronts inwards: `face 0` and `face 1` are opposite, as are 2 and 3, 4 and 5. One camera inside."""
    x, y, z = (0.5, 0.0, 0.0), (0.0, 0.5, 0.0), (0.0, 0.0, 0.5)
    sides: tuple[tuple[Vec, Vec, Vec], ...] = (
        ((0.0, 0.5, 0.0), x, z),
        ((0.0, -0.5, 0.0), z, x),
        ((-0.5, 0.0, 0.0), y, z),
        ((0.5, 0.0, 0.0), z, y),
        ((0.0, 0.0, -0.5), x, y),
        ((0.0, 0.0, 0.5), y, x),
    )
    names = tuple(f"face {i}" for i in range(6))
    meshes = tuple(
        # A diffuse face of exitance E has the radiance E/pi.
        mesh(name, plate(*side), name, (exitance / math.pi,) * 3)
        for name, side, exitance in zip(names, sides, EXITANCE, strict=True)
    )
    materials = {name: matte(name, (rho, rho, rho)) for name, rho in zip(names, ALBEDO, strict=True)}
    camera = Camera.look_at("main", (0.1, -0.1, 0.48), (0.0, 0.0, -0.5), fov=90, width=256, height=256)
    return Scene(meshes, materials, cameras=(camera,), source="lumel:cube")
