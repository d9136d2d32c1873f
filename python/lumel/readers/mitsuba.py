"""Reads scenes in the XML format of Mitsuba 3, a subset of it; everything outside the subset is reported by name and line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from ..errors import Problem, SceneError, nearest
from ..scene import Camera, Material, Mesh, PointLight, Scene
from .bsdfs import DEFAULT, BsdfReader, Reflection, to_material
from .defaults import framed_camera
from .findings import Findings
from .plugins import Plugin, check_attributes, is_supported
from .references import References
from .sensors import read_sensor
from .shapes import ShapeReader
from .tree import Node
from .xml_files import read_tree

_HARMLESS = ("integrator", "sampler")  # say how to render, not what


def read_mitsuba(path: Path, defines: Mapping[str, str], lenient: bool) -> Scene:
    """The scene in `path`, `defines` for its `$name`s.

    Raises SceneError with all problems; `lenient` leaves out what is not supported and lists it in the notes.
    """
    findings = Findings()
    root = read_tree(path, defines, findings)
    scene = None
    if root is not None and root.tag == "scene":
        scene = _SceneReader(root, path, findings).read()
    elif root is not None:
        findings.wrong(f"the outermost element is <{root.tag}>, not <scene>", root)
    notes = findings.conclude(lenient)
    assert scene is not None  # else there is a problem, and conclude has raised
    if not scene.meshes:
        raise SceneError(Problem("the scene is empty: none of its shapes is supported", str(path), 1))
    return replace(scene, notes=notes)


class _SceneReader:
    def __init__(self, root: Node, path: Path, findings: Findings) -> None:
        self._root = root
        self._source = str(path)
        self._findings = findings
        references = References(root, findings)
        self._bsdfs = BsdfReader(references, findings)
        spheres = sum(node.tag == "shape" and node.type == "sphere" for node in root.children)
        self._shapes = ShapeReader(references, self._bsdfs, findings, spheres)
        self._lines: dict[str, int] = {}
        self._names = references.names()
        self._names_by_node: dict[int, str] = {}
        self._materials: dict[str, Material] = {}
        self._meshes: list[Mesh] = []
        self._lights: list[PointLight] = []
        self._cameras: list[Camera] = []

    def read(self) -> Scene:
        """Read all; the notes are still missing."""
        self._check_root()
        readers = {"shape": self._shape, "bsdf": self._bsdf, "emitter": self._emitter, "sensor": self._sensor}
        for node in self._root.children:
            if node.tag in readers:
                readers[node.tag](node)
            elif node.tag not in _HARMLESS:
                kind = f"{node.tag} '{node.type}'" if node.type else f"<{node.tag}>"
                self._findings.unsupported(f"{kind} is not supported; {nearest(node.tag, [*readers, *_HARMLESS])}", node)
        if not any(node.tag == "shape" for node in self._root.children):
            self._findings.wrong("the scene is empty: it has no shapes", self._root)
        if not self._cameras and self._meshes:
            self._cameras.append(framed_camera(self._meshes))
            self._findings.note("the scene has no camera; one that shows all of it is framed")
        return Scene(
            tuple(self._meshes), self._materials, tuple(self._lights), tuple(self._cameras), source=self._source, lines=self._lines
        )

    def _check_root(self) -> None:
        check_attributes(self._root, self._findings)
        version = self._root.attributes.get("version", "3.0.0")
        if version.split(".")[0] not in ("2", "3"):
            self._findings.wrong(f"scene version '{version[:40]}' is not supported; allowed: 3.x.x, 2.x.x", self._root)

    def _name(self, node: Node) -> str:
        """The element's id, or a name made of its type and line."""
        file = "" if node.file == self._source else f"{node.file} "
        name = node.id or self._unused(f"{node.type}@{file}line {node.line}")
        if not file:
            self._lines[name] = node.line
        return name

    def _unused(self, base: str) -> str:
        """`base`, with a number where something has that name already."""
        name, count = base, 1
        while name in self._names:
            count += 1
            name = f"{base} ({count})"
        self._names.add(name)
        return name

    def _shape(self, node: Node) -> None:
        name = self._name(node)
        mesh, bsdf, reflection = self._shapes.read(node, name)
        if mesh is not None:
            self._meshes.append(replace(mesh, material=self._material(bsdf, reflection)))

    def _material(self, bsdf: Node | None, reflection: Reflection) -> str:
        """The name of the material that stands for `bsdf`, which is made on first use."""
        key = id(bsdf)
        if key not in self._names_by_node:
            name = self._name(bsdf) if bsdf else self._unused("default")
            self._names_by_node[key] = name
            self._materials[name] = to_material(name, reflection if bsdf else DEFAULT)
        return self._names_by_node[key]

    def _bsdf(self, node: Node) -> None:
        """Check it, even if no shape uses it."""
        self._bsdfs.read(node, f"bsdf {node.type}")

    def _emitter(self, node: Node) -> None:
        if not is_supported(node, ("point",), self._findings):
            return
        plugin = Plugin(node, self._findings, f"point emitter '{node.id}'" if node.id else "point emitter")
        intensity = plugin.colour("intensity", (1.0, 1.0, 1.0), light=True)
        position = plugin.point("position", (0.0, 0.0, 0.0))
        if plugin.has("to_world"):
            if plugin.has("position"):
                self._findings.wrong(f"{plugin.label}: give either 'position' or 'to_world'", node)
            x, y, z = plugin.transform("to_world")[:3, 3].tolist()
            position = (x, y, z)
        plugin.done()
        self._lights.append(PointLight(self._name(node), position, intensity))

    def _sensor(self, node: Node) -> None:
        name = node.id or self._unused(f"camera{len(self._cameras) + 1}")
        camera = read_sensor(node, name, self._findings)
        if camera is not None:
            self._cameras.append(camera)
            if node.file == self._source:
                self._lines[name] = node.line
