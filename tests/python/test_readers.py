"""Loading scenes: what is in them, names, includes, defines, and everything that can be wrong with a scene file."""

from __future__ import annotations

import os
import time
from pathlib import Path

import numpy as np
import pytest

from lumel.errors import SceneError
from lumel.readers import load
from lumel.scene import FovAxis
from reading import Reader

SHAPE = '<shape type="cube"/>'
CAMERA = '<sensor type="perspective" id="eye"/>'


@pytest.fixture
def reader(tmp_path: Path) -> Reader:
    return Reader(tmp_path)


@pytest.mark.parametrize(
    ("name", "shapes", "materials", "cameras", "triangles"),
    [
        ("bust", 10, 8, ["main", "side"], 18028),
        ("cornell_glossy", 9, 8, ["main"], 38),
        ("courtyard", 7, 6, ["main"], 5142),
        ("gallery", 60, 10, ["main"], 133054),
        ("spotlit", 13, 7, ["main"], 25674),
    ],
)
def test_shared_scenes(shared: Path, name: str, shapes: int, materials: int, cameras: list[str], triangles: int) -> None:
    start = time.monotonic()
    scene = load(shared / "scenes" / f"{name}.xml")
    assert time.monotonic() - start < 1.0
    assert (len(scene.meshes), len(scene.materials)) == (shapes, materials)
    assert [camera.name for camera in scene.cameras] == cameras
    assert sum(len(mesh.triangles) for mesh in scene.meshes) == triangles
    assert scene.notes == ()
    assert all(mesh.material in scene.materials for mesh in scene.meshes)
    assert all(mesh.vertices.dtype == np.float32 and mesh.triangles.dtype == np.int32 for mesh in scene.meshes)
    assert set(scene.lines) >= {mesh.name for mesh in scene.meshes} | set(scene.materials) | set(cameras)


def test_a_shared_material_and_lamp(shared: Path) -> None:
    scene = load(shared / "scenes" / "bust.xml")
    floor = scene.materials["floor"]
    np.testing.assert_allclose(floor.diffuse, np.array([0.35, 0.3, 0.25]) * 0.65)
    np.testing.assert_allclose(floor.specular, [0.35] * 3)
    assert (floor.alpha, floor.eta, floor.two_sided) == (0.15, None, True)
    lamp = scene.meshes[-2]
    assert lamp.emission == (16.0, 15.0, 13.0)
    assert scene.lines[lamp.name] == 37
    assert lamp.name == "rectangle@line 37"


def test_names_are_ids_or_places(reader: Reader) -> None:
    scene = reader.scene(
        '<bsdf type="diffuse" id="paint"/>\n<shape type="cube" id="box"><ref id="paint"/></shape>\n'
        '<shape type="cube"/><shape type="cube"/><emitter type="point" id="bulb"/><emitter type="point"/>' + CAMERA
    )
    assert [mesh.name for mesh in scene.meshes] == ["box", "cube@line 4", "cube@line 4 (2)"]
    assert [mesh.material for mesh in scene.meshes] == ["paint", "default", "default"]
    assert [light.name for light in scene.lights] == ["bulb", "point@line 4"]
    assert scene.lines == {"paint": 2, "box": 3, "cube@line 4": 4, "cube@line 4 (2)": 4, "bulb": 4, "point@line 4": 4, "eye": 4}
    assert scene.source == str(reader.folder / "scene.xml")


def test_made_up_names_avoid_ids(reader: Reader) -> None:
    camera = '<sensor type="perspective"/>'
    scene = reader.scene(f'<shape type="cube" id="cube@line 2"/><shape type="cube"/><bsdf type="diffuse" id="default"/>{camera}')
    assert [mesh.name for mesh in scene.meshes] == ["cube@line 2", "cube@line 2 (2)"]
    assert {mesh.material for mesh in scene.meshes} == {"default (2)"}
    scene = reader.scene(SHAPE + '<sensor type="perspective" id="camera2"/>' + camera)
    assert [camera.name for camera in scene.cameras] == ["camera2", "camera2 (2)"]


def test_what_says_how_to_render_is_silent(reader: Reader) -> None:
    scene = reader.scene(
        '<integrator type="path"><integer name="max_depth" value="3"/></integrator><sampler type="independent"/>'
        + SHAPE
        + '<sensor type="perspective"><sampler type="independent"><integer name="sample_count" value="4"/></sampler>'
        '<float name="near_clip" value="0.1"/><film type="hdrfilm"><string name="pixel_format" value="rgb"/><rfilter type="box"/></film>'
        "</sensor>"
    )
    assert scene.notes == ()


def test_another_filter_is_noted(reader: Reader) -> None:
    scene = reader.scene(SHAPE + '<sensor type="perspective"><film type="hdrfilm"><rfilter type="tent"/></film></sensor>')
    (note,) = scene.notes
    assert "rfilter 'tent'" in note
    assert "scene.xml:2" in note


# Half angles of view in x and y, as tangents, computed by Mitsuba 3.9.1 for fov 60 (50 mm without any).
@pytest.mark.parametrize(
    ("properties", "width", "height", "expected"),
    [
        ('<float name="fov" value="60"/>', 400, 300, (0.57735, 0.433013)),
        ('<float name="fov" value="60"/><string name="fov_axis" value="X"/>', 400, 300, (0.57735, 0.433013)),
        ('<float name="fov" value="60"/><string name="fov_axis" value="y"/>', 400, 300, (0.769800, 0.57735)),
        ('<float name="fov" value="60"/><string name="fov_axis" value="diagonal"/>', 400, 300, (0.461880, 0.346410)),
        ('<float name="fov" value="60"/><string name="fov_axis" value="smaller"/>', 300, 400, (0.57735, 0.769800)),
        ('<float name="fov" value="60"/><string name="fov_axis" value="larger"/>', 300, 400, (0.433013, 0.57735)),
        ("", 400, 300, (0.346133, 0.259600)),
        ('<string name="focal_length" value="35mm"/>', 400, 300, (0.494475, 0.370857)),
        ('<string name="focal_length" value="35"/>', 400, 300, (0.494475, 0.370857)),
    ],
)
def test_field_of_view(reader: Reader, properties: str, width: int, height: int, expected: tuple[float, float]) -> None:
    film = f'<film type="hdrfilm"><integer name="width" value="{width}"/><integer name="height" value="{height}"/></film>'
    (camera,) = reader.scene(f'{SHAPE}<sensor type="perspective">{properties}{film}</sensor>').cameras
    assert (camera.width, camera.height) == (width, height)
    np.testing.assert_allclose(camera.tan_half(), expected, atol=2e-6)


def test_camera_defaults_and_place(reader: Reader) -> None:
    look = '<transform name="to_world"><lookat origin="1,2,3" target="1,2,8" up="0,1,0"/></transform>'
    first, second = reader.scene(f'{SHAPE}<sensor type="perspective"/><sensor type="perspective" id="b">{look}</sensor>').cameras
    assert (first.name, first.width, first.height, second.name) == ("camera1", 768, 576, "b")
    np.testing.assert_allclose(second.to_world, [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]], atol=1e-12)


def test_no_camera_gets_one(reader: Reader) -> None:
    scene = reader.scene('<shape type="sphere"><point name="center" value="5 5 5"/></shape>')
    (camera,) = scene.cameras
    axis: FovAxis = "smaller"
    assert (camera.name, camera.fov_axis) == ("default", axis)
    assert any("no camera" in note for note in scene.notes)
    to_camera = np.linalg.inv(camera.to_world)
    points = scene.meshes[0].vertices @ to_camera[:3, :3].T + to_camera[:3, 3]
    tan_x, tan_y = camera.tan_half()
    assert (np.abs(points[:, 0] / points[:, 2]) < tan_x).all()
    assert (np.abs(points[:, 1] / points[:, 2]) < tan_y).all()
    assert np.abs(points[:, 1] / points[:, 2]).max() > 0.5 * tan_y


def test_point_lights(reader: Reader) -> None:
    scene = reader.scene(
        SHAPE
        + '<emitter type="point"><rgb name="intensity" value="1 2 3"/><point name="position" x="1" y="2" z="3"/></emitter>'
        + '<emitter type="point"><transform name="to_world"><translate value="4 5 6"/></transform></emitter>'
        + '<emitter type="point"><spectrum name="intensity" value="2"/></emitter>'
    )
    first, second, third = scene.lights
    assert (first.intensity, first.position) == ((1.0, 2.0, 3.0), (1.0, 2.0, 3.0))
    assert (second.intensity, second.position) == ((1.0, 1.0, 1.0), (4.0, 5.0, 6.0))
    np.testing.assert_allclose(third.intensity, [2.4095879, 1.896582, 1.8178321], rtol=1e-6)  # Mitsuba's numbers


def test_defines(reader: Reader) -> None:
    body = (
        '<default name="r" value="2"/><default name="rr" value="0.5"/><default name="r" value="9"/><default name="both" value="$r$rr"/>'
        '<shape type="sphere" id="a"><float name="radius" value="$r"/></shape>'
        '<shape type="sphere" id="b"><float name="radius" value="$rr"/></shape>'
        '<shape type="sphere" id="c"><float name="radius" value="$both"/></shape>'
    )

    def radii(scene_defines: dict[str, str]) -> list[float]:
        return [float(np.abs(mesh.vertices).max()) for mesh in reader.scene(body, defines=scene_defines).meshes]

    np.testing.assert_allclose(radii({}), [2, 0.5, 20.5], rtol=2e-3)
    np.testing.assert_allclose(radii({"r": "3"}), [3, 0.5, 30.5], rtol=2e-3)


def test_wrong_defines(reader: Reader) -> None:
    uses = '<default name="size" value="1"/><shape type="sphere"><float name="radius" value="$size"/></shape>'
    ((line, message),) = reader.problems(uses, defines={"sise": "2"})
    assert line is None
    assert "sise" in message
    assert "did you mean 'size'" in message
    assert any("sise" in note for note in reader.scene(uses, defines={"sise": "2"}, lenient=True).notes)
    assert "$siz is not defined; did you mean 'size'" in reader.problem(uses.replace("$size", "$siz"))
    assert "$ is not defined" in reader.problem(uses.replace("$size", "${size}"))
    with pytest.raises(SceneError, match=r"only \.xml scenes"):
        load("some.obj", defines={"a": "1"})


def test_include(reader: Reader) -> None:
    (reader.folder / "parts").mkdir()
    reader.write('<default name="r" value="1"/>\n<shape type="sphere" id="$id"><float name="radius" value="$r"/></shape>', "parts/ball.xml")
    (reader.folder / "lone.xml").write_text('<shape version="3.0.0" type="cube"/>')
    scene = reader.scene(
        '<default name="id" value="S"/><default name="r" value="4"/><include filename="parts/ball.xml"/><include filename="lone.xml"/>'
    )
    assert [mesh.name for mesh in scene.meshes] == ["S", f"cube@{reader.folder / 'lone.xml'} line 1"]
    assert np.abs(scene.meshes[0].vertices).max() == pytest.approx(4, rel=2e-3)
    assert scene.lines == {}


def test_problems_in_includes_name_their_file(reader: Reader) -> None:
    reader.write('\n<shape type="teapot"/>', "part.xml")
    with pytest.raises(SceneError) as caught:
        reader.scene(SHAPE + '<include filename="part.xml"/>')
    (problem,) = caught.value.problems
    assert (problem.file, problem.line) == (str(reader.folder / "part.xml"), 3)


def test_include_problems(reader: Reader) -> None:
    reader.write('<include filename="scene.xml"/>', "loop.xml")
    assert "includes itself" in reader.problems(SHAPE + '<include filename="loop.xml"/>')[0][1]
    assert "did you mean" in reader.problem(SHAPE + '<include filename="lop.xml"/>')
    reader.write('<include filename="x2.xml"/><include filename="x2.xml"/>', "x1.xml")
    for i in range(2, 30):
        reader.write(f'<include filename="x{i + 1}.xml"/><include filename="x{i + 1}.xml"/>', f"x{i}.xml")
    reader.write("", "x30.xml")
    assert "files are included" in reader.problems(SHAPE + '<include filename="x1.xml"/>')[0][1]


def test_all_problems_at_once(reader: Reader) -> None:
    problems = reader.problems(
        '<shape type="sphere"><float name="radius" value="-1"/></shape>\n'
        '<shape type="teapot"/>\n'
        '<bsdf type="difuse" id="a"/>\n'
        '<shape type="cube"><ref id="b"/></shape>\n'
        '<shape type="ply"><string name="filename" value="no.ply"/></shape>\n'
        '<medium type="homogeneous"/>\n'
        '<sensor type="perspective"><float name="fovv" value="3"/></sensor>'
    )
    found = dict(problems)
    assert "'radius' is -1" in found[2]
    assert "shape 'teapot' is not supported; allowed: cube, cylinder" in found[3]
    assert "'difuse' is not supported; did you mean 'diffuse'" in found[4]
    assert "there is no bsdf 'b'; did you mean" in found[5] or "allowed: a" in found[5]
    assert "no such file" in found[6]
    assert "medium 'homogeneous'" in found[7]
    assert "'fovv' is not supported; did you mean 'fov'" in found[8]
    assert len(problems) == 7


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ('<shape type="sphere"><float name="radius" value="0"/></shape>', "must be above 0"),
        ('<shape type="sphere"><float name="radius" value="nan"/></shape>', "not a finite number"),
        ('<shape type="sphere"><float name="radius" value="inf"/></shape>', "not a finite number"),
        ('<shape type="sphere"><float name="radius" value="1e400"/></shape>', "out of range"),
        ('<shape type="sphere"><float name="radius" value="1_0"/></shape>', "not a finite number"),
        ('<shape type="sphere"><float name="radius" value="two"/></shape>', "not a finite number"),
        ('<shape type="sphere"><float name="radius"/></shape>', "lacks the attribute 'value'"),
        ('<shape type="sphere"><float value="1"/></shape>', "lacks the attribute 'name'"),
        ('<shape type="sphere"><string name="radius" value="1"/></shape>', "is a <string>; allowed: <float>"),
        ('<shape type="sphere"><float name="radius" value="1"/><float name="radius" value="1"/></shape>', "is set twice"),
        ('<shape type="sphere"><point name="center" x="1"/></shape>', "lacks y, z"),
        ('<shape type="sphere"><point name="center" value="1 2"/></shape>', "needs 3 numbers, not 2"),
        ('<shape type="sphere"><boolean name="face_normals" value="true"/></shape>', "'face_normals' is not supported"),
        ('<shape type="cube"><boolean name="flip_normals" value="yes"/></shape>', "allowed: false, true"),
        ('<shape type="cube"><emitter type="area"><rgb name="radiance" value="1 2"/></emitter></shape>', "1 or 3 numbers, not 2"),
        ('<shape type="cube"><emitter type="area"><rgb name="radiance" value="-1"/></emitter></shape>', "allowed: at least 0"),
        ('<shape type="cube"><emitter type="area"><rgb name="radiance" value="#12345"/></emitter></shape>', "is not a colour"),
        ('<shape type="cube"><emitter type="area"><spectrum name="radiance" value="400:1 700:1"/></emitter></shape>', "wavelength"),
        ('<shape type="cube"><emitter type="area"><texture name="radiance" type="bitmap"/></emitter></shape>', "texture 'bitmap'"),
        ('<shape type="cube"><emitter type="spot"/></shape>', "emitter 'spot' is not supported; allowed: area"),
        ('<shape type="cube"><emitter type="area"/><emitter type="area"/></shape>', "more than one emitter"),
        ('<shape type="cube"><transform name="to_world"><scale value="1 0 1"/></transform></shape>', "singular"),
        ('<shape type="sphere"><point name="center" value="1e30 0 0"/></shape>', "beyond 1e+30 m"),
        ('<shape type="cube"><transform name="to_world"><rotate x="1"/></transform></shape>', "lacks the attribute 'angle'"),
        ('<shape type="cube"><transform name="to_world"><rotate angle="3"/></transform></shape>', "axis of length 0"),
        ('<shape type="cube"><transform name="to_world"><spin angle="3"/></transform></shape>', "<spin> in a transform"),
        ('<shape type="cube"><transform name="to_world"><matrix value="1 2 3"/></transform></shape>', "9 or 16 numbers, not 3"),
        (
            '<shape type="cube"><transform name="to_world"><lookat origin="0 0 0" target="0 1 0" up="0 1 0"/></transform></shape>',
            "look_at needs",
        ),
        (
            '<shape type="cube"><transform name="to_world"><scale value="1e25"/><scale value="1e25"/></transform></shape>',
            "goes beyond 1e30",
        ),
        (
            '<shape type="cube"><transform name="to_world"><translate x="1e30"/><translate x="1e30"/></transform></shape>',
            "goes beyond 1e30",
        ),
        ('<shape type="cylinder"><point name="p1" value="0 0 0"/></shape>', "are the same point"),
        ('<shape type="cube" colour="red"/>', "attribute 'colour' is not supported"),
        ("<shape/>" + SHAPE, "<shape> lacks the attribute 'type'"),
        (SHAPE + "words", "text 'words' inside <scene>"),
        (SHAPE + '<emitter type="constant"/>', "emitter 'constant' is not supported"),
        (SHAPE + '<sensor type="thinlens"/>', "sensor 'thinlens' is not supported"),
        (SHAPE + '<sensor type="perspective"><float name="fov" value="180"/></sensor>', "below 180 degrees"),
        (
            SHAPE + '<sensor type="perspective"><float name="fov" value="9"/><string name="fov_axis" value="w"/></sensor>',
            "allowed: diagonal",
        ),
        (SHAPE + '<sensor type="perspective"><string name="focal_length" value="0mm"/></sensor>', "must be above 0"),
        (SHAPE + '<sensor type="perspective"><float name="principal_point_offset_x" value="0.1"/></sensor>', "principal_point_offset_x"),
        (SHAPE + '<sensor type="perspective"><transform name="to_world"><scale value="2"/></transform></sensor>', "scales or shears"),
        (SHAPE + '<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="0"/></film></sensor>', "1 to 32768"),
        (SHAPE + '<sensor type="perspective"><film type="hdrfilm"><integer name="width" value="1.5"/></film></sensor>', "whole number"),
        (SHAPE + '<sensor type="perspective"><film type="hdrfilm"><integer name="crop_width" value="9"/></film></sensor>', "crop_width"),
        (SHAPE + '<float name="loose" value="1"/>', "<float> is not supported"),
        ('<shape type="cube" id="a"/><shape type="cube" id="a"/>', "the id 'a' is used twice"),
        ('<shape type="cube" id="a"><ref id="a"/></shape>', "'a' is a shape, not a bsdf"),
        ('<integrator type="path"/>', "the scene is empty"),
    ],
)
def test_each_problem_has_its_line(reader: Reader, body: str, message: str) -> None:
    problems = reader.problems(body)
    assert any(message in text for _, text in problems), problems
    assert {line for line, _ in problems} == ({1} if "empty" in message else {2})


def test_lenient_goes_on_without(reader: Reader) -> None:
    body = SHAPE + '<shape type="teapot"/><emitter type="envmap"/><shape type="cube"><bsdf type="dielectric"/></shape>'
    scene = reader.scene(body, lenient=True)
    assert len(scene.meshes) == 2
    ignored = [note for note in scene.notes if note.startswith("ignored: ")]
    assert [any(name in note for note in ignored) for name in ("teapot", "envmap", "dielectric")] == [True] * 3
    assert all("scene.xml:2" in note for note in ignored)
    assert "finite" in reader.problem(SHAPE + '<shape type="sphere"><float name="radius" value="nan"/></shape>', lenient=True)
    assert "empty" in reader.problems('<shape type="teapot"/>', lenient=True)[0][1]


@pytest.mark.parametrize(
    ("text", "line", "message"),
    [
        ("", 1, "not well-formed"),
        ("hello", 1, "not well-formed"),
        ('<scene version="3.0.0">\n<shape type="cube">\n</scene>', 3, "column"),
        ('<scene version="3.0.0">\n<shape type=cube/>\n</scene>', 2, "column"),
        ('<shape version="3.0.0" type="cube"/>', 1, "outermost element is <shape>"),
        ('<scene version="0.6.0"><shape type="cube"/></scene>', 1, "version '0.6.0'"),
        ('<!DOCTYPE scene [<!ENTITY a "b">]>\n<scene version="3.0.0"><shape type="cube" id="&a;"/></scene>', 1, "DOCTYPE"),
        ("<scene>" * 100 + "</scene>" * 100, 1, "nested more than"),
    ],
)
def test_broken_files(tmp_path: Path, text: str, line: int, message: str) -> None:
    path = tmp_path / "broken.xml"
    path.write_text(text)
    with pytest.raises(SceneError) as caught:
        load(path)
    (problem,) = caught.value.problems
    assert (problem.file, problem.line) == (str(path), line)
    assert message in problem.message


def test_bombs_are_refused_at_once(tmp_path: Path) -> None:
    entities = "".join(f'<!ENTITY e{i} "{f"&e{i - 1};" * 10}">' for i in range(1, 12))
    names = "".join(f'<default name="d{i}" value="{f"$d{i - 1}" * 10}"/>' for i in range(1, 12))
    bombs = [
        f'<!DOCTYPE s [<!ENTITY e0 "boom">{entities}]><scene id="&e11;"/>',
        f'<!DOCTYPE s [<!ENTITY e0 "boom">{entities}]><scene>&e11;</scene>',
        '<!DOCTYPE s [<!ENTITY x SYSTEM "file:///etc/hostname">]><scene>&x;</scene>',
        f'<scene><default name="d0" value="boom"/>{names}</scene>',
    ]
    start = time.monotonic()
    for bomb in bombs:
        (tmp_path / "bomb.xml").write_text(bomb)
        with pytest.raises(SceneError):
            load(tmp_path / "bomb.xml")
    assert time.monotonic() - start < 2


def test_what_cannot_be_opened(tmp_path: Path) -> None:
    (tmp_path / "bust.xml").write_text("<scene/>")
    (tmp_path / "scene.blend").write_text("")
    (tmp_path / "folder.xml").mkdir()
    os.mkfifo(tmp_path / "pipe.xml")
    for name, message in [
        ("bsut.xml", "did you mean '.*bust.xml'"),
        ("folder.xml", "it is a directory"),
        ("none/scene.xml", "there is no directory '.*none'"),
        ("scene.blend", "unknown ending '.blend'; .*allowed: .obj, .ply, .stl, .xml"),
        ("missing.blend", "no such file"),
        ("pipe.xml", "not a regular file"),
        ("n" * 300 + ".xml", "too long"),
        ("null\0.xml", "cannot read"),
    ]:
        with pytest.raises(SceneError, match=message):
            load(tmp_path / name)


def test_a_file_without_permission(tmp_path: Path) -> None:
    path = tmp_path / "secret.xml"
    path.write_text("<scene/>")
    path.chmod(0)
    if os.access(path, os.R_OK):
        pytest.skip("this user may read everything")
    with pytest.raises(SceneError, match="Permission denied"):
        load(path)
