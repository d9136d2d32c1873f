"""The command line as scripts see it: flags, files, exit codes, JSON."""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Callable
from importlib import metadata
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from cli_core import FakeCore
from lumel.cli import app, progress, text, values
from lumel.errors import Problem, SceneError, SettingsError
from lumel.images import read_picture
from lumel.images.exr import write_exr
from lumel.images.png import write_png
from lumel.progress import Progress
from lumel.result import LAYERS

Lumel = Callable[..., tuple[int, str, str]]


def words(text: str) -> set[str]:
    """The words of a text."""
    return set(text.split())


@pytest.fixture
def core(monkeypatch: pytest.MonkeyPatch) -> FakeCore:
    """A renderer that records what it is asked for, in place of the true one."""
    fake = FakeCore()
    for name, functions in {"lumel.render": ("render", "describe"), "lumel.readers": ("load",)}.items():
        module = ModuleType(name)
        for function in functions:
            setattr(module, function, getattr(fake, function))
        monkeypatch.setitem(sys.modules, name, module)
    return fake


@pytest.fixture
def lumel(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Lumel:
    """Run the command line in this process: gives exit code, stdout and stderr."""

    def run(*args: object) -> tuple[int, str, str]:
        line = [str(arg) for arg in args]
        monkeypatch.setattr(sys, "argv", ["lumel", *line])
        with pytest.raises(SystemExit) as caught:
            app(line, prog_name="lumel")
        out, err = capsys.readouterr()
        return int(caught.value.code or 0), out, err

    return run


def test_help_of_render_names_every_flag_of_the_contract(lumel: Lumel) -> None:
    code, out, _ = lumel("render", "--help")
    assert code == 0
    contract = """--transport walk|rays --areas patches --estimator classical|weighted --defensive SHARE --first-shot --no-first-shot
        --rays N --time SECONDS --error E --patches N --quality draft|medium|high --camera NAME|all --size WxH --layers LIST|all
        --exposure EV --seed N --threads N -D name=value --lenient --quiet --progress bar|plain|json --output -o"""
    for word in contract.split():
        assert word in out


@pytest.mark.parametrize(("command", "flags"), [("info", "--json"), ("compare", "--json -o DIFF.png"), ("demo", "-o DIR")])
def test_help_of_the_others(lumel: Lumel, command: str, flags: str) -> None:
    code, out, _ = lumel(command, "--help")
    assert code == 0
    assert all(word in out for word in flags.split())


def test_bare_render_leaves_every_default_to_the_renderer(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    code, out, err = lumel("render", "scene.xml", "-o", tmp_path / "a.exr")
    assert code == 0, err
    assert set(core.settings) == {"started", "progress", "interrupted"}
    assert core.loaded == ("scene.xml", {}, False)
    assert f"wrote {tmp_path / 'a.exr'}" in out
    assert "1 k rays" in out
    assert "note: a note" in out
    picture = read_picture(tmp_path / "a.exr")
    assert set(picture.layers) == {"rgb", *LAYERS}
    assert picture.metadata["command"] == f"lumel render scene.xml -o {tmp_path / 'a.exr'}"


def test_flags_become_settings(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    flags = """--transport walk --areas patches --estimator classical --defensive 0.25 --no-first-shot --rays 2.5M --patches 20k
        --quality high --camera right --size 320x200 --layers depth,direct --seed 7 --threads 2 -D a=1 -D b=x=y --lenient
        --progress plain --exposure -1.5"""
    code, _, err = lumel("render", "scene.xml", "-o", tmp_path / "a.exr", *flags.split())
    assert code == 0, err
    given = {name: value for name, value in core.settings.items() if name not in {"started", "progress", "interrupted"}}
    assert given == {
        "transport": "walk", "areas": "patches", "estimator": "classical", "defensive": 0.25, "first_shot": False, "rays": 2_500_000,
        "patches": 20_000, "quality": "high", "camera": "right", "size": (320, 200), "layers": ("depth", "direct"), "seed": 7, "threads": 2,
    }  # fmt: skip
    assert core.loaded == ("scene.xml", {"a": "1", "b": "x=y"}, True)
    assert set(read_picture(tmp_path / "a.exr").layers) == {"rgb", "depth", "direct"}


def test_quiet_says_nothing_and_writes_all(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    code, out, err = lumel("render", "s", "-o", tmp_path / "a.exr", "-o", tmp_path / "a.png", "--quiet", "--exposure", "1")
    assert (code, out, err) == (0, "", "")
    assert core.settings["progress"] is None
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.exr", "a.png"]
    linear = [read_picture(tmp_path / name).layers["rgb"] for name in ("a.exr", "a.png")]
    np.testing.assert_allclose(np.clip(2 * linear[0], 0, 1), linear[1], atol=0.005)


def test_memory_of_large_scenes_is_said_before_they_are_rendered(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    flags = ["render", "s", "-o", tmp_path / "a.exr", "--progress"]
    core.failure = SceneError("stopped")
    _, _, err = lumel(*flags, "plain", "--patches", "3M")
    assert err.startswith("memory: about 2.0 GB; this machine has ")
    for kind, patches in (("plain", "3k"), ("json", "3M")):
        assert "memory" not in lumel(*flags, kind, "--patches", patches)[2]


def test_all_cameras_get_files_of_their_own(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    core.cameras = ("left", "right")
    code, _, err = lumel("render", "s", "-o", tmp_path / "a.exr", "-o", tmp_path / "b.png", "--camera", "all")
    assert code == 0, err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.left.exr", "a.right.exr", "b.left.png", "b.right.png"]
    left, right = (read_picture(tmp_path / f"a.{name}.exr").layers["rgb"] for name in core.cameras)
    assert not np.array_equal(left, right)


def test_cameras_that_would_share_a_file_are_refused(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    core.cameras = ("a/b", "a b")
    code, _, err = lumel("render", "s", "-o", tmp_path / "a.exr", "--camera", "all")
    assert code == 3
    assert "a/b, a b" in err
    assert not list(tmp_path.iterdir())


def test_all_bad_flags_are_named_at_once(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    flags = "--rays -5 --patches many --size 0x0 --layers dierct -D novalue --progress fancy --time 3 --exposure 1000"
    code, out, err = lumel("render", "s", "-o", tmp_path / "a.exr", "-o", tmp_path / "a.gif", *flags.split())
    assert code == 2
    assert out == ""
    said = (
        "'-5'",
        "'many'",
        "'0x0'",
        "did you mean 'direct'?",
        "'novalue'",
        "allowed: bar, json, plain",
        "--rays and --time",
        "1000",
        ".gif",
    )
    for part in said:
        assert part in err
    assert len(err.splitlines()) == len(said)
    assert core.loaded is None
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("output", ["a.jpg", "missing/a.exr", "folder.exr", "file/a.exr"])
def test_outputs_are_checked_before_any_work(core: FakeCore, lumel: Lumel, tmp_path: Path, output: str) -> None:
    (tmp_path / "folder.exr").mkdir()
    (tmp_path / "file").touch()
    code, _, err = lumel("render", "s", "-o", tmp_path / output, "-o", tmp_path / "good.exr")
    assert code == 3
    assert output in err
    assert core.loaded is None
    assert not (tmp_path / "good.exr").exists()


def test_usage_errors_have_code_2(lumel: Lumel, tmp_path: Path) -> None:
    assert lumel("render", "s")[0] == 2
    assert lumel("render", "-o", tmp_path / "a.exr")[0] == 2
    assert lumel("render", "s", "-o", tmp_path / "a.exr", "--rayz", "5")[0] == 2
    assert lumel("rendre")[0] == 2
    assert lumel("render", "s", "-o", tmp_path / "a.exr", "--time", "soon")[0] == 2


def test_bad_scenes_have_code_1_and_bad_settings_2(core: FakeCore, lumel: Lumel, tmp_path: Path) -> None:
    core.failure = SceneError([Problem("unknown shape", "s.xml", 3), Problem("no such file", "s.xml", 9)])
    code, _, err = lumel("render", "s.xml", "-o", tmp_path / "a.exr")
    assert code == 1
    assert err.splitlines()[-2:] == ["lumel: error: s.xml:3: unknown shape", "lumel: error: s.xml:9: no such file"]
    core.failure = SettingsError("unknown transport")
    assert lumel("render", "s.xml", "-o", tmp_path / "a.exr", "--transport", "x")[0] == 2
    assert not list(tmp_path.iterdir())


def test_ctrl_c_before_the_render_has_code_130(core: FakeCore, lumel: Lumel, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def interrupt(*_: object, **__: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(sys.modules["lumel.readers"], "load", interrupt)
    assert lumel("render", "s.xml", "-o", tmp_path / "a.exr")[0] == 130
    assert core.settings == {}


@pytest.mark.usefixtures("core")
def test_json_progress_is_one_object_a_line(lumel: Lumel, tmp_path: Path) -> None:
    code, out, err = lumel("render", "s", "-o", tmp_path / "a.exr", "--progress", "json")
    assert (code, out) == (0, "")
    *events, last = (json.loads(line) for line in err.splitlines())
    assert [event["phase"] for event in events] == ["solve", "shoot", "eye"]
    for event in events:
        assert set(event) == {"phase", "fraction", "rays", "rays_per_s", "error", "elapsed", "remaining", "unit"}
    assert events[0]["error"] is None
    assert set(last) == {"phase", "files", "notes", "stats"}
    assert last["phase"] == "done"
    assert last["files"] == [str(tmp_path / "a.exr")]
    assert last["stats"]["rays"] == 1000


def test_plain_progress_says_what_is_known() -> None:
    line = progress.plain_line(Progress("shoot", 0.42, 3_210_000, 4.1e6, 0.0123, 3.0, 65.0))
    assert line == "shooting   42 %, 3.21 M rays, 4.1 M rays/s, error 1.23 %, 1 min 05 s left"
    nan = math.nan
    assert progress.plain_line(Progress("solve", nan, 0, nan, nan, 0.0, nan)) == "solving, 0 rays"


def test_bar_shows_without_a_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    with progress.showing("bar") as show:
        assert show
        show(Progress("solve", math.nan, 0, math.nan, math.nan, 0.0, math.nan))
        show(Progress("eye", 0.5, 10, 1.0, 0.1, 1.0, 1.0))
    assert capsys.readouterr().out == ""


def test_info_has_the_documented_keys(core: FakeCore, lumel: Lumel) -> None:
    code, out, err = lumel("info", "s.xml", "--json", "--patches", "5000", "-D", "a=b")
    assert (code, err) == (0, "")
    found = json.loads(out)
    assert set(found) == words("scene triangles patches surface_area memory_bytes problems power lights materials meshes cameras notes")
    assert core.described == 5000
    assert core.loaded == ("s.xml", {"a": "b"}, False)
    assert found["problems"] == {"degenerate": 1, "duplicate": 0, "huge": 0, "nonfinite": 2}
    assert found["lights"] == [{"name": "lamp", "kind": "area", "power": [math.pi, math.pi, math.pi]}]
    assert set(found["materials"][0]) == words("name diffuse specular mirror alpha eta k two_sided")
    assert set(found["cameras"][0]) == words("name width height fov fov_axis position forward")
    assert found["meshes"] == [{"name": "floor", "triangles": 1, "material": "grey"}]
    np.testing.assert_allclose(found["cameras"][0]["forward"], [0, 0, -1], atol=1e-12)


def test_info_for_people(core: FakeCore, lumel: Lumel) -> None:
    code, out, _ = lumel("info", "s.xml")
    assert code == 0
    assert core.described is None
    for part in (
        "lamp (area): 3.142 3.142 3.142 W",
        "grey: diffuse 0.5 0.5 0.5, one-sided",
        "main: 64x48",
        "note: ignored a thing",
        "1 triangles",
    ):
        assert part in out
    assert "there twice" not in out


@pytest.fixture
def pair(tmp_path: Path) -> tuple[Path, Path]:
    """A picture that is 10 % too bright, and its reference with a stderr layer."""
    reference = np.full((16, 24, 3), 0.5, np.float32)
    write_exr(tmp_path / "image.exr", {"rgb": 1.1 * reference, "direct": reference})
    write_exr(tmp_path / "reference.exr", {"rgb": reference, "stderr": 0.02 * reference})
    return tmp_path / "image.exr", tmp_path / "reference.exr"


def test_compare_as_json(lumel: Lumel, pair: tuple[Path, Path]) -> None:
    code, out, err = lumel("compare", *pair, "--json")
    assert (code, err) == (0, "")
    found = json.loads(out)
    documented = """width height relmse reference_noise image_noise relmse_without_noise relmse_8x8 reference_noise_8x8
        relmse_8x8_without_noise rmse flip mean_ratio mean_ratio_rgb nonfinite_image nonfinite_reference"""
    assert set(found) == words(documented)
    assert found["relmse"] == pytest.approx(0.01 / 1.01, rel=1e-5)
    assert found["reference_noise"] == pytest.approx(0.0004 / 1.01, rel=1e-5)
    assert found["relmse_without_noise"] == pytest.approx(0.0096 / 1.01, rel=1e-5)
    assert found["mean_ratio_rgb"] == pytest.approx([1.1, 1.1, 1.1])
    assert found["image_noise"] is None


def test_compare_for_people_and_with_a_map(lumel: Lumel, pair: tuple[Path, Path], tmp_path: Path) -> None:
    code, out, _ = lumel("compare", *pair, "-o", tmp_path / "diff.png")
    assert code == 0
    for word in ("relMSE", "RMSE", "FLIP", "mean ratio", "noise of the reference", "unknown (no stderr layer)"):
        assert word in out
    assert read_picture(tmp_path / "diff.png").layers["rgb"].shape == (16, 24, 3)


def test_compare_takes_png_too(lumel: Lumel, pair: tuple[Path, Path], tmp_path: Path) -> None:
    write_png(tmp_path / "image.png", read_picture(pair[0]).layers["rgb"])
    code, out, _ = lumel("compare", tmp_path / "image.png", pair[1], "--json")
    assert code == 0
    assert json.loads(out)["mean_ratio"] == pytest.approx(1.1, abs=0.01)


def test_compare_says_what_is_wrong(lumel: Lumel, pair: tuple[Path, Path], tmp_path: Path) -> None:
    write_exr(tmp_path / "small.exr", {"rgb": np.zeros((2, 2, 3))})
    assert lumel("compare", tmp_path / "small.exr", pair[1])[0] == 1
    assert lumel("compare", tmp_path / "none.exr", pair[1])[0] == 1
    code, _, err = lumel("compare", *pair, "--layer", "direct")
    assert code == 1
    assert "reference.exr has no layer 'direct'; did you mean" in err or "allowed: rgb, stderr" in err
    assert lumel("compare", *pair, "-o", tmp_path / "diff.exr")[0] == 3
    assert lumel("compare", *pair, "-o", tmp_path / "missing" / "diff.png")[0] == 3


def test_undefined_numbers_are_null(lumel: Lumel, tmp_path: Path) -> None:
    write_exr(tmp_path / "black.exr", {"rgb": np.zeros((8, 8, 3))})
    code, out, _ = lumel("compare", tmp_path / "black.exr", tmp_path / "black.exr", "--json")
    assert code == 0
    found: dict[str, Any] = json.loads(out)
    assert found["relmse"] is None
    assert found["mean_ratio_rgb"] == [None, None, None]
    assert "undefined" in lumel("compare", tmp_path / "black.exr", tmp_path / "black.exr")[1]


@pytest.mark.parametrize(("given", "expected"), [("5000", 5000), ("1e6", 10**6), ("1.5M", 1_500_000), ("2g", 2 * 10**9), ("3k", 3000)])
def test_counts(given: str, expected: int) -> None:
    problems: list[Problem] = []
    assert values.count("--rays", given, problems) == expected
    assert not problems


@pytest.mark.parametrize("given", ["", "0", "-5", "1.5", "1e-3", "many", "nan", "inf", "1e999", "5 M rays", "0x10"])
def test_counts_that_are_none(given: str) -> None:
    problems: list[Problem] = []
    assert values.count("--rays", given, problems) is None
    assert given in str(problems[0])


@pytest.mark.parametrize("given", ["", "0x0", "640", "640x", "-1x5", "640x480x3", "99999x9", "6.5x4", "axb"])
def test_sizes_that_are_none(given: str) -> None:
    problems: list[Problem] = []
    assert values.size(given, problems) is None
    assert len(problems) == 1
    assert values.size("640x480", problems) == (640, 480)


def test_numbers_for_people() -> None:
    assert [text.si(x) for x in (0, 12, 999.7, 1234, 5.6e6, 7.89e9)] == ["0 ", "12 ", "1 k", "1.23 k", "5.6 M", "7.89 G"]
    assert [text.seconds(x) for x in (0.04, 59.94, 61, 7260, math.nan)] == ["0.0 s", "59.9 s", "1 min 01 s", "2 h 01 min", "?"]
    assert json.loads(text.to_json({"a": [1.0, math.inf, {"b": math.nan}]})) == {"a": [1.0, None, {"b": None}]}


def test_version(lumel: Lumel) -> None:
    assert lumel("--version")[:2] == (0, f"lumel {metadata.version('lumel')}\n")
