"""Random small scenes, sane or not: a picture of finite numbers >= 0, or an error that says why; never a crash, never a hang."""

from __future__ import annotations

import multiprocessing
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import lumel
from lumel.settings import TRANSPORTS
from running import budget, render

coordinates = st.one_of(
    st.floats(-1, 1, width=32),
    st.sampled_from([0.0, -0.0, 1.0, 1e-7, 1e-30, 1e8, -1e8, 1e15, 1e30, float("nan"), float("inf")]),
)
scales = st.sampled_from([1.0, 1.0, 1.0, 1e-30, 1e-10, 1e-3, 1e4, 1e8, 1e11, 1e14, 1e20])
offsets = st.sampled_from([0.0, 0.0, 0.0, 1.0, 1e4, 1e8, -1e8, 1e14])
emissions = st.sampled_from([0.0, 0.0, 1.0, 1e-30, 1e30])
materials = st.sampled_from(["white", "black", "glossy", "mirror", "front"])
triangles = st.lists(st.tuples(*[coordinates] * 9), min_size=1, max_size=6)
soups = st.fixed_dictionaries(
    {
        "triangles": triangles,
        "twice": st.booleans(),
        "scale": scales,
        "offset": offsets,
        "emission": emissions,
        "material": materials,
        "lamp": st.booleans(),
        "point": st.booleans(),
        "transport": st.sampled_from(TRANSPORTS),
        "estimator": st.sampled_from(["weighted", "classical"]),
        "first_shot": st.booleans(),
    }
)

MATERIALS = {
    "white": lumel.Material("white", diffuse=(1, 1, 1)),
    "black": lumel.Material("black"),
    "glossy": lumel.Material("glossy", diffuse=(0.2, 0.2, 0.2), specular=(0.7, 0.7, 0.7), alpha=0.05),
    "mirror": lumel.Material("mirror", mirror=(1, 1, 1)),
    "front": lumel.Material("front", diffuse=(0.5, 0.4, 0.3), two_sided=False),
}


def build(soup: dict[str, Any]) -> lumel.Scene:
    """The scene that a draw describes."""
    with np.errstate(all="ignore"):
        points = (np.array(soup["triangles"], np.float64).reshape(-1, 3) * soup["scale"] + soup["offset"]).astype(np.float32)
    indices = np.arange(len(points), dtype=np.int32).reshape(-1, 3)
    if soup["twice"]:
        indices = np.concatenate([indices, indices[:, ::-1]])
    meshes = [lumel.Mesh("soup", points, indices, soup["material"], emission=(soup["emission"],) * 3)]
    if soup["lamp"]:
        corners = np.array([[-1, 2, -1], [1, 2, -1], [0, 2, 1]], np.float32)
        meshes.append(lumel.Mesh("lamp", corners, np.array([[0, 1, 2]], np.int32), "black", emission=(3, 2, 1)))
    lights = (lumel.PointLight("point", (0.1, 0.5, 0.2), (1, 1, 1)),) if soup["point"] else ()
    return lumel.Scene(tuple(meshes), MATERIALS, lights)


def try_to_render(soup: dict[str, Any]) -> str:
    """'' for a picture of finite numbers >= 0 or a LumelError, else what is wrong. Runs in a process that may crash."""
    settings = {"estimator": soup["estimator"], "first_shot": soup["first_shot"], **budget(soup["transport"], 2000)}
    try:
        result = render(build(soup), **settings, limit=3, patches=60, size=(6, 4), quality="draft", threads=1)
    except lumel.LumelError as error:
        return "" if str(error) else "an error without words"
    except AssertionError as error:
        return str(error)
    for camera, picture in result.pictures.items():
        for name, values in picture.items():
            if not np.isfinite(values).all():
                return f"{camera}, {name}: not finite"
            if name != "normal" and values.min() < 0:
                return f"{camera}, {name}: {values.min()}"
    for name in ("radiosity", "irradiance", "stderr", "area", "centroid", "normal"):
        if not np.isfinite(getattr(result.patches, name)).all():
            return f"patches, {name}: not finite"
    return ""


class Worker:
    """A process to try scenes in, replaced when it breaks."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None

    def __call__(self, soup: dict[str, Any]) -> str:
        self._pool = self._pool or ProcessPoolExecutor(1, multiprocessing.get_context("spawn"))
        try:
            return self._pool.submit(try_to_render, soup).result(timeout=60)
        except (BrokenProcessPool, TimeoutError) as error:
            self.close()
            return f"the process crashed or hung: {error!r}"

    def close(self) -> None:
        """End the process, even if it hangs."""
        if self._pool:
            for process in list(self._pool._processes.values()):
                process.kill()
            self._pool.shutdown(cancel_futures=True)
        self._pool = None


@pytest.fixture(scope="module")
def worker() -> Iterator[Worker]:
    """One for all draws: starting it takes longer than a render."""
    worker = Worker()
    yield worker
    worker.close()


@settings(max_examples=100, deadline=None, derandomize=True, suppress_health_check=list(HealthCheck))
@given(soup=soups)
def test_soups(worker: Worker, soup: dict[str, Any]) -> None:
    assert worker(soup) == ""


@pytest.mark.slow
@settings(max_examples=3000, deadline=None, suppress_health_check=list(HealthCheck))
@given(soup=soups)
def test_many_soups(worker: Worker, soup: dict[str, Any]) -> None:
    assert worker(soup) == ""


PLAIN = {
    "triangles": [(0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0)], "twice": False, "scale": 1.0, "offset": 0.0, "emission": 0.0,
    "material": "white", "lamp": False, "point": False, "transport": "rays", "estimator": "weighted", "first_shot": True,
}  # fmt: skip


@pytest.mark.parametrize(
    "what",
    [
        {},
        {"emission": 1.0},
        {"twice": True, "emission": 1.0},
        {"lamp": True},
        {"point": True},
        {"scale": 1e-30, "emission": 1.0},
        {"offset": 1e8, "emission": 1.0},
        {"scale": 1e12, "emission": 1.0},
        {"scale": 1e15, "emission": 1.0},
        {"emission": 1e30},
        {"material": "black", "emission": 1.0},
    ],
)
@pytest.mark.parametrize("transport", TRANSPORTS)
def test_single_triangles(worker: Worker, what: dict[str, Any], transport: str) -> None:
    assert worker({**PLAIN, **what, "transport": transport}) == ""


def test_places_and_lights_beyond_floats_are_refused_together() -> None:
    scene = build({**PLAIN, "emission": 1e30})
    with pytest.raises(lumel.SceneError, match="allowed: three numbers from 0 to 1e\\+15") as caught:
        lumel.render(replace(scene, lights=(lumel.PointLight("far", (1e30, 0, 0), (1, 1, float("nan"))),)))
    assert len(caught.value.problems) == 3
    camera = lumel.Camera.look_at("far", (1e30, 0, 0), (0, 0, 0))
    with pytest.raises(lumel.SceneError, match="camera 'far' stands at"):
        lumel.render(replace(build(PLAIN), cameras=(camera,)))
