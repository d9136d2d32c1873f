"""Pictures survive the disk: EXR with two readers, PNG by the formula of sRGB, files all or none."""

from __future__ import annotations

import errno
import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import exrio
import flip_evaluator
import numpy as np
import OpenEXR
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as st_numpy
from PIL import Image

from lumel.errors import OutputError
from lumel.images import ImageError, read_picture
from lumel.images.exr import encode_exr, read_exr, write_exr
from lumel.images.files import problems_with, write_pictures
from lumel.images.png import encode_png, from_srgb, read_png, to_bytes, to_srgb, write_png
from lumel.scene import FloatArray

SUMMANDS = ("emission", "direct", "indirect.diffuse", "indirect.specular")


def some_layers(height: int = 19, width: int = 37) -> dict[str, FloatArray]:
    """Layers of a picture, rgb being the sum of its parts."""
    rng = np.random.default_rng(7)
    layers = {name: rng.exponential(size=(height, width, 3)).astype(np.float32) for name in (*SUMMANDS, "albedo", "normal", "stderr")}
    layers["depth"] = rng.random((height, width), dtype=np.float32) * 1e6
    layers["hits"] = rng.integers(0, 1000, (height, width)).astype(np.float32)
    layers["rgb"] = np.sum([layers[name] for name in SUMMANDS], axis=0, dtype=np.float32)
    return layers


@contextmanager
def full_disk(room: int) -> Iterator[None]:
    """No file of this process may grow beyond `room` bytes."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))


def test_exr_round_trip_keeps_every_layer_and_text(tmp_path: Path) -> None:
    layers = some_layers()
    metadata = {"version": "0.1", "seed": "7", "scene hash": "ab12", "command": "lumel render 'ü.xml'", "time": "3.5", "type": "x"}
    write_exr(tmp_path / "a.exr", layers, metadata)
    picture = read_exr(tmp_path / "a.exr")
    assert set(picture.layers) == set(layers)
    for name, values in layers.items():
        np.testing.assert_array_equal(picture.layers[name], values, err_msg=name)
    assert metadata.items() <= picture.metadata.items()
    assert picture.linear


def test_exr_channels_have_the_documented_names(tmp_path: Path) -> None:
    write_exr(tmp_path / "a.exr", some_layers(), {"seed": "3"})
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        channels, header = set(file.channels()), dict(file.header())
    triples = {f"{name}.{letter}" for name in (*SUMMANDS, "albedo", "stderr") for letter in "RGB"}
    assert channels == {"R", "G", "B", "normal.X", "normal.Y", "normal.Z", "depth.Z", "hits.Y"} | triples
    assert header["lumel.seed"] == "3"
    assert header["compression"] == OpenEXR.ZIP_COMPRESSION


@pytest.mark.parametrize("half", [False, True])
def test_exr_reads_alike_in_another_reader(tmp_path: Path, half: bool) -> None:
    write_exr(tmp_path / "a.exr", some_layers(), {"seed": "3"}, half=half)
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        ours = {name: channel.pixels for name, channel in file.channels().items()}
    (layer,) = exrio.load(str(tmp_path / "a.exr")).layers
    theirs = {channel.name: channel.pixels for channel in layer.channels}
    assert set(theirs) == set(ours)
    for name, pixels in ours.items():
        assert theirs[name].dtype == pixels.dtype
        np.testing.assert_array_equal(theirs[name], pixels, err_msg=name)
    assert layer.attributes["lumel.seed"] == "3"


def test_exr_picture_reads_alike_in_a_third_reader(tmp_path: Path) -> None:
    layers = some_layers()
    write_exr(tmp_path / "a.exr", layers)
    np.testing.assert_array_equal(flip_evaluator.load(str(tmp_path / "a.exr")), layers["rgb"])


@pytest.mark.parametrize(("half", "rounding"), [(False, 2.0**-22), (True, 2.0**-10)])
def test_parts_of_the_picture_add_up_after_the_disk(tmp_path: Path, half: bool, rounding: float) -> None:
    write_exr(tmp_path / "a.exr", some_layers(), half=half)
    layers = read_exr(tmp_path / "a.exr").layers
    total = np.sum([layers[name] for name in SUMMANDS], axis=0, dtype=np.float64)
    assert np.all(np.abs(layers["rgb"] - total) <= rounding * total)


def test_half_keeps_scalars_and_what_exceeds_it_in_float(tmp_path: Path) -> None:
    layers = some_layers()
    layers["emission"][3, 4, 1] = 1e6
    layers["direct"][0, 0] = np.inf
    write_exr(tmp_path / "a.exr", layers, half=True)
    with OpenEXR.File(str(tmp_path / "a.exr"), separate_channels=True) as file:
        kinds = {name: channel.pixels.dtype for name, channel in file.channels().items()}
    assert kinds["R"] == kinds["direct.G"] == kinds["normal.X"] == np.float16
    assert kinds["emission.R"] == kinds["depth.Z"] == kinds["hits.Y"] == np.float32
    read = read_exr(tmp_path / "a.exr").layers
    assert read["emission"][3, 4, 1] == np.float32(1e6)
    np.testing.assert_array_equal(read["depth"], layers["depth"])
    normal = np.clip(layers["rgb"], 6.2e-5, None)
    assert np.all(np.abs(np.clip(read["rgb"], 6.2e-5, None) - normal) <= 2.0**-11 * normal)


@settings(max_examples=30, deadline=None)
@given(
    values=st_numpy.arrays(
        np.float32, st_numpy.array_shapes(min_dims=2, max_dims=2, max_side=9).map(lambda s: (*s, 3)), elements=st.floats(width=32)
    )
)
def test_exr_keeps_any_float(tmp_path_factory: pytest.TempPathFactory, values: FloatArray) -> None:
    path = tmp_path_factory.mktemp("exr") / "a.exr"
    write_exr(path, {"rgb": values})
    np.testing.assert_array_equal(read_exr(path).layers["rgb"], values)


def test_layers_of_different_size_are_refused() -> None:
    with pytest.raises(ValueError, match="common size"):
        encode_exr({"rgb": np.zeros((4, 5, 3)), "depth": np.zeros((5, 4))})
    with pytest.raises(ValueError, match="'rgb'"):
        encode_exr({"rgb": np.zeros((4, 5, 2))})


def test_references_are_read_with_their_errors(shared: Path) -> None:
    paths = sorted((shared / "scenes" / "reference").glob("*.exr"))
    assert paths
    for path in paths:
        layers = read_picture(path).layers
        assert set(layers) == {"rgb", "stderr"}
        assert layers["rgb"].shape == layers["stderr"].shape
        assert layers["rgb"].shape[2] == 3
        assert np.all(layers["stderr"] >= 0)


@pytest.mark.parametrize("share", [0, 0.00005, 0.001, 0.004, 0.01, 0.03, 0.5, 0.9])
def test_incomplete_pictures_are_refused_by_name(tmp_path: Path, share: float) -> None:
    for name, data in (("a.exr", encode_exr(some_layers())), ("a.png", encode_png(some_layers()["rgb"], exposure=-4))):
        (tmp_path / name).write_bytes(data[: int(share * len(data))])
        with pytest.raises(ImageError, match=name):
            read_picture(tmp_path / name)


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ImageError, match="No such file"):
        read_picture(tmp_path / "none.exr")
    (tmp_path / "text.exr").write_text("not a picture")
    with pytest.raises(ImageError, match="neither an EXR nor a PNG"):
        read_picture(tmp_path / "text.exr")
    with pytest.raises(ImageError, match="directory"):
        read_picture(tmp_path)


def test_srgb_is_the_standard_curve_and_inverts() -> None:
    np.testing.assert_allclose(to_srgb([0, 0.0031308, 0.18, 0.5, 1]), [0, 0.04045, 0.46136, 0.73536, 1], atol=1e-5)
    x = np.linspace(0, 1, 1001, dtype=np.float32)
    np.testing.assert_allclose(from_srgb(to_srgb(x)), x, atol=2e-6)
    np.testing.assert_allclose(to_srgb([-1, 2, np.nan, np.inf, -np.inf]), [0, 1, 0, 1, 0], atol=1e-7)


def test_png_holds_the_exposed_picture_and_its_text(tmp_path: Path) -> None:
    rgb = np.full((5, 6, 3), (0.05, 0.1, 0.2), dtype=np.float32)
    write_png(tmp_path / "a.png", rgb, {"seed": "9", "command": "lumel ü"}, exposure=2)
    with Image.open(tmp_path / "a.png") as image:
        assert image.size == (6, 5)
        assert image.info["lumel.command"] == "lumel ü"
        np.testing.assert_array_equal(np.asarray(image), np.rint(255 * to_srgb(4 * rgb)))
    picture = read_png(tmp_path / "a.png")
    assert not picture.linear
    assert picture.metadata["seed"] == "9"
    np.testing.assert_allclose(picture.layers["rgb"], 4 * rgb, atol=0.005)


def test_png_stays_calm_at_the_ends_of_float() -> None:
    assert to_bytes([[[3e38, np.nan, -3e38]]], exposure=100).tolist() == [[[255, 0, 0]]]
    assert to_bytes([[[1.0, 1.0, 1.0]]], exposure=-100).tolist() == [[[0, 0, 0]]]


def test_png_bytes_survive_reading_and_writing() -> None:
    levels = np.arange(256, dtype=np.uint8)
    assert np.array_equal(to_bytes(from_srgb(levels / np.float32(255))), levels)


def test_writing_replaces_and_leaves_nothing_else(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_bytes(b"old")
    (tmp_path / "link.png").symlink_to("a.png")
    write_pictures({tmp_path / "link.png": b"new", tmp_path / "b.exr": b"other"})
    assert (tmp_path / "a.png").read_bytes() == b"new"
    assert (tmp_path / "link.png").is_symlink()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.png", "b.exr", "link.png"]


def test_full_disk_changes_nothing(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(b"old")
    with full_disk(4096), pytest.raises(OutputError, match=r"b\.exr.*unchanged"):
        write_pictures({tmp_path / "a.exr": b"x" * 100, tmp_path / "b.exr": b"x" * 10_000})
    assert [path.name for path in tmp_path.iterdir()] == ["a.exr"]
    assert (tmp_path / "a.exr").read_bytes() == b"old"


def test_error_when_flushing_changes_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def no_space(_: int) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(os, "fsync", no_space)
    with pytest.raises(OutputError, match="No space left on device"):
        write_exr(tmp_path / "a.exr", some_layers())
    assert not list(tmp_path.iterdir())


def test_unwritable_places_are_named_together(tmp_path: Path) -> None:
    (tmp_path / "folder.exr").mkdir()
    (tmp_path / "file").touch()
    paths: dict[str, Any] = {
        "does not exist": tmp_path / "missing" / "a.exr",
        "is not a folder": tmp_path / "file" / "a.exr",
        "is a folder": tmp_path / "folder.exr",
        r"allowed: \.exr, \.png": tmp_path / "a.jpg",
        "names no picture format": tmp_path / "noending",
        "File name too long": tmp_path / ("x" * 251 + ".exr"),
    }
    with pytest.raises(OutputError) as caught:
        write_pictures(dict.fromkeys(paths.values(), b""))
    for message, problem in zip(paths, caught.value.problems, strict=True):
        assert pytest.raises(OutputError, match=message).matches(OutputError(problem))
    assert problems_with([tmp_path / "fine.exr", tmp_path / "fine.PNG"]) == []
    assert [str(problem) for problem in problems_with([tmp_path / "a.exr", tmp_path / "." / "a.exr"])]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", "folder.exr"]


def test_protected_folders_and_files_are_refused(tmp_path: Path) -> None:
    assert problems_with([Path("/proc/lumel.exr")])
    (tmp_path / "old.exr").touch(mode=0o444)
    if os.geteuid() != 0:  # root may write everywhere
        assert "write-protected" in str(problems_with([tmp_path / "old.exr"])[0])
