"""The built-in scenes: closed, well turned, the same at every call, and what their docs say."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
import pytest

from lumel.errors import SceneError
from lumel.scene import Mesh, Scene
from lumel.scenes import build, names
from lumel.scenes.implicit import ball, probe
from lumel.scenes.parts import box
from lumel.scenes.surface_nets import fisheye, polygonise

Floats = npt.NDArray[np.float64]


@pytest.fixture(scope="module")
def demo() -> Scene:
    return build("demo")


def corners(mesh: Mesh) -> Floats:
    return mesh.vertices.astype(np.float64)[mesh.triangles]


def cross(triangles: Floats) -> Floats:
    """Geometric normals, twice the area long."""
    return np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])


def volume(triangles: Floats) -> float:
    """Of a closed surface: positive where its front is outside."""
    return float(np.einsum("ij,ij->", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])) / 6)


def named(scene: Scene, name: str) -> Mesh:
    return next(mesh for mesh in scene.meshes if mesh.name == name)


def inner_box(scene: Scene, outer: tuple[str, ...]) -> Floats:
    return np.concatenate([corners(named(scene, name)) for name in outer])


def test_names_are_listed_and_unknown_ones_are_refused_with_the_nearest() -> None:
    assert names() == ("demo", "cornell", "furnace", "cube")
    with pytest.raises(SceneError, match=r"'cornel'.*did you mean 'cornell'.*allowed: cornell, cube, demo, furnace"):
        build("cornel")


@pytest.mark.parametrize("name", names())
def test_every_scene_is_sound(name: str) -> None:
    scene = build(name)
    assert scene.source == f"lumel:{name}"
    assert scene.cameras
    assert len({mesh.name for mesh in scene.meshes}) == len(scene.meshes)
    assert any(max(mesh.emission) > 0 for mesh in scene.meshes)
    for mesh in scene.meshes:
        assert mesh.material in scene.materials
        assert (mesh.vertices.dtype.name, mesh.triangles.dtype.name) == ("float32", "int32")
        normal = cross(corners(mesh))
        assert np.linalg.norm(normal, axis=1).min() > 1e-8
        if mesh.normals is None:
            continue
        assert (mesh.normals.dtype.name, mesh.normals.shape) == ("float32", mesh.vertices.shape)
        assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-5)
        # Each corner's shading normal is on the front side of its triangle.
        cosines = np.einsum("ij,ikj->ik", normal, mesh.normals[mesh.triangles]) / np.linalg.norm(normal, axis=1)[:, None]
        assert cosines.min() > 0.3
    for key, material in scene.materials.items():
        assert key == material.name
        shares = np.array([material.diffuse, material.specular, material.mirror])
        assert shares.min() >= 0
        assert shares.sum(axis=0).max() <= 1


@pytest.mark.parametrize("name", names())
def test_every_scene_is_the_same_at_every_call(name: str) -> None:
    one, two = build(name), build(name)
    assert one.materials == two.materials
    for a, b in zip(one.meshes, two.meshes, strict=True):
        assert (a.name, a.material, a.emission) == (b.name, b.material, b.emission)
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert a.triangles.tobytes() == b.triangles.tobytes()
        assert np.array_equal([] if a.normals is None else a.normals, [] if b.normals is None else b.normals)


def assert_closed(triangles: npt.NDArray[np.int32] | npt.NDArray[np.int64], euler: int) -> None:
    """Each edge joins two triangles, which run through it in opposite directions; the surface is in one piece of that characteristic."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    directed = {(int(a), int(b)) for a, b in edges}
    assert len(directed) == len(edges), "an edge is used twice in one direction"
    assert all((b, a) in directed for a, b in directed), "an edge has one side only"
    assert len(np.unique(triangles)) - len(edges) // 2 + len(triangles) == euler


def test_the_bust_is_one_closed_solid(demo: Scene) -> None:
    bust = named(demo, "bust")
    assert 12_000 <= len(bust.triangles) <= 15_000
    assert_closed(bust.triangles, euler=2)
    assert 0.03 < volume(corners(bust)) < 0.08  # m3
    # It stands 3 mm deep in the plinth, inside the room, below the lamps.
    low, high = bust.vertices.min(axis=0), bust.vertices.max(axis=0)
    assert low[1] == pytest.approx(named(demo, "plinth").vertices[:, 1].max() - 0.003, abs=1e-5)
    assert np.all(low > (-1.25, 0, -1.5))
    assert np.all(high < (1.25, 2.4, 1.5))


def test_the_bust_has_well_shaped_triangles(demo: Scene) -> None:
    triangles = corners(named(demo, "bust"))
    sides = np.linalg.norm(triangles - np.roll(triangles, 1, axis=1), axis=2)
    area = np.linalg.norm(cross(triangles), axis=1) / 2
    quality = 4 * math.sqrt(3) * area / (sides**2).sum(axis=1)  # 1 for an equilateral triangle
    assert np.median(quality) > 0.8
    assert quality.min() > 0.02


@pytest.mark.parametrize(("name", "size"), [("demo", (2.5, 2.5, 3.0)), ("cornell", (2.0, 2.0, 3.2))])
def test_rooms_are_closed_boxes_that_face_inwards(name: str, size: tuple[float, float, float]) -> None:
    walls = ("floor", "ceiling", "left wall", "right wall", "back wall", "front wall")
    triangles = inner_box(build(name), walls)
    assert volume(triangles) == pytest.approx(-math.prod(size), rel=1e-5)


@pytest.mark.parametrize("name", ["demo", "cornell"])
def test_lamps_face_down_inside_the_room_and_reflect_nothing(name: str) -> None:
    scene = build(name)
    lamps = [mesh for mesh in scene.meshes if max(mesh.emission) > 0]
    ceiling = named(scene, "ceiling").vertices[0, 1]
    assert len(lamps) == (2 if name == "demo" else 1)
    for lamp in lamps:
        normal = cross(corners(lamp))
        assert np.all(normal[:, 1] < 0)
        assert np.allclose(normal[:, [0, 2]], 0)
        assert lamp.vertices[:, 1].max() < ceiling
        assert scene.materials[lamp.material].diffuse == (0.0, 0.0, 0.0)


def test_cameras_of_the_demo_look_at_the_bust(demo: Scene) -> None:
    middle = named(demo, "bust").vertices.mean(axis=0)
    assert [camera.name for camera in demo.cameras] == ["main", "side"]
    for camera in demo.cameras:
        towards = middle - camera.to_world[:3, 3]
        assert towards @ camera.to_world[:3, 2] / np.linalg.norm(towards) > math.cos(math.radians(15))


def test_the_furnace_holds_the_radiance_one() -> None:
    scene = build("furnace")
    (wall,) = scene.meshes
    assert_closed(wall.triangles, euler=2)
    assert volume(corners(wall)) == pytest.approx(-4 / 3 * math.pi, rel=0.02)
    assert wall.normals is not None
    assert wall.normals == pytest.approx(-wall.vertices / np.linalg.norm(wall.vertices, axis=1, keepdims=True), abs=1e-6)
    # L = emission + albedo L has the solution L = 1.
    assert np.array(wall.emission) + np.array(scene.materials[wall.material].diffuse) == pytest.approx(1)
    assert np.linalg.norm(scene.cameras[0].to_world[:3, 3]) < 0.9


def test_the_cube_is_the_one_of_the_known_radiosities() -> None:
    scene = build("cube")
    assert [mesh.name for mesh in scene.meshes] == [f"face {i}" for i in range(6)]
    normals = [cross(corners(mesh))[0] for mesh in scene.meshes]
    centers = [mesh.vertices.mean(axis=0) for mesh in scene.meshes]
    for i, (normal, center) in enumerate(zip(normals, centers, strict=True)):
        assert normal == pytest.approx(-2 * center, abs=1e-6)  # unit area, to the inside
        assert centers[i ^ 1] == pytest.approx(-center, abs=1e-6)
    exitance = [math.pi * mesh.emission[0] for mesh in scene.meshes]
    albedo = [scene.materials[mesh.material].diffuse[0] for mesh in scene.meshes]
    assert exitance == pytest.approx([1, 0, 0, 0, 0, 0])
    assert albedo == pytest.approx([0.5, 0.7, 0.6, 0.3, 0.5, 0.8])
    # With those form factors, the radiosities that the module quotes solve B = E + rho F B.
    factors = np.full((6, 6), 0.2000437761)
    for i in range(6):
        factors[i, i], factors[i, i ^ 1] = 0.0, 0.1998248957
    radiosity = np.linalg.solve(np.eye(6) - np.array(albedo)[:, None] * factors, exitance)
    assert radiosity == pytest.approx([1.11900169, 0.28347386, 0.24743321, 0.13071364, 0.20992539, 0.3185206], abs=1e-7)


def test_a_turned_box_keeps_its_volume_and_faces_outwards() -> None:
    surface = box((1, 2, 3), (0.5, 1, 1.5), turn=30)
    assert volume(surface.vertices[surface.triangles]) == pytest.approx(6)
    assert surface.vertices[:, 0].max() == pytest.approx(1 + 0.5 * math.cos(math.pi / 6) + 1.5 * math.sin(math.pi / 6))


def test_surface_nets_find_a_sphere() -> None:
    def sphere(p: Floats) -> Floats:
        return ball(p, (0.1, -0.2, 0.3), 1.0)

    points, triangles, normals = polygonise(sphere, fisheye((-1.5, -1.5, -1.5), (1.5, 1.5, 1.5), (0, 0, 1), 0.08, 2.0))
    outward = points - (0.1, -0.2, 0.3)
    assert_closed(triangles, euler=2)
    # A filter of half width s makes a sphere of radius R smaller by about s^2/R: here at most 0.27^2 (2 * 0.08)^2.
    assert np.linalg.norm(outward, axis=1) == pytest.approx(1, abs=0.002)
    assert np.einsum("ij,ij->i", outward, normals) == pytest.approx(1, abs=0.002)
    assert volume(points[triangles]) == pytest.approx(4 / 3 * math.pi, rel=0.02)


def test_probing_gives_the_distance_and_the_normal() -> None:
    p = np.array([(1.0, 2.0, 2.0), (0.0, -3.0, 0.0)])
    distance, normal = probe(lambda q: ball(q, (0, 0, 0), 1.0), p, np.full(2, 1e-5))
    assert distance == pytest.approx(2, abs=1e-8)
    assert normal == pytest.approx(p / 3, abs=1e-5)
