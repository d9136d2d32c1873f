"""What is known of the light in a scene must come out of the whole renderer, whatever carries and measures the light."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lumel
from lumel import _core
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.settings import TRANSPORTS
from running import assert_same_mean, budget, render, tiles

CASES = [(transport, estimator) for transport in TRANSPORTS for estimator in _core.estimators()]
SHARED = ("bust", "cornell_glossy", "courtyard", "spotlit")
SEEDS = 8

FACES = {(0, -1, 0): 1.1327, (0, 1, 0): 0.2684, (1, 0, 0): 0.2477, (-1, 0, 0): 0.1285, (0, 0, 1): 0.2075, (0, 0, -1): 0.3194}
"""Inward normal of a face of lumel:cube -> its mean radiosity in the continuous limit, W/m2, +-2e-4."""


@pytest.mark.parametrize(("transport", "estimator"), CASES)
@pytest.mark.parametrize("first_shot", [True, False])
def test_furnace_is_1_in_every_pixel(transport: str, estimator: str, first_shot: bool) -> None:
    settings: dict[str, Any] = {**budget(transport, 1_600_000), "estimator": estimator, "first_shot": first_shot}
    result = render(lumel.load("lumel:furnace"), **settings, patches=1000, size=(32, 24))
    image = result.image().astype(np.float64)
    # Errors of the solution are common to neighbours, so the mean is held to those of single pixels.
    assert np.all(np.abs(image - 1) < result.interval(1 - 1e-3 / image.size) + 1e-3), np.abs(image - 1).max()
    assert image.mean() == pytest.approx(1, abs=5e-3)


@pytest.mark.parametrize("transport", TRANSPORTS)
@pytest.mark.parametrize("first_shot", [True, False])
def test_cube_has_the_radiosities_of_theory(transport: str, first_shot: bool) -> None:
    scene = lumel.load("lumel:cube")
    runs = []
    for seed in range(SEEDS):
        patches = render(
            scene, **budget(transport, 400_000), first_shot=first_shot, patches=3000, size=(4, 4), quality="draft", seed=seed
        ).patches
        normals = patches.normal.round()
        faces = [np.all(normals == face, axis=1) for face in FACES]
        runs.append([np.average(patches.radiosity[face, 0, 0], weights=patches.area[face]) for face in faces])
    found = np.mean(runs, axis=0) + np.array([1, 0, 0, 0, 0, 0])  # the radiosity of a result is what is reflected
    error = np.std(runs, axis=0, ddof=1) / np.sqrt(SEEDS)
    assert np.all(np.abs(found - list(FACES.values())) < 2.5e-4 + 5.4 * error), (found, error)  # t for 7 degrees of freedom at 1e-3
    assert np.sqrt(np.mean(error**2)) < 1e-3, error


def pictures(scene: lumel.Scene, seed: int, **settings: Any) -> list[np.ndarray[Any, np.dtype[np.float32]]]:
    """Small renders with seeds of their own."""
    work: dict[str, Any] = {
        **budget(settings.get("transport", "rays"), 400_000),
        "patches": 4000,
        "size": (32, 32),
        "quality": "draft",
        **settings,
    }
    return [render(scene, **work, seed=seed + k).image() for k in range(SEEDS)]


def assert_agree(scene: lumel.Scene, one: dict[str, Any], other: dict[str, Any], slack: float) -> None:
    """Means of channels and of 8x8 tiles agree to sampling error and a relative `slack`."""
    a, b = pictures(scene, 0, **one), pictures(scene, 1000, **other)
    assert_same_mean([image.mean(axis=(0, 1)) for image in a], [image.mean(axis=(0, 1)) for image in b], slack=slack / 2)
    assert_same_mean([tiles(image) for image in a], [tiles(image) for image in b], slack=slack)


@pytest.mark.parametrize("other", [transport for transport in TRANSPORTS if transport != "rays"])
@pytest.mark.parametrize("name", SHARED)
def test_transports_agree(shared: Path, name: str, other: str) -> None:
    # The spot is lit by so little of the lamp that fewer patches may not find it.
    patches = 20_000 if name == "spotlit" else 4000
    one, rays = ({"transport": transport, "patches": patches} for transport in (other, "rays"))
    assert_agree(lumel.load(shared / f"scenes/{name}.xml"), one, rays, slack=0.01)


@pytest.mark.parametrize("transport", TRANSPORTS)
def test_first_shot_changes_the_noise_alone(transport: str) -> None:
    # Without the first shot the sharper light of the lamps is interpolated between patches too: they must be fine.
    scene, fine = lumel.load("lumel:cornell"), {"transport": transport, "patches": 16_000}
    assert_agree(scene, {**fine, "first_shot": True}, {**fine, "first_shot": False}, slack=0.01)


def test_classical_agrees_with_weighted() -> None:
    # Weighting is biased by O(1/n): the slack is for that.
    assert_agree(lumel.load("lumel:cornell"), {"estimator": "classical"}, {"estimator": "weighted"}, slack=0.02)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_defensive_share_changes_the_noise_alone(share: float) -> None:
    scene = lumel.load("lumel:cornell")
    assert_agree(scene, {"estimator": "classical", "defensive": share}, {"estimator": "classical", "defensive": 0.3}, slack=0.01)


def against_reference(shared: Path, name: str, **settings: Any) -> tuple[float, float]:
    """relMSE without the reference's own noise, of 8x8 means, and the mean ratio."""
    reference = read_picture(shared / f"scenes/reference/{name}.exr").layers
    result = render(lumel.load(shared / f"scenes/{name}.xml"), limit=100, **settings)
    found = compare(result.image(), reference["rgb"], None, reference["stderr"])
    assert found.relmse_8x8_without_noise is not None
    return found.relmse_8x8_without_noise, found.mean_ratio


@pytest.mark.parametrize("name", SHARED)
def test_shared_scenes_look_like_their_references(shared: Path, name: str) -> None:
    estimator, rays = ("classical", 4_000_000) if name == "spotlit" else ("weighted", 1_000_000)
    relmse, ratio = against_reference(shared, name, rays=rays, quality="draft", estimator=estimator)
    assert relmse < 0.02
    assert ratio == pytest.approx(1, abs=0.03)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "settings", "most"),
    [
        ("bust", {"estimator": "weighted"}, 0.02),
        ("cornell_glossy", {"estimator": "weighted"}, 0.02),
        ("courtyard", {"estimator": "weighted"}, 0.05),
        ("gallery", {"estimator": "weighted"}, 0.05),
        ("spotlit", {"estimator": "classical"}, 0.05),
        ("bust", {"transport": "bundles", "areas": "pixels"}, 0.01),
        ("gallery", {"transport": "bundles"}, 0.03),
    ],
)
def test_shared_scenes_in_20_seconds(shared: Path, name: str, settings: dict[str, Any], most: float) -> None:
    reference = read_picture(shared / f"scenes/reference/{name}.exr").layers
    result = render(lumel.load(shared / f"scenes/{name}.xml"), limit=100, time=20, **{"transport": "rays", **settings})
    found = compare(result.image(), reference["rgb"], None, reference["stderr"])
    assert found.relmse_without_noise is not None
    assert found.relmse_without_noise <= most
    assert found.mean_ratio == pytest.approx(1, abs=0.02)


@pytest.mark.slow
def test_walk_agrees_with_rays_in_the_gallery(shared: Path) -> None:
    scene = lumel.load(shared / "scenes/gallery.xml")
    assert_agree(scene, {"transport": "walk", "patches": None}, {"transport": "rays", "patches": None}, slack=0.02)
