"""Short ways to say what the built-in scenes are made of."""

from __future__ import annotations

import numpy as np

from ..scene import BLACK, Material, Mesh, Rgb
from .primitives import Form, Vec, rectangle

LAMP = Material("lamp")  # black: it shines and does not reflect


def mesh(name: str, form: Form, material: str, emission: Rgb = BLACK) -> Mesh:
    """A mesh of one material from a form."""
    vertices, triangles, normals = form
    return Mesh(name, vertices.astype(np.float32), triangles, material, normals.astype(np.float32), emission)


def matte(name: str, reflectance: Rgb) -> Material:
    """A diffuse material."""
    return Material(name, diffuse=reflectance)


def glossy(name: str, reflectance: Rgb, share: float, alpha: float) -> Material:
    """`share` of a white GGX lobe of roughness `alpha` over a diffuse ground of `reflectance`."""
    r, g, b = reflectance
    ground = 1 - share
    return Material(name, diffuse=(ground * r, ground * g, ground * b), specular=(share, share, share), alpha=alpha)


def room(half_x: float, height: float, half_z: float) -> tuple[tuple[str, Form], ...]:
    """The six inner faces of a room that stands on y = 0, each with its name and its front to the inside."""
    x, y, z = (half_x, 0.0, 0.0), (0.0, height / 2, 0.0), (0.0, 0.0, half_z)
    mid = height / 2
    return (
        ("floor", rectangle((0, 0, 0), z, x)),
        ("ceiling", rectangle((0, height, 0), x, z)),
        ("left wall", rectangle((-half_x, mid, 0), y, z)),
        ("right wall", rectangle((half_x, mid, 0), z, y)),
        ("back wall", rectangle((0, mid, -half_z), x, y)),
        ("front wall", rectangle((0, mid, half_z), y, x)),
    )


def lamp(name: str, center: Vec, half_x: float, half_z: float, radiance: Rgb) -> Mesh:
    """A flat lamp that shines down, black where it does not."""
    return mesh(name, rectangle(center, (half_x, 0, 0), (0, 0, half_z)), "lamp", radiance)
