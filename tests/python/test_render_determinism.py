"""Equal seed and rays give equal bytes of every channel, for any number of threads."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lumel
from lumel import _core
from lumel.images import read_picture
from lumel.settings import AREAS, TRANSPORTS
from running import budget, render, run

CASES = [(transport, estimator) for transport in TRANSPORTS for estimator in _core.estimators()]


def assert_same(a: lumel.Result, b: lumel.Result) -> None:
    """Every byte of every layer, and of the solution on the patches."""
    for camera, picture in a.pictures.items():
        for name, values in picture.items():
            assert values.tobytes() == b.pictures[camera][name].tobytes(), name
    for name in ("radiosity", "irradiance", "stderr"):
        assert getattr(a.patches, name).tobytes() == getattr(b.patches, name).tobytes(), name


@pytest.mark.parametrize(("transport", "estimator"), CASES)
@pytest.mark.parametrize("first_shot", [True, False])
@pytest.mark.parametrize("areas", AREAS)
def test_threads_do_not_show(areas: str, transport: str, estimator: str, first_shot: bool) -> None:
    settings: dict[str, Any] = {**budget(transport, 150_000), "estimator": estimator, "areas": areas, "first_shot": first_shot}
    scene = lumel.load("lumel:cornell")
    runs = [render(scene, **settings, patches=1500, size=(33, 17), quality="draft", seed=3, threads=threads) for threads in (1, 2, 8)]
    assert_same(runs[0], runs[1])
    assert_same(runs[0], runs[2])


@pytest.mark.parametrize(("transport", "estimator"), CASES)
def test_threads_do_not_show_on_the_bust(shared: Path, transport: str, estimator: str) -> None:
    scene = lumel.load(shared / "scenes/bust.xml")
    settings: dict[str, Any] = {
        **budget(transport, 120_000),
        "estimator": estimator,
        "size": (32, 24),
        "quality": "draft",
        "camera": "all",
    }
    assert_same(render(scene, **settings, threads=1), render(scene, **settings, threads=2))


def test_files_are_equal_but_for_their_metadata(tmp_path: Path) -> None:
    for threads in (1, 2):
        flags = ("--rays", "50k", "--patches", "500", "--size", "16x16", "--layers", "all", "--threads", threads)
        assert run("render", "lumel:cube", *flags, "-o", f"{threads}.exr", cwd=tmp_path).code == 0
    a, b = (read_picture(tmp_path / f"{threads}.exr").layers for threads in (1, 2))
    assert set(a) == set(b)
    assert all(a[name].tobytes() == b[name].tobytes() for name in a)


def test_seeds_differ() -> None:
    scene = lumel.load("lumel:cornell")
    a, b = (render(scene, rays=20_000, patches=500, size=(16, 16), quality="draft", seed=seed).image() for seed in (0, 2**64 - 1))
    assert not np.array_equal(a, b)
    assert a.mean() == pytest.approx(b.mean(), rel=0.2)
