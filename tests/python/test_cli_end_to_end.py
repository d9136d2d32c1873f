"""The true command line on true scenes: flags together, bare meshes, names in many scripts, and Ctrl-C."""

from __future__ import annotations

import json
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest

from lumel.images import read_picture
from running import BALL, LIMIT, ROOM, SMALL, camera, environment, floor, lamp, run, scene

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n"
FACES = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))


@pytest.fixture
def room(tmp_path: Path) -> Path:
    """A folder with `room.xml`."""
    (tmp_path / "room.xml").write_text(ROOM)
    return tmp_path


@pytest.mark.parametrize(
    "flags",
    [
        "--defensive 0",
        "--defensive 1 --estimator classical",
        "--no-first-shot --transport walk --estimator classical",
        "--no-first-shot --transport rays --estimator weighted --half",
        "--transport walk --threads 1 --layers direct,albedo",
        "--threads 8 --layers rgb --exposure -3",
        "--patches 1 --seed 18446744073709551615",
        "--patches 1e5 --progress plain",
        "--rays 1 --progress bar --lenient",
    ],
)
def test_flags_together(room: Path, flags: str) -> None:
    # Of a flag that is given twice the last one holds.
    ran = run("render", "room.xml", *SMALL, *flags.split(), "-o", "a.exr", "-o", "a.png", cwd=room)
    assert ran.code == 0, ran
    assert ran.out.splitlines()[-2:] == ["wrote a.exr", "wrote a.png"]
    picture = read_picture(room / "a.exr")
    assert picture.layers["rgb"].shape == (12, 16, 3)
    assert all(np.isfinite(values).all() for values in picture.layers.values())
    assert picture.layers["rgb"].mean() > 0.01
    assert read_picture(room / "a.png").layers["rgb"].max() > 0
    if "--layers direct" in flags:
        assert set(picture.layers) == {"rgb", "direct", "albedo"}
    if "--layers rgb" in flags:
        assert set(picture.layers) == {"rgb"}


@pytest.mark.parametrize(("flags", "least", "most"), [("--error 0.3", 0, 15), ("--time 1", 0.8, 2.5)])
def test_budgets_end_by_themselves(room: Path, flags: str, least: float, most: float) -> None:
    ran = run("render", "room.xml", "--size", "32x24", *flags.split(), "--progress", "json", "-o", "a.exr", cwd=room)
    assert ran.code == 0, ran
    assert ran.out == ""
    stats = json.loads(ran.err.splitlines()[-1])["stats"]
    assert least <= stats["time"] <= most
    assert stats["rays"] > 0
    if "error" in flags:
        assert 0 < stats["error"] <= 0.3


def test_json_progress_goes_forward(room: Path) -> None:
    ran = run("render", "room.xml", *SMALL, "--progress", "json", "-o", "a.exr", cwd=room)
    *events, done = [json.loads(line) for line in ran.err.splitlines()]
    assert done["phase"] == "done"
    assert done["files"] == ["a.exr"]
    for key in ("fraction", "rays", "elapsed"):
        values = [event[key] for event in events]
        assert values == sorted(values), key
    assert all(0 <= event["fraction"] <= 1 for event in events)


def test_all_cameras_at_another_size_and_names_in_other_scripts(tmp_path: Path) -> None:
    (tmp_path / "scène ☃.xml").write_text(scene(floor(), BALL, lamp(), camera("hinten ü"), camera("日本", origin="1,1,3")))
    ran = run("render", "scène ☃.xml", *SMALL, "--camera", "all", "--size", "9x7", "-o", "bïld.exr", "-o", "bïld.png", cwd=tmp_path)
    assert ran.code == 0, ran
    names = {f"bïld.{view}.{ending}" for view in ("hinten_ü", "日本") for ending in ("exr", "png")}
    assert {path.name for path in tmp_path.iterdir()} == {"scène ☃.xml", *names}
    pictures = [read_picture(tmp_path / name).layers["rgb"] for name in sorted(names) if name.endswith("exr")]
    assert all(picture.shape == (7, 9, 3) for picture in pictures)
    assert not np.allclose(pictures[0], pictures[1])
    assert run("render", "scène ☃.xml", *SMALL, "--camera", "日本", "-o", "one.exr", cwd=tmp_path).code == 0


def test_cameras_too_alike_for_files_are_found_before_the_render(tmp_path: Path) -> None:
    (tmp_path / "s.xml").write_text(scene(floor(), lamp(), camera("a/b"), camera("a_b")))
    begin = time.monotonic()
    ran = run("render", "s.xml", "--rays", "1e9", "--camera", "all", "-o", "a.exr", cwd=tmp_path)
    assert ran.code == 3
    assert "too alike" in ran.err
    assert time.monotonic() - begin < LIMIT / 2
    assert len(list(tmp_path.iterdir())) == 1


def test_names_are_defined_from_outside(tmp_path: Path) -> None:
    (tmp_path / "s.xml").write_text(scene('<default name="albedo" value="0.1"/>', floor("$albedo"), lamp(), camera()))
    means = []
    for flags in ([], ["-D", "albedo=0.8"]):
        assert run("render", "s.xml", *SMALL, *flags, "-o", "a.exr", cwd=tmp_path).code == 0
        means.append(read_picture(tmp_path / "a.exr").layers["direct"].mean())
    assert means[1] / means[0] == pytest.approx(8, rel=0.02)


def test_meshes_beside_the_scene_are_found_from_anywhere(tmp_path: Path) -> None:
    folder, elsewhere = tmp_path / "scenes", tmp_path / "elsewhere"
    folder.mkdir()
    elsewhere.mkdir()
    (folder / "thing.obj").write_text(OBJ)
    (folder / "s.xml").write_text(scene('<shape type="obj"><string name="filename" value="thing.obj"/></shape>', lamp(), camera()))
    ran = run("render", "../scenes/s.xml", *SMALL, "-o", "a.exr", cwd=elsewhere)
    assert ran.code == 0, ran
    assert [path.name for path in elsewhere.iterdir()] == ["a.exr"]


def write_ply(path: Path) -> None:
    """A binary tetrahedron."""
    header = "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    header += "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4").tobytes()
    faces = b"".join(struct.pack("<Biii", 3, *face) for face in FACES)
    path.write_bytes(header.encode() + vertices + faces)


def write_stl(path: Path) -> None:
    """The same as STL."""
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], "<f4")
    records = [
        np.zeros(3, "<f4").tobytes() + corners[list(face)].tobytes() + b"\0\0" for face in ((0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3))
    ]
    path.write_bytes(bytes(80) + struct.pack("<I", len(records)) + b"".join(records))


@pytest.mark.parametrize("ending", ["obj", "ply", "stl"])
def test_bare_meshes_get_light_and_a_camera(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"thing.{ending}"
    {"obj": lambda path: path.write_text(OBJ), "ply": write_ply, "stl": write_stl}[ending](path)
    ran = run("render", path, *SMALL, "-o", "a.exr", cwd=tmp_path)
    assert ran.code == 0, ran
    assert "is a mesh alone: a lamp, a grey floor and a camera are put around it" in ran.out
    assert read_picture(tmp_path / "a.exr").layers["rgb"].min(axis=2).max() > 0.05
    assert run("info", path, "--json", cwd=tmp_path).code == 0


Begin = Callable[..., "subprocess.Popen[str]"]


@pytest.fixture
def begin() -> Iterator[Begin]:
    """Start a command; returns at once, or when its progress says `until`. What still runs after the test is killed."""
    with ExitStack() as stack:

        def start(folder: Path, *args: str, until: str = "") -> subprocess.Popen[str]:
            line = [sys.executable, "-m", "lumel", *args]
            pipe = subprocess.PIPE
            process = stack.enter_context(subprocess.Popen(line, cwd=folder, stdout=pipe, stderr=pipe, text=True, env=environment()))
            stack.callback(process.kill)
            assert process.stderr
            if until and not any(until in said for said in process.stderr):
                raise AssertionError(f"the command never said '{until}'")
            return process

        yield start


LONG = {
    "shoot": ("--rays", "1e9", "--size", "16x12"),
    "eye": ("--rays", "1000", "--quality", "high", "--size", "1200x900"),
}


@pytest.mark.parametrize("phase", list(LONG))
def test_first_ctrl_c_ends_with_a_valid_picture(room: Path, begin: Begin, phase: str) -> None:
    process = begin(room, "render", "room.xml", *LONG[phase], "--progress", "json", "-o", "a.exr", until=f'"phase": "{phase}"')
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=LIMIT)
    assert process.returncode == 0
    assert "finishing the picture" in err
    done = json.loads(err.splitlines()[-1])
    assert done["stats"]["interrupted"] is True
    assert done["stats"]["rays"] > 0
    picture = read_picture(room / "a.exr")
    assert all(np.isfinite(values).all() for values in picture.layers.values())
    assert picture.layers["rgb"].mean() > 0.01


@pytest.mark.parametrize("phase", list(LONG))
def test_second_ctrl_c_stops_at_once(room: Path, begin: Begin, phase: str) -> None:
    (room / "a.exr").write_bytes(b"old")
    process = begin(room, "render", "room.xml", *LONG[phase], "--progress", "json", "-o", "a.exr", until=f'"phase": "{phase}"')
    process.send_signal(signal.SIGINT)
    process.send_signal(signal.SIGINT)
    first = time.monotonic()
    # Two signals that arrive as one are one: ask again until it ends.
    while process.poll() is None and time.monotonic() - first < 1:
        time.sleep(0.02)
        if process.poll() is None:
            process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=LIMIT)
    assert process.returncode == 130
    assert "nothing more was written" in err
    assert out == ""
    assert {path.name for path in room.iterdir()} == {"room.xml", "a.exr"}
    assert (room / "a.exr").read_bytes() == b"old"


def test_ctrl_c_during_tessellation(room: Path, begin: Begin) -> None:
    """One that comes before the first ray still ends with a picture."""
    process = begin(room, "render", "room.xml", "--patches", "1.5M", "--size", "16x12", "--rays", "1e9", "-o", "a.exr")
    time.sleep(0.9)  # imports are done, tables and patches are being made
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=3 * LIMIT)
    assert "Traceback" not in err
    if process.returncode == 130:  # the machine was busy: it was still reading
        assert not (room / "a.exr").exists()
    else:
        assert process.returncode == 0
        assert np.isfinite(read_picture(room / "a.exr").layers["rgb"]).all()


def test_ctrl_c_in_the_demo_leaves_nothing_half_done(tmp_path: Path, begin: Begin) -> None:
    process = begin(tmp_path, "demo", "-o", "out", until="shooting")
    process.send_signal(signal.SIGINT)
    _, err = process.communicate(timeout=2 * LIMIT)
    assert process.returncode in (0, 130)
    assert "Traceback" not in err
    written = {path.name for path in (tmp_path / "out").iterdir()}
    assert written in (set(), {"classical.png", "weighted.png", "side_by_side.png"})


def test_bench_refuses_all_bad_settings_at_once(tmp_path: Path) -> None:
    ran = run("bench", "--cameras", "0", "--patches", "none", "--threads", "-1", cwd=tmp_path)
    assert ran.code == 2, ran
    assert all(text in ran.err for text in ("--cameras must be 1 to 1024, found 0", "--patches", "threads is -1"))
