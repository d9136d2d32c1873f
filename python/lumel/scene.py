"""What a scene is: meshes, materials, point lights and cameras, as plain data made of numpy arrays.

Readers make scenes from files; `lumel.render` turns them into pictures. Lengths are metres, radiance is W/(m2 sr) in linear
Rec.709 RGB. Nothing here knows a file format.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
import numpy.typing as npt

Rgb = tuple[float, float, float]
FloatArray = npt.NDArray[np.float32]
IntArray = npt.NDArray[np.int32]
FovAxis = Literal["x", "y", "diagonal", "smaller", "larger"]

BLACK: Rgb = (0.0, 0.0, 0.0)
LUMINANCE = np.array((0.2126, 0.7152, 0.0722))  # of linear Rec.709 RGB: rgb @ LUMINANCE


@dataclass(frozen=True)
class Material:
    """How a surface reflects: Lambert + one GGX lobe + a perfect mirror, each with its own RGB share.

    f = diffuse/pi + specular * F D G1(wi) G1(wo) / (4 cos cos) + a mirror of reflectance mirror * F. Shares are within 0..1 and
    the sum of the albedos must not exceed 1 in any channel. F is 1 where `eta` is None, else the Fresnel
    reflectance of the complex index eta + i k (k = 0: a dielectric seen from outside). `alpha` (0.001..1) is the GGX
    roughness. A surface that is not `two_sided` is black on its back (it still blocks light).
    """

    name: str
    diffuse: Rgb = BLACK
    specular: Rgb = BLACK
    alpha: float = 0.1
    mirror: Rgb = BLACK
    eta: Rgb | None = None
    k: Rgb = BLACK
    two_sided: bool = True


@dataclass(frozen=True)
class Mesh:
    """Triangles of one material.

    `vertices` (n, 3) float32 in metres, `triangles` (m, 3) int32, counter-clockwise seen from the front. `normals` (n, 3)
    float32 are interpolated for shading; None shades each triangle flat. `emission` is the radiance that
    the front side emits, equal in all directions.
    """

    name: str
    vertices: FloatArray
    triangles: IntArray
    material: str
    normals: FloatArray | None = None
    emission: Rgb = BLACK


@dataclass(frozen=True)
class PointLight:
    """A lamp without size: radiant intensity `intensity` (W/sr, equal in all directions) at `position`."""

    name: str
    position: Rgb
    intensity: Rgb


@dataclass(frozen=True)
class Camera:
    """A pinhole camera. `to_world` (4, 4): columns left, up, forward, origin (Mitsuba's convention: it looks along its +z and
    its +x points to the left of the picture). `fov` in degrees along `fov_axis`; `width` and `height` in pixels."""

    name: str
    to_world: npt.NDArray[np.float64]
    fov: float = 60.0
    fov_axis: FovAxis = "x"
    width: int = 640
    height: int = 480

    @staticmethod
    def look_at(
        name: str, origin: Rgb, target: Rgb, up: Rgb = (0.0, 1.0, 0.0), *, fov: float = 60.0, width: int = 640, height: int = 480
    ) -> Camera:
        """A camera at `origin` that looks at `target`; `fov` is horizontal, in degrees."""
        return Camera(name, look_at(origin, target, up), fov, "x", width, height)

    def with_size(self, width: int, height: int) -> Camera:
        """The same camera with another film size, in pixels."""
        return replace(self, width=width, height=height)

    def tan_half(self) -> tuple[float, float]:
        """Tangents of half the horizontal and half the vertical field of view."""
        t = float(np.tan(np.radians(self.fov) / 2))
        aspect = self.width / self.height
        axis = self.fov_axis
        if axis == "smaller":
            axis = "y" if aspect > 1 else "x"
        elif axis == "larger":
            axis = "x" if aspect > 1 else "y"
        if axis == "y":
            return t * aspect, t
        if axis == "diagonal":
            height = t / float(np.hypot(aspect, 1.0))
            return height * aspect, height
        return t, t / aspect


def look_at(origin: Rgb, target: Rgb, up: Rgb = (0.0, 1.0, 0.0)) -> npt.NDArray[np.float64]:
    """The (4, 4) matrix with columns left, up, forward, origin. Raises ValueError where origin = target or up is along the view."""
    o, t, u = (np.asarray(v, dtype=np.float64) for v in (origin, target, up))
    forward = t - o
    left = np.cross(u, forward)
    if not np.all(np.isfinite([o, t, u])) or not np.linalg.norm(left) > 0:
        raise ValueError(f"look_at needs origin != target and up not along the view: origin {origin}, target {target}, up {up}")
    forward /= np.linalg.norm(forward)
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, 0], matrix[:3, 1], matrix[:3, 2], matrix[:3, 3] = left, np.cross(forward, left), forward, o
    return matrix


@dataclass(frozen=True)
class Scene:
    """All that a render needs. `materials` by name; `notes` say what a reader ignored or assumed; `source` names where it came from."""

    meshes: tuple[Mesh, ...]
    materials: Mapping[str, Material]
    lights: tuple[PointLight, ...] = ()
    cameras: tuple[Camera, ...] = ()
    notes: tuple[str, ...] = ()
    source: str = ""
    lines: Mapping[str, int] = field(default_factory=dict)  # name of a mesh, material, light or camera -> line in `source`

    @property
    def triangle_count(self) -> int:
        """Triangles of all meshes."""
        return sum(len(mesh.triangles) for mesh in self.meshes)
