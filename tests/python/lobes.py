"""Scenes in which part of what gloss sees is dark, and runs of the core that measure the gloss in them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

import lumel
from lumel import _core
from lumel.core import camera_to_core, to_core
from lumel.readers.primitives import sphere
from lumel.scene import Rgb
from running import quad

Floats = npt.NDArray[np.float64]
LUM = np.array([0.2126, 0.7152, 0.0722])

MATERIALS = {
    "black": lumel.Material("black"),
    "grey": lumel.Material("grey", diffuse=(0.5, 0.5, 0.5)),
    "gloss": lumel.Material("gloss", specular=(0.9, 0.6, 0.3), alpha=0.3),
    "mirror": lumel.Material("mirror", mirror=(0.8, 0.8, 0.8)),
}


def plate(name: str, corner: Rgb, u: Rgb, v: Rgb, material: str, emission: float = 0.0) -> lumel.Mesh:
    """A parallelogram whose front is on the side of u x v."""
    c, a, b = np.array(corner), np.array(u), np.array(v)
    return quad(name, [tuple(p) for p in (c, c + a, c + a + b, c + b)], material, emission)


def gloss(size: float = 1.0) -> lumel.Mesh:
    """A glossy square on z = 0 around the origin."""
    return plate("gloss", (-size / 2, -size / 2, 0), (size, 0, 0), (0, size, 0), "gloss")


def seen(*meshes: lumel.Mesh, origin: Rgb = (0.0, -0.8, 0.7)) -> lumel.Scene:
    """The scene of these meshes, seen from `origin` towards (0, 0, 0)."""
    camera = lumel.Camera.look_at("main", origin, (0, 0, 0), (0, 0, 1), fov=70, width=16, height=12)
    return lumel.Scene(meshes, MATERIALS, cameras=(camera,))


def half_lit_sphere() -> lumel.Scene:
    """A black sphere, part of which shines: the lobe of a patch in the middle sees lit and dark."""
    vertices, triangles, _ = sphere(2).flipped().arrays()
    shines = vertices[triangles].mean(axis=1)[:, 1] > 0.45
    lit = lumel.Mesh("lit", vertices, triangles[shines], "black", emission=(1.0, 1.0, 1.0))
    dark = lumel.Mesh("dark", vertices, triangles[~shines], "black")
    return seen(gloss(0.5), lit, dark, origin=(0, -0.5, 0.4))


def room(back: str, lamp: lumel.Mesh) -> lumel.Scene:
    """A grey room of 2 x 2 x 1 m with a glossy floor; `back` is what the wall is made of that the floor mirrors to the eye."""
    walls = (
        plate("back", (1, 1, 0), (-2, 0, 0), (0, 0, 1), back),
        plate("front", (-1, -1, 0), (2, 0, 0), (0, 0, 1), "grey"),
        plate("left", (-1, 1, 0), (0, -2, 0), (0, 0, 1), "grey"),
        plate("right", (1, -1, 0), (0, 2, 0), (0, 0, 1), "grey"),
        plate("ceiling", (-1, 1, 1), (2, 0, 0), (0, -2, 0), "grey"),
    )
    return seen(gloss(2.0), *walls, lamp)


def black_back_wall() -> lumel.Scene:
    """Of the lit room the floor shows a black wall."""
    return room("black", plate("lamp", (-0.3, 0.3, 0.95), (0.6, 0, 0), (0, -0.6, 0), "black", 10.0))


def open_sky() -> lumel.Scene:
    """A glossy floor, a lit wall behind it, and the dark sky above and around."""
    wall = plate("wall", (0.8, 0.8, 0), (-1.6, 0, 0), (0, 0, 0.6), "grey")
    lamp = plate("lamp", (-0.3, 0.5, 1.0), (0.6, 0, 0), (0, -0.4, 0), "black", 10.0)
    return seen(gloss(1.6), wall, lamp)


def lit_by_a_mirror() -> lumel.Scene:
    """All walls are black; the lamp looks away from the floor at a mirror, and shines on it by the mirror alone."""
    mirror = plate("mirror", (0.6, 0.9, 0.1), (-1.2, 0, 0), (0, 0, 0.8), "mirror")
    lamp = plate("lamp", (-0.2, 0.5, 0.4), (0.4, 0, 0), (0, 0, 0.3), "black", 10.0)
    turned = lumel.Mesh("lamp", lamp.vertices, lamp.triangles[:, ::-1].copy(), "black", emission=lamp.emission)
    box = plate("ground", (-3, -3, -0.5), (6, 0, 0), (0, 6, 0), "black")
    return seen(gloss(1.6), mirror, turned, box)


DARK: Mapping[str, Callable[[], lumel.Scene]] = {
    "half-lit sphere": half_lit_sphere,
    "black back wall": black_back_wall,
    "open sky": open_sky,
    "lit by a mirror": lit_by_a_mirror,
}


@dataclass(frozen=True)
class Run:
    """How a session measures; negative shares leave the choice to it."""

    rays: int
    replicas: int = 4
    estimator: str = "auto"
    defensive: float = -1.0
    gather: float = 16.0
    transport: str = "rays"
    areas: str = "patches"
    first_shot: bool = False
    patches: int = 200


def measure(scene: lumel.Scene, run: Run, seed: int) -> _core.Session:
    """A session after `run.replicas` replicas of one step each."""
    core, _ = to_core(scene, run.patches)
    session = _core.Session(
        scene=core,
        cameras=[camera_to_core(scene.cameras[0])],
        transport=run.transport,
        areas=run.areas,
        estimator=run.estimator,
        defensive=run.defensive,
        gather=run.gather,
        first_shot=run.first_shot,
        weight_diffuse=False,
        direct_samples=4,
        seed=seed,
        threads=2,
    )
    for _ in range(run.replicas):
        session.begin_replica(run.rays // run.replicas // 4)
        session.step(run.rays // run.replicas)
        session.end_replica()
    return session


def luminance(rgb: Any) -> Floats:
    """(..., 3) -> (...)."""
    return np.asarray(np.asarray(rgb, np.float64) @ LUM)
