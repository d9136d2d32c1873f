"""A Result gives what it has by name, and puts it on the disk."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from lumel.errors import OutputError, SettingsError
from lumel.images.exr import read_exr
from lumel.images.png import read_png, to_srgb
from lumel.result import LAYERS, Patches, Result, path_of_camera
from lumel.scene import FloatArray


def some_result(*cameras: str) -> Result:
    """Pictures of 6x4 pixels, the n-th camera sees n everywhere in its first channel; `hits` is no standard layer."""
    none = np.zeros((0, 2, 3), dtype=np.float32)
    patches = Patches(none, none, none, np.zeros(0, np.float32), np.zeros((0, 3), np.float32), np.zeros((0, 3), np.float32))
    pictures: dict[str, dict[str, FloatArray]] = {}
    for n, camera in enumerate(cameras or ("main",)):
        layers = {name: np.full((4, 6, 3), 0.25, np.float32) for name in LAYERS if name != "depth"}
        layers["rgb"] = np.full((4, 6, 3), (n, 0.1, 0.2), np.float32)
        pictures[camera] = {**layers, "depth": np.full((4, 6), 2.0, np.float32), "hits": np.full((4, 6), 5.0, np.float32)}
    return Result(pictures, patches, {"seed": "4"}, {"rays": 1000}, ("a note",))


def test_first_camera_is_the_default() -> None:
    result = some_result("left", "right")
    assert result.cameras == ("left", "right")
    assert result.image()[0, 0, 0] == 0
    assert result.image("right")[0, 0, 0] == 1
    assert result.stderr("right").shape == (4, 6, 3)
    assert result.layer("depth").shape == (4, 6)


def test_unknown_names_list_the_valid_ones() -> None:
    result = some_result("left", "right")
    with pytest.raises(SettingsError, match=r"'rihgt'; did you mean 'right'\? allowed: left, right"):
        result.image("rihgt")
    with pytest.raises(SettingsError, match=r"'dpeth'; did you mean 'depth'\?"):
        result.layer("dpeth")
    with pytest.raises(SettingsError) as caught:
        result.write("a.exr", layers=["no", "direct", "neither"])
    assert len(caught.value.problems) == 2


@pytest.mark.parametrize(
    ("layers", "expected"),
    [
        (None, {"rgb", *LAYERS}),
        ("all", {"rgb", *LAYERS, "hits"}),
        (["depth", "hits"], {"rgb", "depth", "hits"}),
        (["rgb"], {"rgb"}),
    ],
)
def test_exr_has_the_layers_that_were_asked_for(tmp_path: Path, layers: list[str] | None, expected: set[str]) -> None:
    some_result().write(tmp_path / "a.exr", layers=layers)
    picture = read_exr(tmp_path / "a.exr")
    assert set(picture.layers) == expected
    assert picture.metadata["seed"] == "4"


def test_png_shows_the_camera_at_its_exposure(tmp_path: Path) -> None:
    some_result("left", "right").write(tmp_path / "a.PNG", camera="right", exposure=1)
    np.testing.assert_allclose(to_srgb(read_png(tmp_path / "a.PNG").layers["rgb"][0, 0]), to_srgb([2, 0.2, 0.4]), atol=0.002)


def test_other_endings_are_refused(tmp_path: Path) -> None:
    with pytest.raises(OutputError, match=r"'\.jpg' names no picture format; .*allowed: \.exr, \.png"):
        some_result().write(tmp_path / "a.jpg")
    assert not list(tmp_path.iterdir())


def test_notebook_shows_every_camera() -> None:
    shown = some_result("a<b", "c")._repr_html_()
    assert shown.count("data:image/png;base64,") == 2
    assert "a&lt;b" in shown


def test_camera_names_stay_inside_the_folder() -> None:
    assert path_of_camera(Path("out/x.exr"), "main") == Path("out/x.main.exr")
    assert path_of_camera(Path("out/x.exr"), "../../etc/a b").parent == Path("out")
