"""Mitsuba's shapes as meshes."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from ..errors import SceneError
from ..scene import BLACK, Mesh, Rgb
from . import primitives
from .bsdfs import DEFAULT, BsdfReader, Reflection
from .findings import Findings
from .meshes import read_mesh
from .plugins import Plugin, is_supported
from .references import References
from .surface import Surface
from .tree import Node

_SPHERE_LEVEL = 4
_SPHERE_TRIANGLES = 100_000  # in all; with many spheres each gets fewer
_LARGEST = 1e30  # metres


class ShapeReader:
    """Reads the shapes of one scene; `spheres` is how many of them are spheres. Mesh files are read once each."""

    def __init__(self, references: References, bsdfs: BsdfReader, findings: Findings, spheres: int) -> None:
        self._references = references
        self._bsdfs = bsdfs
        self._findings = findings
        self._files: dict[Path, Surface | SceneError] = {}
        self.sphere_level = _SPHERE_LEVEL
        while self.sphere_level > 1 and spheres * 20 * 4**self.sphere_level > _SPHERE_TRIANGLES:
            self.sphere_level -= 1

    def read(self, node: Node, name: str) -> tuple[Mesh | None, Node | None, Reflection]:
        """The mesh, without its material yet; the `<bsdf>` it is made of (None: the default) and what that reflects.

        The mesh is None after a problem, which is reported.
        """
        label = f"shape '{name}'" if node.id else f"shape {node.type}"
        if not is_supported(node, _SHAPES, self._findings):
            return None, None, DEFAULT
        plugin = Plugin(node, self._findings, label)
        surface = _SHAPES[node.type](self, plugin)
        if plugin.flag("flip_normals", False) and surface:
            surface = surface.flipped()
        bsdf, reflection = self._bsdf(plugin)
        emission = self._emission(plugin, surface)
        plugin.done()
        if surface is None:
            return None, bsdf, reflection
        if not np.abs(surface.vertices).max() < _LARGEST:
            self._findings.wrong(f"{label}: its size or place is beyond {_LARGEST:g} m", node)
            return None, bsdf, reflection
        vertices, triangles, normals = surface.arrays()
        return Mesh(name, vertices, triangles, "", normals, emission), bsdf, reflection

    def _bsdf(self, plugin: Plugin) -> tuple[Node | None, Reflection]:
        nodes = plugin.children("bsdf", "ref")
        for extra in nodes[1:]:
            self._findings.wrong(f"{plugin.label}: has more than one bsdf", extra)
        found = self._references.resolve(nodes[0], "bsdf") if nodes else None
        return found, self._bsdfs.read(found, f"bsdf of {plugin.label}") if found else DEFAULT

    def _emission(self, plugin: Plugin, surface: Surface | None) -> Rgb:
        nodes = plugin.children("emitter")
        for extra in nodes[1:]:
            self._findings.wrong(f"{plugin.label}: has more than one emitter", extra)
        if not nodes:
            return BLACK
        node = nodes[0]
        if not is_supported(node, ("area",), self._findings, plugin.label):
            return BLACK
        emitter = Plugin(node, self._findings, f"area emitter of {plugin.label}")
        radiance = emitter.colour("radiance", (1.0, 1.0, 1.0), light=True)
        emitter.done()
        if surface is not None and not surface.area() > 0:
            self._findings.wrong(f"{plugin.label}: emits light but has no area", node)
        return radiance

    def file(self, plugin: Plugin) -> Surface | None:
        """The surface in the file of an `obj` or `ply`."""
        node = plugin.node
        name = plugin.text("filename", "")
        if not name:
            self._findings.wrong(f"{plugin.label}: lacks the string 'filename'", node)
            return None
        path = Path(node.file).parent / name
        if path not in self._files:
            self._files[path] = _read(path, node.type)
        found = self._files[path]
        if isinstance(found, Surface):
            if found.left_out:
                self._findings.unsupported(f"{plugin.label}: {found.left_out}", node)
            return found
        for problem in found.problems:
            self._findings.wrong(f"{plugin.label}: {problem}", node)
        return None


def _read(path: Path, kind: str) -> Surface | SceneError:
    try:
        if path.suffix.lower() != f".{kind}" and path.is_file():
            return SceneError(f"'{path}' does not end in .{kind}")
        return read_mesh(path)
    except SceneError as error:
        return error
    except (OSError, ValueError) as error:
        return SceneError(f"cannot read '{path}': {error}")


def _placed(surface: Surface, plugin: Plugin) -> Surface:
    """In the world. As in Mitsuba, a reflection keeps the front of these shapes where their normal goes."""
    matrix = plugin.transform("to_world")
    placed = surface.placed(matrix)
    return placed.flipped() if np.linalg.det(matrix[:3, :3]) < 0 else placed


def _rectangle(_: ShapeReader, plugin: Plugin) -> Surface:
    plugin.skip("face_normals")
    return _placed(primitives.rectangle(), plugin)


def _cube(_: ShapeReader, plugin: Plugin) -> Surface:
    plugin.skip("face_normals")
    return _placed(primitives.cube(), plugin)


def _disk(_: ShapeReader, plugin: Plugin) -> Surface:
    return _placed(primitives.disk(), plugin)


def _radius(plugin: Plugin) -> float:
    """In metres, above 0."""
    radius = plugin.number("radius", 1.0, 0)
    if radius > 0:
        return radius
    plugin.findings.wrong(f"{plugin.label}: 'radius' is 0, it must be above 0", plugin.node)
    return 1.0


def _sphere(reader: ShapeReader, plugin: Plugin) -> Surface:
    """Scaled unevenly, it becomes an ellipsoid. As in Mitsuba, a reflection turns it inside out."""
    place = np.diag([*[_radius(plugin)] * 3, 1.0])
    place[:3, 3] = plugin.point("center", (0.0, 0.0, 0.0))
    return primitives.sphere(reader.sphere_level).placed(plugin.transform("to_world") @ place)


def _cylinder(_: ShapeReader, plugin: Plugin) -> Surface:
    p0, p1 = np.array(plugin.point("p0", (0.0, 0.0, 0.0))), np.array(plugin.point("p1", (0.0, 0.0, 1.0)))
    radius = _radius(plugin)
    if not np.linalg.norm(p1 - p0) > 0:
        plugin.findings.wrong(f"{plugin.label}: 'p0' and 'p1' are the same point", plugin.node)
        p1 = p0 + np.array([0.0, 0.0, 1.0])
    return _placed(primitives.cylinder(p0, p1, radius), plugin)


def _file(reader: ShapeReader, plugin: Plugin) -> Surface | None:
    """The triangles of a file: flat where `face_normals` says so, else with the file's normals, else smooth.

    Normals decide where the front is; without them the winding does.
    """
    surface = reader.file(plugin)
    flat = plugin.flag("face_normals", False)
    matrix = plugin.transform("to_world")
    if surface is None:
        return None
    if flat:
        return Surface(surface.vertices, surface.triangles).placed(matrix)
    if surface.normals is None:
        return surface.placed(matrix).smooth()
    placed = surface.placed(matrix)
    front = placed.flipped() if np.linalg.det(matrix[:3, :3]) < 0 else placed
    return front.facing_normals()


_SHAPES: dict[str, Callable[[ShapeReader, Plugin], Surface | None]] = {
    "rectangle": _rectangle,
    "cube": _cube,
    "sphere": _sphere,
    "disk": _disk,
    "cylinder": _cylinder,
    "obj": _file,
    "ply": _file,
}
