"""Bad input through the true command line: what it says, its exit code, and that nothing is written or harmed."""

from __future__ import annotations

import os
import resource
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from lumel.cli import app
from lumel.images import read_picture
from lumel.scene import FloatArray
from running import BALL, ROOM, SMALL, Ran, camera, floor, lamp, run, scene

OLD = b"the picture of yesterday"
PLY = """ply
format ascii 1.0
element vertex 3
property float x
property float y
property float z
element face 1
property list uchar int vertex_indices
end_header
0 0 0
{x} 0 0
0 1 0
3 0 1 {last}
"""
FLAT_LAMP = """<shape type="rectangle" id="flat"><transform name="to_world"><scale x="0"/></transform>
  <emitter type="area"><rgb name="radiance" value="5"/></emitter></shape>"""
WALL = '<shape type="cube"><transform name="to_world"><scale value="0.1"/><translate y="0.5" z="4"/></transform></shape>'


def mesh(kind: str, name: str) -> str:
    """A shape from a file."""
    return f'<shape type="{kind}"><string name="filename" value="{name}"/></shape>'


def files(folder: Path) -> None:
    """Scenes with one fault each, good ones, and a picture that must survive."""
    texts = {
        "room.xml": ROOM,
        "broken.xml": '<scene version="3.0.0">\n<shape type="cube">\n</scene>',
        "nothing.xml": "",
        "plugin.xml": scene(lamp(), '<shape type="torus"/>', '<bsdf type="hair" id="x"/>', camera()),
        "meshes.xml": scene(mesh("ply", "gone.ply"), mesh("ply", "nan.ply"), mesh("ply", "index.ply"), mesh("obj", "index.obj")),
        "empty.xml": scene(camera()),
        "flat.xml": scene(floor(), FLAT_LAMP, camera()),
        "negative.xml": scene(floor("-0.5"), lamp(), camera()),
        "over.xml": scene(floor("0.5,1.5,0.5"), floor("7").replace("floor", "roof"), lamp(), camera()),
        "dark_lamp.xml": scene(floor(), lamp("-5"), camera()),
        "no_film.xml": scene(floor(), lamp(), camera(width=0)),
        "nan.ply": PLY.format(x="nan", last=2),
        "index.ply": PLY.format(x=1, last=7),
        "index.obj": "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n",
        "cut.ply": "ply\nformat ascii 1.0\nelement vertex 3\nprop",
        "scene.txt": "",
    }
    for name, text in texts.items():
        (folder / name).write_text(text)
    (folder / "out.exr").write_bytes(OLD)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with all `files`."""
    folder = tmp_path_factory.mktemp("bad")
    files(folder)
    return folder


Refused = Callable[..., Ran]


@pytest.fixture
def refused(folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refused:
    """Run a render that must fail before any work, without a trace of a picture; gives what it said."""
    monkeypatch.chdir(folder)

    def refuse(*args: str, output: str = "out.exr") -> Ran:
        before = {path.name: path.read_bytes() for path in folder.iterdir()}
        with pytest.raises(SystemExit) as caught:
            app(["render", *args, "-o", output], prog_name="lumel")
        ran = Ran(int(caught.value.code or 0), *capsys.readouterr())
        assert ran.out == ""
        assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
        return ran

    return refuse


@pytest.mark.parametrize(
    ("file", "said"),
    [
        ("gone.xml", ["cannot read 'gone.xml': no such file"]),
        (".", ["'.': it is a directory"]),
        ("scene.txt", ["unknown ending '.txt'", ".obj, .ply, .stl, .xml"]),
        ("broken.xml", ["broken.xml:3: not well-formed XML", "shape line 2"]),
        ("nothing.xml", ["nothing.xml:1: not well-formed XML"]),
        ("plugin.xml", ["plugin.xml:4: shape 'torus' is not supported; allowed: cube", "plugin.xml:5: material 'x': bsdf 'hair'"]),
        ("meshes.xml", ["meshes.xml:2: shape ply: cannot read 'gone.ply': no such file", "meshes.xml:3: ", "1 of 3 vertices are NaN",
                        "meshes.xml:4: ", "[0, 1, 7]", "index.obj:4: there is no vertex 9"]),
        ("empty.xml", ["empty.xml:1: the scene is empty"]),
        ("flat.xml", ["flat.xml:4: shape 'flat'", "singular"]),
        ("negative.xml", ["negative.xml:3: ", "'reflectance' is -0.5, allowed: 0 to 1"]),
        ("over.xml", ["over.xml:3: ", "over.xml:5: ", "'reflectance' is 0.5,1.5,0.5, allowed: 0 to 1", "is 7, allowed: 0 to 1"]),
        ("dark_lamp.xml", ["dark_lamp.xml:5: area emitter", "'radiance' is -5, allowed: at least 0"]),
        ("no_film.xml", ["no_film.xml:8: film of sensor 'main': 'width' is 0, allowed: 1 to 32768"]),
        ("nan.ply", ["'nan.ply': 1 of 3 vertices are NaN"]),
        ("index.ply", ["'index.ply': 1 of 1 triangles have an index outside 0..2"]),
        ("index.obj", ["index.obj:4: there is no vertex 9, only 3"]),
        ("cut.ply", ["cannot read 'cut.ply' as PLY: its header has no end"]),
        ("lumel:bust", ["no built-in scene 'bust'", "cornell, cube, demo, furnace"]),
    ],
)  # fmt: skip
def test_bad_scenes_are_refused_with_their_place(refused: Refused, file: str, said: list[str]) -> None:
    ran = refused(file, *SMALL)
    assert ran.code == 1
    for part in said:
        assert part in ran.err


@pytest.mark.parametrize(
    ("flags", "said"),
    [
        ("--size 0x0", ["--size must be WIDTHxHEIGHT in pixels, each 1 to 32768", "'0x0'"]),
        ("--size 32768x32768", ["would take about", "this machine has"]),
        ("--rays -5", ["--rays must be a whole number of at least 1", "'-5'"]),
        ("--rays 1e14", ["rays is 100000000000000; allowed: 1 to 10^13"]),
        ("--defensive 1.5", ["defensive is 1.5; allowed: 0 to 1"]),
        ("--defensive nan", ["defensive is nan; allowed: 0 to 1"]),
        ("--threads 2000", ["threads is 2000; allowed: 0 (all) to 1024"]),
        ("--threads -1", ["threads is -1; allowed: 0"]),
        ("--seed -1", ["seed is -1; allowed: 0 to 2^64 - 1"]),
        ("--seed 99999999999999999999", ["seed is 99999999999999999999; allowed"]),
        ("--time nan", ["time is nan; allowed: more than 0 and at most 1e+08 seconds"]),
        ("--time inf", ["time is inf; allowed"]),
        ("--error 0", ["error is 0; allowed: a finite number, more than 0"]),
        ("--time 3 --error 1", ["--time and --error exclude each other"]),
        ("--patches 1e12", ["patches is 1000000000000; allowed: 1 to 2^30"]),
        ("--exposure nan", ["--exposure must be -100 to 100 EV"]),
        ("--camera back", ["unknown camera 'back'; allowed: all, main"]),
        ("--layers direkt", ["unknown layer 'direkt'; did you mean 'direct'?"]),
        ("--transport bundels", ["unknown transport 'bundels'; did you mean 'bundles'?"]),
        ("--estimator weigthed", ["unknown estimator 'weigthed'; did you mean 'weighted'? allowed: auto, classical"]),
        ("--areas lumels", ["unknown areas 'lumels'", "allowed: patches, pixels"]),
        ("--quality best", ["unknown quality 'best'; allowed: draft, high, medium"]),
        ("--progress fancy", ["unknown value 'fancy'; allowed: bar, json, plain"]),
        ("-D name", ["-D must be name=value, found 'name'"]),
    ],
)  # fmt: skip
def test_bad_flags_are_refused(refused: Refused, flags: str, said: list[str]) -> None:
    ran = refused("room.xml", *flags.split())
    assert ran.code == 2
    for part in said:
        assert part in ran.err


def test_bad_flags_settings_and_outputs_are_named_together(refused: Refused) -> None:
    flags = "--rays many --transport wlk --seed -1 --defensive 2 --layers direkt --time -3 --threads 9999 --size 1x -D x"
    ran = refused("room.xml", *flags.split(), output="out.gif")
    assert ran.code == 2
    said = (
        "'many'",
        "'wlk'",
        "seed is -1",
        "defensive is 2",
        "'direkt'",
        "--rays and --time",
        "threads is 9999",
        "'1x'",
        "'x'",
        ".gif",
    )
    for part in said:
        assert part in ran.err
    assert len(ran.err.splitlines()) == len(said)


def test_unknown_names_to_define(refused: Refused) -> None:
    ran = refused("room.xml", "-D", "albedo=0.5")
    assert ran.code == 1
    assert "albedo" in ran.err


@pytest.mark.parametrize("output", ["missing/a.exr", "room.xml/a.exr", "a.jpg", "/dev/full", "/proc/a.exr", "x" * 300 + ".exr"])
def test_outputs_that_cannot_be_written(refused: Refused, output: str) -> None:
    ran = refused("room.xml", output=output)
    assert ran.code == 3
    assert f"cannot write '{output}'" in ran.err


def test_the_same_output_twice(refused: Refused) -> None:
    ran = refused("room.xml", "-o", "a.exr", output="./a.exr")
    assert ran.code == 3
    assert "cannot write 'a.exr' twice" in ran.err


@pytest.mark.skipif(os.geteuid() == 0, reason="this user may write everywhere")
def test_protected_outputs(folder: Path, refused: Refused) -> None:
    (folder / "locked.exr").write_bytes(OLD)
    (folder / "locked.exr").chmod(0o400)
    ran = refused("room.xml", output="locked.exr")
    assert ran.code == 3
    assert "write-protected" in ran.err


def test_full_disk_keeps_the_old_picture(folder: Path) -> None:
    def full() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (500, 500))

    before = sorted(path.name for path in folder.iterdir())
    ran = run("render", "room.xml", *SMALL, "-o", "out.exr", "-o", "out.png", cwd=folder, before=full)
    assert ran.code == 3
    assert "cannot write 'out.exr'" in ran.err
    assert "what was there before is unchanged" in ran.err
    assert (folder / "out.exr").read_bytes() == OLD
    assert sorted(path.name for path in folder.iterdir()) == before


def accepted(folder: Path, text: str, *args: str) -> tuple[str, FloatArray]:
    """Render `text`; gives what was said and the picture."""
    (folder / "s.xml").write_text(text)
    ran = run("render", "s.xml", *SMALL, *args, "-o", "s.exr", cwd=folder)
    assert ran.code == 0, ran
    rgb = read_picture(folder / "s.exr").layers["rgb"]
    assert np.isfinite(rgb).all()
    return ran.out, rgb


@pytest.mark.parametrize("transport", ["rays", "walk"])
@pytest.mark.parametrize("parts", [(floor(), BALL), (floor(), lamp("0"))], ids=["no lamp", "a lamp of radiance 0"])
def test_no_light_renders_black_and_says_so(tmp_path: Path, parts: tuple[str, ...], transport: str) -> None:
    said, rgb = accepted(tmp_path, scene(*parts, camera()), "--transport", transport)
    assert "note: the scene has no light: the picture is black" in said
    assert not rgb.any()


def test_a_lamp_alone_is_seen(tmp_path: Path) -> None:
    _, rgb = accepted(tmp_path, scene(lamp(), camera(origin="0,-2,3")))
    assert rgb.max() == pytest.approx(5, rel=1e-3)


def test_no_camera_is_framed_and_says_so(tmp_path: Path) -> None:
    said, rgb = accepted(tmp_path, scene(floor(), BALL, lamp()))
    assert "no camera" in said
    assert rgb.any()


def test_camera_inside_a_wall_says_so(tmp_path: Path) -> None:
    said, rgb = accepted(tmp_path, scene(WALL, floor(), lamp(), camera()))
    assert "camera 'main' sees no light at all: it may be inside a wall" in said
    assert not rgb.any()


def test_lenient_goes_on_without_the_unknown_and_says_so(tmp_path: Path) -> None:
    said, rgb = accepted(tmp_path, scene(floor(), '<shape type="torus"/>', lamp(), camera()), "--lenient")
    assert "torus" in said
    assert rgb.any()


def test_names_used_twice_are_refused_with_both_lines(tmp_path: Path) -> None:
    for text, name in ((scene(floor(), lamp(), camera(), camera()), "main"), (scene(floor(), floor(), lamp(), camera()), "floor")):
        (tmp_path / "s.xml").write_text(text)
        ran = run("render", "s.xml", *SMALL, "-o", "s.exr", cwd=tmp_path)
        assert ran.code == 1
        assert f"the id '{name}' is used twice, first in s.xml:" in ran.err
        assert not (tmp_path / "s.exr").exists()


@pytest.mark.parametrize("command", ["render", "info"])
def test_meshes_that_no_ray_could_meet_say_why(tmp_path: Path, command: str) -> None:
    (tmp_path / "flat.xml").write_text(scene(mesh("obj", "line.obj"), mesh("obj", "huge.obj"), camera()))
    (tmp_path / "line.obj").write_text("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n")
    (tmp_path / "huge.obj").write_text("v 0 0 0\nv 1e20 0 0\nv 0 1e20 0\nf 1 2 3\n")
    output = ["-o", "a.exr"] if command == "render" else []
    ran = run(command, "flat.xml", *output, cwd=tmp_path)
    assert ran.code == 1
    assert "flat.xml: the scene has no usable triangle: 2 triangles in 2 meshes were given, 1e+20 m in size" in ran.err
