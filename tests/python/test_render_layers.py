"""What comes out of a render: layers that add up, metadata, and the interface for Python."""

from __future__ import annotations

import shlex
import threading
import time
from pathlib import Path
from typing import Any

import exrio
import numpy as np
import numpy.typing as npt
import OpenEXR
import pytest
from PIL import Image

import lumel
from lumel.images import read_picture
from lumel.result import LAYERS
from lumel.scene import FloatArray
from running import quad, render, run

SUMMANDS = ("emission", "direct", "indirect.diffuse", "indirect.specular")
TINY: dict[str, Any] = {"rays": 100_000, "patches": 2000, "size": (40, 30), "quality": "draft"}
FLAGS = ("--estimator", "weighted", "--rays", "100k", "--patches", "2000", "--size", "40x30", "--quality", "draft", "--seed", "7")

Channels = dict[str, npt.NDArray[np.floating[Any]]]


@pytest.fixture(scope="module")
def cornell() -> lumel.Result:
    """A diffuse and glossy room with its lamp in view."""
    return render(lumel.load("lumel:cornell"), **TINY)


def read_openexr(path: Path) -> tuple[Channels, dict[str, object]]:
    """Channels and header, by the reader of the format's authors."""
    with OpenEXR.File(str(path), separate_channels=True) as file:
        return {name: channel.pixels for name, channel in file.channels().items()}, dict(file.header())


def read_exrio(path: Path) -> tuple[Channels, dict[str, object]]:
    """The same by a reader of another family."""
    (layer,) = exrio.load(str(path)).layers
    return {channel.name: channel.pixels for channel in layer.channels}, dict(layer.attributes)


@pytest.mark.parametrize("reader", [read_openexr, read_exrio])
@pytest.mark.parametrize(("half", "rounding"), [(False, 2.0**-22), (True, 2.0**-10)])
def test_parts_add_up_to_the_picture_on_disk(cornell: lumel.Result, tmp_path: Path, half: bool, rounding: float, reader: object) -> None:
    cornell.write(tmp_path / "a.exr", half=half)
    assert callable(reader)
    channels, _ = reader(tmp_path / "a.exr")
    for letter in "RGB":
        parts = [channels[f"{name}.{letter}"].astype(np.float64) for name in SUMMANDS]
        # Each part is rounded once, and so is their sum; halves below 6e-5 have fewer digits.
        np.testing.assert_allclose(sum(parts), channels[letter], rtol=rounding, atol=2.0**-23 if half else 0)
        assert all(np.any(part > 0) for part in parts[1:])


def test_file_holds_what_the_result_does(cornell: lumel.Result, tmp_path: Path) -> None:
    cornell.write(tmp_path / "a.exr")
    layers = read_picture(tmp_path / "a.exr").layers
    assert set(layers) == {"rgb", *LAYERS}
    for name, values in layers.items():
        np.testing.assert_array_equal(values, cornell.layer(name), err_msg=name)


def test_layers_are_sane(cornell: lumel.Result) -> None:
    picture = cornell.pictures[cornell.cameras[0]]
    for name, values in picture.items():
        assert values.dtype == np.float32, name
        assert values.shape[:2] == (30, 40), name
        assert np.isfinite(values).all(), name
    for name in (*SUMMANDS, "stderr", "depth"):
        assert picture[name].min() >= 0, name
    assert picture["albedo"].min() >= 0
    assert picture["albedo"].max() <= 1 + 1e-5
    seen = picture["depth"] > 0
    assert np.linalg.norm(picture["normal"], axis=-1).max() <= 1 + 1e-5
    assert np.linalg.norm(picture["normal"], axis=-1)[seen].min() > 0


def test_command_leaves_its_traces(tmp_path: Path) -> None:
    line = ("render", "lumel:cube", *FLAGS, "-o", "a.exr", "-o", "b ü.png", "--layers", "all", "--exposure", "1")
    assert run(*line, cwd=tmp_path).code == 0
    ours, theirs = read_openexr(tmp_path / "a.exr")[1], read_exrio(tmp_path / "a.exr")[1]
    assert shlex.split(str(ours["lumel.command"])) == ["lumel", *line]
    for metadata in (ours, theirs):
        assert metadata["lumel.version"] == lumel.__version__
        assert metadata["lumel.seed"] == "7"
        assert metadata["lumel.rays"] == "100000"
        assert float(str(metadata["lumel.time"])) > 0
        assert len(bytes.fromhex(str(metadata["lumel.scene hash"]))) == 32
        assert (metadata["lumel.transport"], metadata["lumel.estimator"]) == ("rays", "weighted")
    with Image.open(tmp_path / "b ü.png") as png:
        assert png.size == (40, 30)
        assert png.info["lumel.seed"] == "7"
        assert png.info["lumel.scene hash"] == ours["lumel.scene hash"]


def test_scene_hash_tells_scenes_apart() -> None:
    hashes = {render(box(albedo), **TINY).metadata["scene hash"] for albedo in (0.5, 0.5, 0.25)}
    assert len(hashes) == 2


def box(albedo: float = 0.5, emission: float = 1.0) -> lumel.Scene:
    """A closed unit cube from arrays, front inwards, with a lamp for a ceiling."""
    x, y = ([0, 1, 1, 0], [0, 0, 1, 1])
    faces = {
        "floor": [(a, 0, -b) for a, b in zip(x, y, strict=True)],
        "ceiling": [(a, 1, b - 1) for a, b in zip(x, y, strict=True)],
        "back": [(a, b, -1) for a, b in zip(x, y, strict=True)],
        "front": [(1 - a, b, 0) for a, b in zip(x, y, strict=True)],
        "left": [(0, b, a - 1) for a, b in zip(x[::1], y, strict=True)][::-1],
        "right": [(1, b, -a) for a, b in zip(x, y, strict=True)][::-1],
    }
    meshes = tuple(quad(name, corners, "grey", emission if name == "ceiling" else 0.0) for name, corners in faces.items())
    camera = lumel.Camera.look_at("inside", (0.5, 0.5, -0.05), (0.5, 0.5, -1), width=24, height=16, fov=80)
    return lumel.Scene(meshes, {"grey": lumel.Material("grey", diffuse=(albedo,) * 3)}, cameras=(camera,))


def test_scene_from_arrays_has_the_energy_of_theory() -> None:
    albedo = 0.5
    result = render(box(albedo), rays=400_000, patches=2000, first_shot=False)
    assert result.image("inside").shape == (16, 24, 3)
    patches = result.patches
    front = patches.irradiance[:, 0].astype(np.float64)
    mean = (front * patches.area[:, None]).sum(axis=0) / patches.area.sum()
    # Closed, one albedo all over: mean irradiance = power / (area (1 - albedo)), the lamp's power being pi W.
    assert mean == pytest.approx([np.pi / (6 * (1 - albedo))] * 3, rel=3e-3)


def test_patches_have_the_documented_shapes(cornell: lumel.Result) -> None:
    patches, count = cornell.patches, cornell.stats["patches"]
    assert isinstance(count, int)
    shapes = {"radiosity": (count, 2, 3), "irradiance": (count, 2, 3), "stderr": (count, 2, 3), "area": (count,),
              "centroid": (count, 3), "normal": (count, 3)}  # fmt: skip
    for name, shape in shapes.items():
        values: FloatArray = getattr(patches, name)
        assert values.shape == shape, name
        assert values.dtype == np.float32, name
        assert np.isfinite(values).all(), name
    assert patches.area.min() > 0
    np.testing.assert_allclose(np.linalg.norm(patches.normal, axis=1), 1, atol=1e-5)
    assert patches.radiosity.min() >= 0
    assert np.all(patches.radiosity <= patches.irradiance * (1 + 1e-5))


def test_about_as_many_patches_as_asked_for() -> None:
    for wanted in (100, 1000, 10_000):
        patches = render(lumel.load("lumel:cube"), rays=1000, patches=wanted, size=(4, 4)).patches
        assert wanted / 2.5 <= len(patches.area) <= 2 * wanted
        assert patches.area.sum() == pytest.approx(6, rel=1e-4)


def test_notebook_shows_the_picture(cornell: lumel.Result) -> None:
    shown = cornell._repr_html_()
    assert shown.count("data:image/png;base64,") == 1


def test_other_threads_run_while_it_renders() -> None:
    times: list[float] = []
    stop = threading.Event()

    def tick() -> None:
        while not stop.is_set():
            times.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    render(lumel.load("lumel:demo"), rays=600_000, patches=30_000, size=(160, 120))
    end = time.monotonic()
    stop.set()
    thread.join()
    within = [t for t in times if begin <= t <= end]
    # Ten times slower than alone is enough on a busy machine; holding the interpreter would leave a handful.
    assert len(within) > (end - begin) / 0.05
    assert max(np.diff(within)) < 0.5 * (end - begin)


def test_settings_are_checked_all_at_once() -> None:
    with pytest.raises(lumel.SettingsError) as caught:
        lumel.render(box(), transport="wlk", rays=-5, seed=-1, size=(0, 0), camera="x", layers=["direkt"])
    text = str(caught.value)
    for part in ("'wlk'", "rays is -5", "seed is -1", "0x0", "unknown camera 'x'", "unknown layer 'direkt'"):
        assert part in text
