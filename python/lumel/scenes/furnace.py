"""The furnace: inside a closed sphere that emits 1 - rho and reflects rho, the radiance is 1 everywhere, whatever the picture shows."""

from __future__ import annotations

from ..readers.primitives import sphere
from ..scene import Camera, Scene
from .parts import matte, mesh

ALBEDO = 0.5


def scene() -> Scene:
    """A sphere of radius 1 m, front inwards, with one camera inside: every pixel is 1 in all channels."""
    light = 1 - ALBEDO
    wall = mesh("wall", sphere(3).flipped(), "wall", (light, light, light))
    camera = Camera.look_at("main", (0.3, 0.1, 0.5), (0.0, 0.0, -1.0), fov=70, width=256, height=192)
    return Scene((wall,), {"wall": matte("wall", (ALBEDO, ALBEDO, ALBEDO))}, cameras=(camera,), source="lumel:furnace")
