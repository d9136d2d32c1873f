"""The memory that a render is expected to take, against what it takes."""

from __future__ import annotations

import resource
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

import lumel
from lumel.memory import expected
from lumel.settings import Settings

PATCHES = 100_000


def floor() -> lumel.Scene:
    """A glossy floor under a lamp, all of it in view."""

    def square(half: float, y: float, up: bool) -> tuple[npt.NDArray[np.float32], npt.NDArray[np.int32]]:
        corners = half * np.array([[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]], np.float32) + np.array([0, y, 0], np.float32)
        return corners, np.array([[0, 2, 1], [0, 3, 2]] if up else [[0, 1, 2], [0, 2, 3]], np.int32)

    return lumel.Scene(
        (lumel.Mesh("floor", *square(1, 0, up=True), "gloss"), lumel.Mesh("lamp", *square(0.2, 3, up=False), "gloss", emission=(9, 9, 9))),
        {"gloss": lumel.Material("gloss", diffuse=(0.3, 0.3, 0.3), specular=(0.4, 0.4, 0.4), alpha=0.2)},
        cameras=(lumel.Camera.look_at("eye", (0, 2, 0.1), (0, 0, 0), fov=70, width=160, height=160),),
    )


def peak_of_a_render() -> int:
    """Bytes; for a process of its own."""
    lumel.render(floor(), patches=PATCHES, rays=4_000_000, threads=2)
    return 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def test_a_render_takes_what_is_expected() -> None:
    script = "import test_memory; print(test_memory.peak_of_a_render())"
    said = subprocess.run([sys.executable, "-c", script], check=True, capture_output=True, text=True, cwd=Path(__file__).parent).stdout
    assert int(said) == pytest.approx(expected(floor(), Settings(patches=PATCHES, rays=4_000_000)), rel=0.25)


def test_it_grows_with_patches_cameras_pixels_and_bundles() -> None:
    scene = lumel.load("lumel:cornell")
    least = expected(scene, Settings(patches=PATCHES))
    views = tuple(replace(scene.cameras[0], name=name) for name in ("left", "right"))
    assert expected(replace(scene, cameras=views), Settings(patches=PATCHES, camera="all")) > least
    assert expected(scene, Settings(patches=10 * PATCHES)) > 3 * least
    assert expected(scene, Settings(patches=PATCHES, size=(4000, 3000))) > least
    assert expected(scene, Settings(patches=PATCHES, transport="bundles")) > least


@pytest.mark.parametrize("vertices", [np.zeros((0, 3)), np.zeros((1, 3)), np.full((3, 3), np.nan), np.full((3, 3), 1e38)])
def test_it_is_a_number_for_any_mesh(vertices: npt.NDArray[np.float64]) -> None:
    scene = lumel.load("lumel:cornell")
    broken = replace(scene.meshes[0], vertices=vertices.astype(np.float32), triangles=np.array([[0, 1, 2]], np.int32), normals=None)
    assert expected(replace(scene, meshes=(broken,)), Settings()) > 0
