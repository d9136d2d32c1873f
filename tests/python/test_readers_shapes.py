"""Shapes: their area, place, orientation and normals. Numbers marked so were computed by Mitsuba 3.9.1."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lumel.scene import Mesh
from reading import Reader, area, crosses, normals


@pytest.fixture
def reader(tmp_path: Path) -> Reader:
    return Reader(tmp_path)


def place(steps: str) -> str:
    """A to_world."""
    return f'<transform name="to_world">{steps}</transform>'


WIDE = place('<scale x="2"/>')
FLIP = '<boolean name="flip_normals" value="true"/>'
SLANTED = '<point name="p0" value="1,2,3"/><point name="p1" value="1.5,-2,3"/><float name="radius" value=".4"/>'
ELLIPSE = place('<scale value="2,3,0.5"/><rotate x="1" angle="40"/><translate x="5"/>')


@pytest.mark.parametrize(
    ("shape", "expected", "triangles"),
    [
        ('<shape type="rectangle"/>', 4, 2),
        ('<shape type="cube"/>', 24, 12),
        ('<shape type="sphere"/>', 4 * np.pi, 5120),
        ('<shape type="sphere"><float name="radius" value="0.25"/><point name="center" value="1 2 3"/></shape>', np.pi / 4, 5120),
        ('<shape type="disk"/>', np.pi, 512),
        (f'<shape type="disk">{WIDE}</shape>', 2 * np.pi, 512),
        ('<shape type="cylinder"/>', 2 * np.pi, None),
        (f'<shape type="cylinder">{SLANTED}</shape>', 0.8 * np.pi * np.sqrt(16.25), None),
    ],
)
def test_area_is_that_of_the_true_surface(reader: Reader, shape: str, expected: float, triangles: int | None) -> None:
    mesh = reader.mesh(shape)
    assert area(mesh) == pytest.approx(expected, rel=1e-5)
    assert triangles in (None, len(mesh.triangles))


def closed(mesh: Mesh) -> float:
    """Enclosed volume; positive where the front is outside."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(np.float64) for i in range(3))
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_closed_shapes_face_outwards(reader: Reader) -> None:
    assert closed(reader.mesh('<shape type="cube"/>')) == pytest.approx(8)
    assert closed(reader.mesh('<shape type="sphere"/>')) == pytest.approx(4 / 3 * np.pi, rel=2e-3)
    assert closed(reader.mesh(f'<shape type="cube">{FLIP}</shape>')) == pytest.approx(-8)
    assert closed(reader.mesh(f'<shape type="sphere">{FLIP}</shape>')) < 0


# The side of the front for each reflection, as in Mitsuba (its shading normal decides).
@pytest.mark.parametrize("flip", [False, True])
@pytest.mark.parametrize(
    ("kind", "in_x", "in_z"),
    [("rectangle", 1, -1), ("disk", 1, -1), ("cube", 1, 1), ("sphere", -1, -1), ("cylinder", 1, 1)],
)
def test_reflections_keep_the_front_where_mitsuba_has_it(reader: Reader, kind: str, in_x: int, in_z: int, flip: bool) -> None:
    for axis, sign in (("y", in_x), ("x", in_x), ("z", in_z)):
        mirror = place(f'<scale {axis}="-1"/>')
        mesh = reader.mesh(f'<shape type="{kind}">{mirror}{FLIP if flip else ""}</shape>')
        if kind in ("rectangle", "disk"):
            side = crosses(mesh)[:, 2]
        else:
            middles = mesh.vertices[mesh.triangles].mean(axis=1)
            middles[:, 2] *= kind != "cylinder"
            side = np.einsum("ij,ij->i", crosses(mesh), middles)
        assert (np.sign(side) == (-sign if flip else sign)).all(), (kind, axis)


@pytest.mark.parametrize("kind", ["sphere", "cylinder"])
@pytest.mark.parametrize("extra", ["", FLIP])
def test_normals_are_exact_under_any_transform(reader: Reader, kind: str, extra: str) -> None:
    mesh = reader.mesh(f'<shape type="{kind}">{ELLIPSE}{extra}</shape>')
    np.testing.assert_allclose(np.linalg.norm(normals(mesh), axis=1), 1, atol=1e-6)
    turn = np.radians(40)
    linear = np.array([[1, 0, 0], [0, np.cos(turn), -np.sin(turn)], [0, np.sin(turn), np.cos(turn)]]) @ np.diag([2, 3, 0.5])
    local = (mesh.vertices - [5, 0, 0]) @ np.linalg.inv(linear).T
    if kind == "cylinder":
        local[:, 2] = 0
    gradient = local @ np.linalg.inv(linear)  # of x^2 + y^2 + z^2 - 1 in the object's space
    expected = gradient / np.linalg.norm(gradient, axis=1, keepdims=True) * (-1 if extra else 1)
    np.testing.assert_allclose(normals(mesh), expected, atol=2e-6)
    assert (np.einsum("ij,ij->i", crosses(mesh), normals(mesh)[mesh.triangles].mean(axis=1)) > 0).all()


def test_flat_shapes_have_no_normals(reader: Reader) -> None:
    for kind in ("rectangle", "cube", "disk"):
        assert reader.mesh(f'<shape type="{kind}"/>').normals is None


def test_many_spheres_get_fewer_triangles(reader: Reader) -> None:
    scene = reader.scene('<shape type="sphere"/>' * 200)
    assert sum(len(mesh.triangles) for mesh in scene.meshes) <= 100_000
    assert area(scene.meshes[0]) == pytest.approx(4 * np.pi, rel=1e-5)


@pytest.mark.parametrize(
    ("steps", "expected"),
    [
        ('<scale value="2"/>', [[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0]]),
        ('<scale x="2"/>', [[2, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]]),
        ('<translate value="1 2 3"/>', [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3]]),
        ('<translate y="1"/><scale value="2,3,4"/>', [[2, 0, 0, 0], [0, 3, 0, 3], [0, 0, 4, 0]]),
        ('<scale value="2,3,4"/><translate y="1"/>', [[2, 0, 0, 0], [0, 3, 0, 1], [0, 0, 4, 0]]),
        ('<rotate x="1" angle="90"/>', [[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0]]),
        ('<rotate z="5" angle="90"/>', [[0, -1, 0, 0], [1, 0, 0, 0], [0, 0, 1, 0]]),
        ('<matrix value="1 0 0 0 1 0 0 0 2"/>', [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0]]),
        ('<matrix value="1 0 0 5, 0 1 0 6, 0 0 2 7, 0 0 0 1"/>', [[1, 0, 0, 5], [0, 1, 0, 6], [0, 0, 2, 7]]),
        ('<lookat origin="0,0,0" target="0,0,1"/>', [[0, 1, 0, 0], [-1, 0, 0, 0], [0, 0, 1, 0]]),
        ('<lookat origin="1,0,0" target="1,0,5" up="0,1,0"/>', [[1, 0, 0, 1], [0, 1, 0, 0], [0, 0, 1, 0]]),
    ],
)
def test_transforms_are_mitsubas(reader: Reader, steps: str, expected: list[list[float]]) -> None:
    plain = reader.mesh('<shape type="cube"/>').vertices
    moved = reader.mesh(f'<shape type="cube">{place(steps)}</shape>').vertices
    np.testing.assert_allclose(moved, np.c_[plain, np.ones(8)] @ np.array(expected).T, atol=1e-6)


def test_emission(reader: Reader) -> None:
    for value, expected in [
        ('<rgb name="radiance" value="1 2 3"/>', (1, 2, 3)),
        ('<rgb name="radiance" value=" 1,,2 ,3 "/>', (1, 2, 3)),
        ('<float name="radiance" value="2"/>', (2, 2, 2)),
        ('<rgb name="radiance" value="#ff8000"/>', (1, 0.21586050, 0)),
        ('<spectrum name="radiance" value="2"/>', (2.4095879, 1.896582, 1.8178321)),  # Mitsuba's numbers
        ("", (1, 1, 1)),
    ]:
        mesh = reader.mesh(f'<shape type="rectangle"><emitter type="area">{value}</emitter></shape>')
        np.testing.assert_allclose(mesh.emission, expected, rtol=1e-6)
    assert reader.mesh('<shape type="rectangle"/>').emission == (0, 0, 0)
