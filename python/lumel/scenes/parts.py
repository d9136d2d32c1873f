"""Short ways to say what the built-in scenes are made of."""

from __future__ import annotations

import numpy as np

from ..readers.primitives import cube, rectangle
from ..readers.surface import Surface
from ..scene import BLACK, Material, Mesh, Rgb
from .implicit import Vec, rotation

LAMP = Material("lamp")  # black: it shines and does not reflect


def mesh(name: str, surface: Surface, material: str, emission: Rgb = BLACK) -> Mesh:
    """A mesh of one material; `emission` is a radiance in W/(m2 sr)."""
    vertices, triangles, normals = surface.arrays()
    return Mesh(name, vertices, triangles, material, normals, emission)


def plate(center: Vec, half_u: Vec, half_v: Vec) -> Surface:
    """The rectangle `center` +- `half_u` +- `half_v`; its front faces along half_u x half_v."""
    matrix = np.eye(4)
    matrix[:3] = np.column_stack([half_u, half_v, np.cross(half_u, half_v), center])
    return rectangle().placed(matrix)


def box(center: Vec, half: Vec, turn: float = 0.0) -> Surface:
    """A closed box with half sides `half`, turned by `turn` degrees about the y axis through its centre."""
    matrix = np.eye(4)
    matrix[:3, :3] = rotation((0, 1, 0), turn) * half
    matrix[:3, 3] = center
    return cube().placed(matrix)


def room(half_x: float, height: float, half_z: float) -> tuple[tuple[str, Surface], ...]:
    """The six inner faces of a room that stands on y = 0, each with its name and its front to the inside."""
    x, y, z = (half_x, 0.0, 0.0), (0.0, height / 2, 0.0), (0.0, 0.0, half_z)
    middle = height / 2
    return (
        ("floor", plate((0, 0, 0), z, x)),
        ("ceiling", plate((0, height, 0), x, z)),
        ("left wall", plate((-half_x, middle, 0), y, z)),
        ("right wall", plate((half_x, middle, 0), z, y)),
        ("back wall", plate((0, middle, -half_z), x, y)),
        ("front wall", plate((0, middle, half_z), y, x)),
    )


def lamp(name: str, center: Vec, half_x: float, half_z: float, radiance: Rgb) -> Mesh:
    """A flat lamp that shines down."""
    return mesh(name, plate(center, (half_x, 0, 0), (0, 0, half_z)), LAMP.name, radiance)


def matte(name: str, reflectance: Rgb) -> Material:
    """A diffuse material."""
    return Material(name, diffuse=reflectance)


def glossy(name: str, reflectance: Rgb, share: float, alpha: float) -> Material:
    """`share` of a white GGX lobe of roughness `alpha` over a diffuse ground of `reflectance`."""
    r, g, b = reflectance
    ground = 1 - share
    return Material(name, diffuse=(ground * r, ground * g, ground * b), specular=(share, share, share), alpha=alpha)
