"""Mesh files: OBJ, PLY and STL, by themselves and in scenes; all that can be wrong with them."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

from lumel.errors import SceneError
from lumel.readers import load
from lumel.readers.meshes import read_mesh
from lumel.readers.surface import Surface
from reading import Reader, area, crosses, normals

# Three faces of a tetrahedron around the origin, with different angles at each vertex.
FAN = "v 0 0 0\nv 3 0 0\nv 0 2 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\n"
FAN_NORMALS = [[0.57735, 0.57735, 0.57735], [0, 0.480027, 0.877254], [0.426668, 0, 0.904408], [0.663321, 0.748335, 0]]  # Mitsuba's
SQUARE = "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\n"
PLY = (
    "ply\nformat {format} 1.0\nelement vertex {n}\nproperty float x\nproperty float y\nproperty float z\n{more}"
    "element face {m}\nproperty list uchar int vertex_indices\nend_header\n"
)
CORNERS = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"


def ply(vertices: str, faces: str, more: str = "") -> str:
    """An ascii PLY file."""
    header = PLY.format(format="ascii", n=vertices.count("\n"), m=faces.count("\n"), more=more)
    return header + vertices + faces


@pytest.fixture
def reader(tmp_path: Path) -> Reader:
    return Reader(tmp_path)


def shape(reader: Reader, name: str, content: str | bytes, more: str = "") -> str:
    """A shape with this mesh file."""
    data = content if isinstance(content, bytes) else content.encode()
    (reader.folder / name).write_bytes(data)
    return f'<shape type="{name[-3:]}"><string name="filename" value="{name}"/>{more}</shape>'


FLAT = '<boolean name="face_normals" value="true"/>'


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("q.obj", SQUARE + "f 1 2 3 4\n"),
        ("q.obj", SQUARE + "f -4 -3 -2 -1\n"),
        ("q.obj", "# square\r\n" + SQUARE + "vt 0 0\ng a\nf 1/1 2/1 3/1 # half\nusemtl b\ns 1\nl 1 2\nf 1 \\\n 3 4\n"),
        ("q.ply", ply(SQUARE.replace("v ", ""), "4 0 1 2 3\n")),
        ("q.ply", ply(SQUARE.replace("v ", ""), "3 0 1 2\n3 0 2 3\n")),
        (
            "q.ply",
            PLY.format(format="binary_little_endian", n=4, m=1, more="").encode()
            + struct.pack("<12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0)
            + struct.pack("<B4i", 4, 0, 1, 2, 3),
        ),
        (
            "q.ply",
            PLY.format(format="binary_big_endian", n=4, m=1, more="").encode()
            + struct.pack(">12f", -1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0)
            + struct.pack(">B4i", 4, 0, 1, 2, 3),
        ),
    ],
)
def test_a_square_in_all_ways(reader: Reader, name: str, content: str | bytes) -> None:
    mesh = reader.mesh(shape(reader, name, content, FLAT))
    assert (len(mesh.vertices), len(mesh.triangles), mesh.normals) == (4, 2, None)
    np.testing.assert_allclose(crosses(mesh), [[0, 0, 4]] * 2)


def test_polygons_become_fans(reader: Reader) -> None:
    pentagon = [(np.cos(a), np.sin(a)) for a in np.arange(5) * 2 * np.pi / 5]
    corners = "".join(f"{x:.9f} {y:.9f} 0\n" for x, y in pentagon)
    for name, content in [
        ("p.ply", ply(corners, "5 0 1 2 3 4\n")),
        ("p.ply", ply(corners, "5 0 1 2 3 4\n3 0 0 0\n4 0 0 0 0\n")),
        ("p.obj", "".join(f"v {line}\n" for line in corners.splitlines()) + "f 1 2 3 4 5\n"),
    ]:
        assert area(reader.mesh(shape(reader, name, content))) == pytest.approx(2.5 * np.sin(2 * np.pi / 5), rel=1e-6)


def test_smooth_normals_are_mitsubas(reader: Reader) -> None:
    mesh = reader.mesh(shape(reader, "fan.obj", FAN))
    np.testing.assert_allclose(normals(mesh), FAN_NORMALS, atol=1e-5)
    flipped = reader.mesh(shape(reader, "fan.obj", FAN, '<boolean name="flip_normals" value="true"/>'))
    np.testing.assert_allclose(normals(flipped), -np.array(FAN_NORMALS), atol=1e-5)
    np.testing.assert_allclose(crosses(flipped), -crosses(mesh))
    assert reader.mesh(shape(reader, "fan.obj", FAN, FLAT)).normals is None


def test_smooth_normals_where_faces_cancel_out(reader: Reader) -> None:
    mesh = reader.mesh(shape(reader, "sheet.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\nf 3 2 1\nf 4 4 4\n"))
    np.testing.assert_allclose(np.abs(normals(mesh)), [[0, 0, 1]] * 4)


def test_normals_of_the_file(reader: Reader) -> None:
    content = SQUARE + "vn 0 0.6 0.8\nf 1//1 2//1 3//1 4//1\n"
    np.testing.assert_allclose(normals(reader.mesh(shape(reader, "n.obj", content))), [[0, 0.6, 0.8]] * 4, atol=1e-6)
    assert reader.mesh(shape(reader, "n.obj", content, FLAT)).normals is None
    more = "property float nx\nproperty float ny\nproperty float nz\n"
    lines = "".join(f"{line} 0 3 4\n" for line in CORNERS.splitlines())
    np.testing.assert_allclose(
        normals(reader.mesh(shape(reader, "n.ply", ply(lines, "4 0 1 2 3\n", more)))), [[0, 0.6, 0.8]] * 4, atol=1e-6
    )


def test_normals_of_the_file_say_where_the_front_is(reader: Reader) -> None:
    # As Mitsuba's shading normals do: a reflection turns the winding, not the normals, and a winding against them does not count.
    content = SQUARE + "vn 0 0.6 0.8\nf 1//1 2//1 3//1 4//1\n"
    for steps, expected in [
        ('<scale x="-1"/>', [0, 0.6, 0.8]),
        ('<scale z="-1"/>', [0, 0.6, -0.8]),
        ('<scale y="2"/>', [0, 0.35112, 0.93633]),
    ]:
        mesh = reader.mesh(shape(reader, "n.obj", content, f'<transform name="to_world">{steps}</transform>'))
        np.testing.assert_allclose(normals(mesh), [expected] * 4, atol=1e-5)
        assert (crosses(mesh)[:, 2] * expected[2] > 0).all()
    against = reader.mesh(shape(reader, "n.obj", content.replace("0.8", "-0.8")))
    assert (crosses(against)[:, 2] < 0).all()


def test_without_normals_the_winding_says_where_the_front_is(reader: Reader) -> None:
    for extra in ("", FLAT):
        mesh = reader.mesh(shape(reader, "w.obj", SQUARE + "f 1 2 3 4\n", f'<transform name="to_world"><scale x="-1"/></transform>{extra}'))
        assert (crosses(mesh)[:, 2] < 0).all()


def test_hard_edges_stay_hard(reader: Reader) -> None:
    content = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 0 1\nvn 0 0 1\nvn 0 -1 0\nf 1//1 2//1 3//1\nf 1//2 2//2 4//2\n"
    mesh = reader.mesh(shape(reader, "edge.obj", content))
    np.testing.assert_allclose(normals(mesh)[mesh.triangles[0]], [[0, 0, 1]] * 3)
    np.testing.assert_allclose(normals(mesh)[mesh.triangles[1]], [[0, -1, 0]] * 3)


def test_a_file_is_read_once(reader: Reader, monkeypatch: pytest.MonkeyPatch) -> None:
    from lumel.readers import shapes

    read: list[Path] = []

    def counted(path: Path) -> Surface:
        read.append(path)
        return read_mesh(path)

    monkeypatch.setattr(shapes, "read_mesh", counted)
    body = shape(reader, "fan.obj", FAN)
    assert len(reader.scene(body * 3).meshes) == 3
    assert len(read) == 1


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("m.obj", "", "is empty: 0 vertices, 0 triangles"),
        ("m.obj", "garbage\n", "is empty"),
        ("m.obj", SQUARE, "is empty: 0 vertices, 0 triangles"),
        ("m.obj", SQUARE + "f 1 2 9\n", "m.obj:5: there is no vertex 9, only 4 come before"),
        ("m.obj", SQUARE + "f 0 1 2\n", "there is no vertex 0"),
        ("m.obj", SQUARE + "f 1 2 -5\n", "there is no vertex -5"),
        ("m.obj", SQUARE + "f 1//1 2//1 3//1\n", "there is no normal 1, only 0"),
        ("m.obj", SQUARE + "f a b c\n", "'a' is not the number of a vertex"),
        ("m.obj", SQUARE + "f 1 2\n", "3 or more corners, not 2"),
        ("m.obj", "v 0 0 nan\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "m.obj:1: 'nan' is not a finite number"),
        ("m.obj", "v 0 0\n", "needs 3 numbers, not 2"),
        ("m.ply", "", "Not a ply file"),
        ("m.ply", "ply\n", "cannot read"),
        ("m.ply", ply(CORNERS, ""), "is empty: 4 vertices, 0 triangles"),
        ("m.ply", ply(CORNERS, "3 0 1 9\n3 0 1 2\n3 0 1 -1\n"), "2 of 3 triangles have an index outside 0..3, the first is .0, 1, 9."),
        ("m.ply", ply("0 0 nan\n1 0 0\n1 1 inf\n", "3 0 1 2\n"), "2 of 3 vertices are NaN, infinite"),
        ("m.ply", ply("0 0 1e39\n1 0 0\n1 1 1\n", "3 0 1 2\n"), "1 of 3 vertices|cannot read"),
        ("m.ply", ply("0 0 x\n1 0 0\n1 1 1\n", "3 0 1 2\n"), "not made of 3 numbers|cannot read"),
        ("m.ply", ply(CORNERS, "2 0 1\n"), "fewer than 3 corners"),
        ("m.ply", ply(CORNERS, "3 0 1 2\n").replace("vertex 4", "vertex 400"), "cannot read|is empty"),
        ("m.ply", ply(CORNERS, "3 0 1 2\n").replace("vertex 4", "vertex 4000000000000"), "cannot read|is empty"),
        ("m.ply", ply(CORNERS, "3 0 1 2\n").replace("face 1", "face 9"), "1 of 9 elements 'face'"),
        ("m.ply", PLY.format(format="binary_little_endian", n=4, m=1, more="").encode() + b"\0" * 20, "cannot read"),
    ],
)
def test_broken_meshes(reader: Reader, name: str, content: str | bytes, message: str) -> None:
    body = shape(reader, name, content)
    with pytest.raises(SceneError, match=message):
        load(reader.folder / name)
    with pytest.raises(SceneError, match=message) as caught:
        reader.scene(body)
    assert all((problem.file, problem.line) == (str(reader.folder / "scene.xml"), 2) for problem in caught.value.problems)
    assert all(name in problem.message for problem in caught.value.problems)


def test_many_bad_lines_are_cut_short(tmp_path: Path) -> None:
    (tmp_path / "bad.obj").write_text("f x y z\n" * 1000)
    with pytest.raises(SceneError) as caught:
        load(tmp_path / "bad.obj")
    assert len(caught.value.problems) == 21
    assert "and 980 more problems" in str(caught.value)


def test_wrong_file_names(reader: Reader) -> None:
    shape(reader, "bust.ply", "x")
    shape(reader, "bust.obj", SQUARE + "f 1 2 3\n")
    for filename, message in [
        ("bsut.ply", "did you mean '.*bust.ply'"),
        ("none/bust.ply", "no directory"),
        (".", "it is a directory"),
        ("bust.obj", "does not end in .ply"),
    ]:
        with pytest.raises(SceneError, match=message):
            reader.scene(f'<shape type="ply"><string name="filename" value="{filename}"/></shape>')
    assert "lacks the string 'filename'" in reader.problem('<shape type="ply"/>')


def test_a_lamp_without_area(reader: Reader) -> None:
    body = shape(reader, "line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", '<emitter type="area"/>')
    assert "emits light but has no area" in reader.problem(body)


STL = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 1 1\nendloop\nendfacet\nendsolid\n"


@pytest.mark.parametrize(
    ("name", "content", "up", "smooth"),
    [("fan.obj", FAN, 1, True), ("fan.ply", ply(CORNERS, "4 0 1 2 3\n"), 1, True), ("a.stl", STL, 2, False), ("A.STL", STL, 2, False)],
)
def test_a_mesh_alone_gets_a_studio(tmp_path: Path, name: str, content: str, up: int, smooth: bool) -> None:
    (tmp_path / name).write_text(content)
    scene = load(tmp_path / name)
    thing, floor, lamp = scene.meshes
    assert thing.name == Path(name).stem
    assert (thing.normals is not None) == smooth
    assert scene.materials[thing.material].diffuse == (0.6,) * 3
    assert scene.materials[thing.material].two_sided
    assert floor.vertices[:, up].max() <= thing.vertices[:, up].min()
    assert np.ptp(floor.vertices[:, up]) < 1e-6
    assert crosses(floor)[0, up] > 0
    centre = thing.vertices.mean(axis=0)
    assert min(lamp.emission) > 0
    assert (lamp.vertices[:, up] > thing.vertices[:, up].max()).all()
    assert crosses(lamp)[0] @ (centre - lamp.vertices.mean(axis=0)) > 0
    (camera,) = scene.cameras
    assert camera.to_world[up, 1] > 0.5
    local = (thing.vertices - camera.to_world[:3, 3]) @ camera.to_world[:3, :3]
    assert (np.abs(local[:, :2]) < local[:, 2:] * camera.tan_half()).all()
    assert "a mesh alone" in scene.notes[0]


def test_a_broken_stl(tmp_path: Path) -> None:
    for data in (b"", b"junk", b"\0" * 84, b"\0" * 80 + b"\xff" * 4):
        (tmp_path / "m.stl").write_bytes(data)
        with pytest.raises(SceneError, match=r"m\.stl"):
            load(tmp_path / "m.stl")
