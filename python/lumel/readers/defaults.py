"""What a scene gets that has none of its own: a camera that shows everything, and a studio for a bare mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..scene import Camera, Material, Mesh, Rgb, look_at
from .primitives import rectangle
from .surface import Points

_FOV = 40.0  # degrees, along the shorter side of the picture
_WIDTH, _HEIGHT = 640, 480
_FARTHEST = 1e9  # m: what is farther off is not rendered
_Y_UP: Rgb = (0.0, 1.0, 0.0)

GREY = Material("grey", diffuse=(0.6, 0.6, 0.6), two_sided=True)
_FLOOR = Material("floor", diffuse=(0.5, 0.5, 0.5), two_sided=True)
_LAMP = Material("lamp")


def framed_camera(meshes: Sequence[Mesh], up: Rgb = _Y_UP) -> Camera:
    """A camera named `default` that sees the bounding box of all meshes from the front, right and above; `up` is the vertical axis."""
    low, high = _bounds(meshes)
    centre = (low + high) / 2
    radius = _radius(low, high)
    side, front = _horizontal(up)
    view = unit_sum((side, 0.45), (front, 1.0), (np.array(up), 0.35))
    to_world = look_at(_rgb(view), (0.0, 0.0, 0.0), up)
    to_world[:3, 3] = centre + view * radius / np.sin(np.radians(_FOV / 2))
    return Camera("default", to_world, _FOV, "smaller", _WIDTH, _HEIGHT)


def studio(meshes: Sequence[Mesh], up: Rgb = _Y_UP) -> tuple[tuple[Mesh, ...], dict[str, Material]]:
    """A grey floor below the meshes and a lamp above them on the camera's left, with the materials of both."""
    low, high = _bounds(meshes)
    centre, radius = (low + high) / 2, _radius(low, high)
    vertical = np.array(up)
    side, front = _horizontal(up)
    foot = centre - vertical * float((centre - low) @ np.abs(vertical))
    floor = _quad("floor", foot - vertical * 1e-3 * radius, vertical, 6 * radius, "floor")
    towards = unit_sum((side, -0.6), (front, 0.7), (vertical, 1.2))
    # As wide as the object, 3 radii away: the irradiance at the centre is about pi, so a white surface there has radiance 1.
    lamp = _quad("lamp", centre + 3 * radius * towards, -towards, radius / 2, "lamp", emission=9 * np.pi)
    return (floor, lamp), {"floor": _FLOOR, "lamp": _LAMP}


def unit_sum(*terms: tuple[Points, float]) -> Points:
    """The direction of a weighted sum of vectors."""
    total = sum((vector * weight for vector, weight in terms), np.zeros(3))
    return np.asarray(total / np.linalg.norm(total))


def _quad(name: str, centre: Points, normal: Points, half: float, material: str, emission: float = 0) -> Mesh:
    """A square that faces along `normal`, with sides of 2 `half`."""
    helper = np.eye(3)[int(np.argmin(np.abs(normal)))]
    x = unit_sum((np.cross(helper, normal), 1.0))
    flat = rectangle()
    vertices = centre + half * (flat.vertices @ np.array([x, np.cross(normal, x), normal]))
    return Mesh(name, vertices.astype(np.float32), flat.triangles.astype(np.int32), material, emission=(emission,) * 3)


def _horizontal(up: Rgb) -> tuple[Points, Points]:
    """The directions to the right and to the viewer."""
    if abs(up[2]) > 0.5:
        return np.array([1.0, 0.0, 0.0]), np.array([0.0, -1.0, 0.0])
    return np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def _bounds(meshes: Sequence[Mesh]) -> tuple[Points, Points]:
    """Corners of the bounding box of all triangles that can be rendered."""
    corners = np.concatenate([np.zeros((0, 3, 3)), *(mesh.vertices[mesh.triangles].astype(np.float64) for mesh in meshes)])
    points = corners[(np.abs(corners) <= _FARTHEST).all(axis=(1, 2))].reshape(-1, 3)
    if not len(points):
        points = np.zeros((1, 3))
    return points.min(axis=0), points.max(axis=0)


def _radius(low: Points, high: Points) -> float:
    """Of the sphere around the box; 1 for a single point."""
    radius = float(np.linalg.norm(high - low)) / 2
    return radius if radius > 0 else 1.0


def _rgb(vector: Points) -> Rgb:
    x, y, z = vector.tolist()
    return x, y, z
