"""What an estimate says of itself: `auto` is right where half of a lobe is dark, and ratios that cannot be trusted are flagged."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lumel
from lobes import DARK, Floats, Run, luminance, measure
from running import render

GATHER = 16.0 * 2**20  # rays an area: what a render of a million shooting rays or more gathers at least, over the rays of a run
HITS = (50, 400)  # an area, about 200
RAYS = {"half-lit sphere": 30_000, "black back wall": 30_000, "open sky": 100_000, "lit by a mirror": 75_000}
COVERS: dict[str, dict[str, Any]] = {"gathering": {"gather": -1.0}, "shooting": {"gather": 0.0}}


@dataclass(frozen=True)
class Truth:
    """Luminous radiances of the areas of a scene with their standard errors, W/(m2 sr)."""

    value: Floats
    error: Floats


def gathered(scene: lumel.Scene, rays: int = 400_000, **settings: Any) -> Truth:
    """Found by so much gathering that shooting hardly counts, without a ratio. `rays` make the state that is looked at."""
    gather = 65_536 * 400_000 / rays
    areas = measure(scene, Run(rays=rays, replicas=16, estimator="classical", gather=gather, **settings), 999).areas(0, "classical")
    return Truth(luminance(areas["value"]), np.sqrt(luminance(areas["variance"])))


@lru_cache
def dark(name: str) -> tuple[lumel.Scene, Truth]:
    """A scene of DARK with its truth."""
    scene = DARK[name]()
    return scene, gathered(scene)


def assert_right(scene: lumel.Scene, truth: Truth, run: Run, seeds: int) -> None:
    """Within 2 % and 2 standard errors of the truth: all areas together, and so many of them as that leaves by chance."""
    if run.gather < 0:
        run = replace(run, gather=GATHER / run.rays)
    runs = [measure(scene, run, seed).areas(0, run.estimator) for seed in range(seeds)]
    assert HITS[0] < np.median([areas["hits"] for areas in runs]) < HITS[1]
    values = np.array([luminance(areas["value"]) for areas in runs])
    ratios = values.sum(axis=1) / truth.value.sum()
    error = np.hypot(ratios.std(ddof=1) / np.sqrt(seeds), np.linalg.norm(truth.error) / truth.value.sum())
    assert ratios.mean() == pytest.approx(1, abs=0.02 + 2 * error)
    spread = np.hypot(values.std(axis=0, ddof=1) / np.sqrt(seeds), truth.error)
    off = np.abs(values.mean(axis=0) - truth.value) > 0.02 * truth.value + 2 * spread
    assert off.sum() <= 2 + 0.08 * len(off)  # Student's law lets 2 errors pass 5 to 8 % of the areas
    assert np.mean([np.mean(areas["flag"] > 0) for areas in runs]) <= 0.02


@pytest.mark.parametrize("cover", COVERS)
@pytest.mark.parametrize("name", DARK)
def test_auto_is_right_where_lobes_see_the_dark(name: str, cover: str) -> None:
    scene, truth = dark(name)
    assert_right(scene, truth, Run(rays=RAYS[name], **COVERS[cover]), seeds=10)


@pytest.mark.slow
@pytest.mark.parametrize("transport", ["rays", "walk"])
@pytest.mark.parametrize("cover", COVERS)
@pytest.mark.parametrize("name", DARK)
def test_auto_is_right_where_lobes_see_the_dark_over_40_seeds(name: str, cover: str, transport: str) -> None:
    scene, truth = dark(name)
    assert_right(scene, truth, Run(rays=RAYS[name], transport=transport, **COVERS[cover]), seeds=40)


def courtyard(shared: Path) -> lumel.Scene:
    """The scene in few pixels. It takes many patches: the direct light of a large one is noise that all pixels share."""
    scene = lumel.load(shared / "scenes/courtyard.xml")
    return replace(scene, cameras=(scene.cameras[0].with_size(24, 18),))


@pytest.mark.slow
@pytest.mark.parametrize("cover", COVERS)
def test_auto_is_right_in_the_courtyard(shared: Path, cover: str) -> None:
    scene = courtyard(shared)
    whole: dict[str, Any] = {"areas": "pixels", "first_shot": True, "patches": 10_000}
    truth = gathered(scene, rays=4_000_000, **whole)
    assert_right(scene, truth, Run(rays=1_000_000, **whole, **COVERS[cover]), seeds=40)


def assert_flagged(scene: lumel.Scene, truth: Truth, run: Run, seeds: int) -> None:
    """Areas that are too bright are flagged, and those that are not flagged are together about right."""
    runs = [measure(scene, run, seed).areas(0, "weighted") for seed in range(seeds)]
    values = np.array([luminance(areas["value"]) for areas in runs])
    flags = np.array([areas["flag"] for areas in runs]) > 0
    spread = np.hypot(values.std(axis=0, ddof=1) / np.sqrt(seeds), truth.error)
    bright = values.mean(axis=0) > 1.1 * truth.value + 4 * spread
    assert bright.mean() > 0.3, "the test cannot fail"
    assert flags[:, bright].mean() > 0.95
    unflagged = ~flags & (truth.value > 0)
    assert (values * unflagged).sum() <= 1.1 * (truth.value * unflagged).sum() + 1e-9


@pytest.mark.parametrize("name", DARK)
def test_ratios_over_part_of_the_lobe_are_flagged(name: str) -> None:
    scene, truth = dark(name)
    assert_flagged(scene, truth, Run(RAYS[name], 16, "weighted", defensive=0.0, gather=0.0), seeds=4)


@pytest.mark.slow
def test_ratios_over_part_of_the_lobe_are_flagged_in_the_courtyard(shared: Path) -> None:
    scene = courtyard(shared)
    whole: dict[str, Any] = {"areas": "pixels", "first_shot": True, "patches": 10_000}
    truth = gathered(scene, rays=4_000_000, **whole)
    assert_flagged(scene, truth, Run(2_000_000, 16, "weighted", defensive=0.0, gather=0.0, **whole), seeds=8)


@pytest.mark.parametrize("areas", ["patches", "pixels"])
@pytest.mark.parametrize("name", DARK)
def test_flags_are_said_in_layer_stats_and_notes(name: str, areas: str) -> None:
    bare: dict[str, Any] = {"estimator": "weighted", "defensive": 0.0, "gather": 0.0, "first_shot": False, "areas": areas}
    work: dict[str, Any] = {"rays": 400_000, "patches": 200, "quality": "draft", "layers": "all"}
    bad, good = render(DARK[name](), **bare, **work), render(DARK[name](), **{**bare, "gather": 16.0}, **work)
    said = [any("density does not cover" in note for note in result.notes) for result in (bad, good)]
    assert said == [True, False]
    assert float(str(bad.stats["flagged"])) > 0.3
    assert bad.layer("flag").max() == 1
    assert float(str(good.stats["flagged"])) <= 0.02


FALSE_FLAGS = [
    pytest.param(estimator, gather, areas, id=f"{estimator}-{'gathering' if gather else 'shooting'}-{areas}")
    for estimator, gather in (("auto", 16.0), ("weighted", 0.0))
    for areas in ("patches", "pixels")
]


def false_flags(scene: lumel.Scene, rays: int, estimator: str, gather: float, areas: str) -> Any:
    """The areas of a closed scene with samples; at most 1 % are flagged."""
    scene = replace(scene, cameras=(scene.cameras[0].with_size(64, 48),))
    run = Run(rays, 16, estimator, gather=gather, areas=areas, first_shot=True, patches=20_000)
    session = measure(scene, run, 5)
    assert not session.stats["open"]
    measured = session.areas(0, estimator)
    flags = measured["flag"][measured["hits"] > 0]
    assert len(flags) >= 300
    assert flags.mean() <= 0.01
    return measured


@pytest.mark.parametrize(("estimator", "gather", "areas"), FALSE_FLAGS)
def test_few_flags_are_false(estimator: str, gather: float, areas: str) -> None:
    false_flags(lumel.load("lumel:cornell"), 600_000, estimator, gather, areas)


@pytest.mark.slow
@pytest.mark.parametrize(("estimator", "gather", "areas"), FALSE_FLAGS)
@pytest.mark.parametrize("rays", [1_000_000, 8_000_000])
@pytest.mark.parametrize("name", ["bust", "cornell_glossy"])
def test_few_flags_are_false_in_shared_scenes(shared: Path, name: str, rays: int, estimator: str, gather: float, areas: str) -> None:
    false_flags(lumel.load(shared / f"scenes/{name}.xml"), rays, estimator, gather, areas)


@pytest.mark.parametrize("areas", ["patches", "pixels"])
def test_looks_predict_the_variance_of_g(areas: str) -> None:
    measured = false_flags(lumel.load("lumel:cornell"), 600_000, "weighted", 0.0, areas)
    # Choose by the looks, which know nothing of the samples, areas that were hit often enough for a spread.
    often = (measured["weight.variance.looks"] > 0) & (measured["weight.variance.looks"] < 1)
    looks, spread = (measured[name][often].mean() for name in ("weight.variance.looks", "weight.variance"))
    assert often.sum() > 100
    # Even steps through the sources make the true variance somewhat less than that of independent rays.
    assert spread == pytest.approx(looks, rel=0.25)
