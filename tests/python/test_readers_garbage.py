"""Damaged files never give anything but a scene or a SceneError."""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from lumel.errors import SceneError
from lumel.readers import load
from lumel.scene import Scene

GOOD = """<scene version="3.0.0">
  <default name="size" value="0.5"/>
  <bsdf type="twosided" id="floor"><bsdf type="blendbsdf"><float name="weight" value="0.4"/>
    <bsdf type="diffuse"><rgb name="reflectance" value="0.7, 0.6, 0.5"/></bsdf>
    <bsdf type="roughconductor"><string name="distribution" value="ggx"/><float name="alpha" value="0.2"/>
      <rgb name="eta" value="0.2 0.9 1.1"/><rgb name="k" value="3.9 2.4 2.2"/></bsdf></bsdf></bsdf>
  <bsdf type="roughplastic" id="shiny"><string name="distribution" value="ggx"/><float name="int_ior" value="1.5"/></bsdf>
  <shape type="rectangle" id="a"><transform name="to_world"><scale x="1" y="2"/><rotate x="1" angle="-90"/></transform>
    <ref id="floor"/></shape>
  <shape type="sphere"><point name="center" x="1" y="2" z="3"/><float name="radius" value="$size"/><ref id="shiny"/></shape>
  <shape type="cylinder"><point name="p0" value="0 0 0"/><point name="p1" value="1 1 1"/><bsdf type="conductor"/></shape>
  <shape type="obj"><string name="filename" value="mesh.obj"/><boolean name="face_normals" value="true"/></shape>
  <shape type="disk"><emitter type="area"><rgb name="radiance" value="#ffeedd"/></emitter></shape>
  <emitter type="point"><rgb name="intensity" value="1 2 3"/><point name="position" value="1 2 3"/></emitter>
  <sensor type="perspective" id="main"><string name="fov_axis" value="x"/><float name="fov" value="62"/>
    <transform name="to_world"><lookat origin="0.5,1.35,1.45" target="0,1.2,-0.3" up="0,1,0"/></transform>
    <film type="hdrfilm"><integer name="width" value="32"/><integer name="height" value="24"/></film></sensor>
  <include filename="part.xml"/>
</scene>
"""
OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n"
PLY = (
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
)
STL = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 1 1\nendloop\nendfacet\nendsolid\n"

# Cut [start, end) out of the text and put something in its place.
WORDS = [
    *("", '"', "<", ">", "/>", "<!--", "&lt;", "<![CDATA[", "<?x?>", "\0", "é", "$", "$size", "value", "x", "a", "ref", "include", "shape"),
    *("bsdf", "texture", "matrix", "scene.xml", "part.xml", "mesh.obj", "0", "-1", "nan", "inf", "1e999", "1e38", "-1e-300", "0 0 0"),
]
SCRAPS = st.one_of(st.text(max_size=8), st.sampled_from(WORDS))
EDITS = st.lists(st.tuples(st.integers(0, 10_000), st.integers(0, 12), SCRAPS), min_size=1, max_size=4)


def damaged(text: str, edits: list[tuple[int, int, str]]) -> bytes:
    """The text after all edits."""
    for start, length, scrap in edits:
        start %= len(text) + 1
        text = text[:start] + scrap + text[start + length :]
    return text.encode("utf-8", errors="replace")


def check(scene: Scene) -> None:
    """All that a scene promises."""
    assert scene.meshes
    assert scene.cameras
    for mesh in scene.meshes:
        assert np.isfinite(mesh.vertices).all()
        assert mesh.triangles.min() >= 0
        assert mesh.triangles.max() < len(mesh.vertices)
        assert min(mesh.emission) >= 0
        assert np.isfinite(mesh.emission).all()
        if mesh.normals is not None:
            np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)
        material = scene.materials[mesh.material]
        assert 0.001 <= material.alpha <= 1
        shares = np.array([material.diffuse, material.specular, material.mirror])
        assert shares.min() >= 0
        assert shares.max() <= 1
    for camera in scene.cameras:
        assert np.isfinite(camera.to_world).all()
        assert 0 < camera.fov < 180
        assert min(camera.width, camera.height) >= 1


def read_or_refuse(files: dict[str, bytes], name: str, *, lenient: bool = False) -> None:
    """Load `name` from a folder with these files; the outcome must be a good scene or a SceneError."""
    with tempfile.TemporaryDirectory() as folder:
        for file, data in files.items():
            Path(folder, file).write_bytes(data)
        try:
            scene = load(Path(folder, name), lenient=lenient)
        except SceneError:
            return
        check(scene)


FILES = {"mesh.obj": OBJ.encode(), "part.xml": b'<scene version="3.0.0"><shape type="cube"/></scene>'}


def test_the_undamaged_scene_is_good() -> None:
    read_or_refuse({"scene.xml": GOOD.encode(), **FILES}, "scene.xml")
    with tempfile.TemporaryDirectory() as folder:
        for file, data in {"scene.xml": GOOD.encode(), **FILES}.items():
            Path(folder, file).write_bytes(data)
        assert len(load(Path(folder, "scene.xml")).meshes) == 6


@settings(max_examples=200, deadline=None)
@given(EDITS, st.booleans())
def test_damaged_xml(edits: list[tuple[int, int, str]], lenient: bool) -> None:
    read_or_refuse({"scene.xml": damaged(GOOD, edits), **FILES}, "scene.xml", lenient=lenient)


NUMBERS = st.one_of(st.floats().map(repr), st.integers().map(str), st.sampled_from(["1e30", "-1e30", "1e-30", "0", "-0.0", "1e-320"]))


@settings(max_examples=100, deadline=None)
@given(st.lists(NUMBERS, min_size=20, max_size=20))
def test_any_numbers(numbers: list[str]) -> None:
    n = iter(numbers)
    body = (
        f'<shape type="sphere"><float name="radius" value="{next(n)}"/><point name="center" value="{next(n)} {next(n)} {next(n)}"/></shape>'
        f'<shape type="cylinder"><float name="radius" value="{next(n)}"/><point name="p1" value="{next(n)} {next(n)} {next(n)}"/></shape>'
        '<shape type="obj"><string name="filename" value="mesh.obj"/><transform name="to_world">'
        f'<scale value="{next(n)} {next(n)} {next(n)}"/><rotate x="{next(n)}" y="1" angle="{next(n)}"/></transform>'
        f'<bsdf type="plastic"><float name="int_ior" value="{next(n)}"/></bsdf></shape>'
        f'<sensor type="perspective"><float name="fov" value="{next(n)}"/><transform name="to_world">'
        f'<lookat origin="{next(n)} 0 0" target="0 {next(n)} {next(n)}" up="0 1 {next(n)}"/></transform></sensor>'
    )
    for part in (
        body,
        *(f"{shape}</shape>" for shape in body.split("</shape>")[:3]),
        body[body.index("<sensor") :] + '<shape type="cube"/>',
    ):
        read_or_refuse({"scene.xml": f'<scene version="3.0.0">{part}</scene>'.encode(), **FILES}, "scene.xml")


@settings(max_examples=100, deadline=None)
@given(st.sampled_from([("m.obj", OBJ), ("m.ply", PLY), ("m.stl", STL)]), EDITS)
def test_damaged_meshes(mesh: tuple[str, str], edits: list[tuple[int, int, str]]) -> None:
    name, text = mesh
    read_or_refuse({name: damaged(text, edits)}, name)


@settings(max_examples=100, deadline=None)
@given(st.sampled_from(["m.xml", "m.obj", "m.ply", "m.stl"]), st.binary(max_size=200))
def test_any_bytes(name: str, data: bytes) -> None:
    for prefix in (b"", b"ply\nformat binary_little_endian 1.0\nelement vertex 3\n", b"<scene>"):
        read_or_refuse({name: prefix + data}, name)
