"""Two scenes that pull estimators in opposite directions: a closed box of smooth light, and the same box where one small bright spot
lights all. The light of the walls is given, they reflect nothing and gloss next to nothing, so that there is one transfer to measure and
no state to solve."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from lumel.scene import BLACK, Camera, Material, Mesh, Rgb, Scene
from lumel.scenes.bust import bust
from lumel.scenes.parts import box, mesh, plate, room

TILES = 8  # of emission along a side of a wall
HALF = 1.25  # m, of the box
FAINT = 1e-6  # reflectance of gloss: what it sends on does not count, and errors are relative to what it sends
SPOT = 300.0  # times brighter than the rest

Radiance = Callable[[str, np.ndarray], Rgb]


def smooth_light(wall: str, at: np.ndarray) -> Rgb:
    """Walls that differ in colour and fade slowly, as diffuse indirect light does."""
    x, y, z = at / HALF
    tint = {"left wall": (1.0, 0.4, 0.3), "right wall": (0.3, 0.5, 1.0), "floor": (0.5, 0.45, 0.4)}.get(wall, (0.9, 0.9, 0.85))
    level = float(1.0 + 0.5 * np.sin(1.3 * x + 0.4) * np.cos(1.1 * z) + 0.3 * np.sin(1.7 * y))
    return (level * tint[0], level * tint[1], level * tint[2])


def spot_light(wall: str, at: np.ndarray) -> Rgb:
    """A dim room, one wall of it black, and one tile of the ceiling that is SPOT times brighter."""
    if wall == "back wall":
        return BLACK
    bright = wall == "ceiling" and 0 < at[0] < 2 * HALF / TILES and 0 < at[2] < 2 * HALF / TILES
    level = SPOT if bright else 1.0
    return (level, level, level)


def walls(light: Radiance, left_out: str = "") -> list[Mesh]:
    """The black walls of the box, in tiles that emit `light`."""
    meshes = []
    for name, whole in room(HALF, 2 * HALF, HALF):
        if name == left_out:
            continue
        vertices, triangles, _ = whole.arrays()
        low, high = vertices.min(axis=0), vertices.max(axis=0)
        first, second = (axis for axis in range(3) if high[axis] > low[axis])
        normal = np.cross(*(vertices[triangles[0][k]] - vertices[triangles[0][0]] for k in (1, 2)))
        u, v = np.zeros(3), np.zeros(3)
        u[first], v[second] = (high - low)[first] / (2 * TILES), (high - low)[second] / (2 * TILES)
        if np.dot(np.cross(u, v), normal) < 0:
            u, v, first, second = v, u, second, first
        for i in range(TILES):
            for j in range(TILES):
                center = low + (2 * i + 1) * u + (2 * j + 1) * v
                tile = plate(tuple(center), tuple(u), tuple(v))
                meshes.append(mesh(f"{name} {i} {j}", tile, "wall", light(name, center - (0, HALF, 0))))
    return meshes


def lobes(light: Radiance) -> Scene:
    """A glossy bust on a glossy plinth (alpha 0.18, about cos^60) amid walls that emit `light`: of 16,500 patches about 6,000 are
    glossy and in view."""
    materials = (Material("gloss", specular=(FAINT, FAINT, FAINT), alpha=0.18), Material("wall"))
    meshes = [
        mesh("bust", bust((0.0, 0.7, 0.0), height=1.05, turn=14.0), "gloss"),
        mesh("plinth", box((0, 0.345, 0), (0.3, 0.355, 0.3)), "gloss"),
        *walls(light),
    ]
    camera = Camera.look_at("main", (0.4, 1.5, 1.2), (0.0, 1.1, 0.0), fov=62, width=320, height=240)
    return Scene(tuple(meshes), {m.name: m for m in materials}, cameras=(camera,), source="lobes")


def smooth() -> Scene:
    """Smooth indirect light: where weighting shines."""
    return lobes(smooth_light)


def spot() -> Scene:
    """One bright spot: the trap of plain ratios."""
    return lobes(spot_light)


def glossy_floor(alpha: float) -> Scene:
    """Smooth light over a glossy floor: few areas, and each of them gets many hits."""
    floor = mesh("floor", dict(room(HALF, 2 * HALF, HALF))["floor"], "gloss")
    materials = (Material("gloss", specular=(FAINT, FAINT, FAINT), alpha=alpha), Material("wall"))
    camera = Camera.look_at("main", (0.0, 2.0, 1.2), (0.0, 0.0, 0.0), fov=100, width=64, height=64)
    return Scene((floor, *walls(smooth_light, left_out="floor")), {m.name: m for m in materials}, cameras=(camera,), source="glossy floor")
