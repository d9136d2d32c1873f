"""The transport is chosen by a trial where the budget is long enough for one, and the summary says why."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

import lumel
from lumel import trial
from lumel.core import to_core
from lumel.error_bars import squared_difference
from lumel.pace import fragments_of_direction
from lumel.settings import QUALITIES, Quality
from test_render_determinism import assert_same


def chosen(monkeypatch: pytest.MonkeyPatch, costs: Mapping[str, float] | None = None, **settings: Any) -> lumel.Result:
    """A short render with trials; of these costs, where they are given."""
    monkeypatch.setattr(trial, "SHORTEST_WITH_TRIAL", 0.5)
    if costs:
        monkeypatch.setattr(trial, "try_transport", lambda _work, transport, _seconds, _stop: costs[transport])
    return lumel.render(lumel.load("lumel:cornell"), time=1.0, size=(32, 24), patches=500, **settings)


@pytest.mark.parametrize(
    ("costs", "best"),
    [({"rays": 1.0, "bundles": 0.1}, "bundles"), ({"rays": 1.0, "bundles": 0.9}, "rays"), ({"rays": 1.0, "bundles": 5.0}, "rays")],
)
def test_what_is_clearly_better_is_chosen(monkeypatch: pytest.MonkeyPatch, costs: Mapping[str, float], best: str) -> None:
    result = chosen(monkeypatch, costs)
    assert result.stats["transport"] == best == result.metadata["transport"]
    assert best in str(result.stats["why_transport"])
    assert ("directions" in result.stats) == (best == "bundles")


def test_a_trial_leaves_a_good_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    # What the trials shot is forgotten: the light is that of a render without any, to within both their errors.
    tried = chosen(monkeypatch)
    assert "trial" in str(tried.stats["why_transport"])
    plain = lumel.render(lumel.load("lumel:cornell"), rays=2_000_000, size=(32, 24), patches=500, seed=5)
    difference = float(np.mean(tried.image()) / np.mean(plain.image()) - 1)
    assert abs(difference) < 0.02


@pytest.mark.parametrize("settings", [{"transport": "rays"}, {"defensive": 0.2}])
def test_nothing_is_tried_where_rays_are_asked_for(monkeypatch: pytest.MonkeyPatch, settings: dict[str, object]) -> None:
    result = chosen(monkeypatch, {"rays": 1.0, "bundles": 0.1}, **settings)
    assert result.stats["transport"] == "rays"


@pytest.mark.parametrize("settings", [{"rays": 20_000}, {"error": 0.5}, {"time": 0.3}, {"quality": "draft"}])
def test_nothing_is_tried_where_there_is_no_time_for_it(settings: dict[str, Any]) -> None:
    result = lumel.render(lumel.load("lumel:cornell"), size=(16, 12), patches=200, **settings)
    assert result.stats["transport"] == "rays"
    assert str(result.stats["why_transport"]).startswith("by default")


def test_the_summary_says_who_asked_for_a_transport() -> None:
    result = lumel.render(lumel.load("lumel:cornell"), transport="bundles", directions=16, size=(16, 12), patches=200)
    assert result.stats["why_transport"] == "as asked for"


@pytest.mark.parametrize("best", trial.TRIED)
def test_a_quality_decides_the_same_for_any_threads(monkeypatch: pytest.MonkeyPatch, best: str) -> None:
    # The trial goes by work that is counted. Which transport wins is bent, so that both ways on from it are seen.
    monkeypatch.setattr(trial, "SHORTEST_WITH_TRIAL", 0.3)
    monkeypatch.setattr(trial, "CLEARLY", 1e6 if best == "bundles" else 1e-6)
    monkeypatch.setitem(QUALITIES, "medium", Quality(rays=1_500_000, rays_per_patch=0, directions=8, samples=32))
    one, two = (lumel.render(lumel.load("lumel:cornell"), size=(48, 36), patches=1500, threads=threads) for threads in (1, 2))
    assert "trial" in str(one.stats["why_transport"])
    assert one.stats["transport"] == best
    assert one.stats["why_transport"] == two.stats["why_transport"]
    assert one.stats["adaptive"] == (best == "rays")
    assert_same(one, two)


@pytest.mark.parametrize("window", [None, 200])
def test_a_direction_meets_as_many_fragments_as_its_cost_counts_on(window: int | None) -> None:
    # Half of the area of all patches in the mean over directions; 64 that are spread evenly come within 2 %. Where no window is given,
    # two pixels of its edge are left out of the count: 1 % of that of 20,000 patches.
    scene = lumel.load("lumel:cornell")
    result = lumel.render(scene, transport="bundles", directions=64, window=window, size=(16, 12), patches=20_000)
    fragments = float(str(result.stats["fragments"])) / float(str(result.stats["directions"]))
    assert fragments == pytest.approx(fragments_of_direction(to_core(scene, 20_000)[0], window), rel=0.02)


def test_what_bundles_meet_together_counts_as_error() -> None:
    # Pictures that differ by v in every pixel are off by v^2, whatever its sign: nothing that all pixels share falls out.
    dim, bright = np.full((4, 5, 3), 1.0), np.full((4, 5, 3), 1.1)
    assert squared_difference([dim], [bright]) == pytest.approx(0.01 / (1.1**2 * 1.01))
    assert squared_difference([bright, dim], [bright, dim]) == 0.0
    # A black picture tells nothing, and black ones alone show no light to compare.
    black = np.zeros((4, 5, 3))
    assert squared_difference([dim, dim], [black, bright]) == squared_difference([dim], [bright])
    assert squared_difference([dim], [black]) == np.inf


def test_a_trial_without_light_or_that_is_stopped_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(trial, "SHORTEST_WITH_TRIAL", 1.0)
    scene = lumel.load("lumel:cornell")
    dark = replace(scene, meshes=tuple(replace(mesh, emission=(0, 0, 0)) for mesh in scene.meshes))
    for shown, interrupted, why in ((dark, None, "by default, since a trial saw no light"), (scene, lambda: True, "interrupted")):
        result = lumel.render(shown, time=1.2, size=(16, 12), patches=200, interrupted=interrupted)
        assert result.stats["transport"] == "rays"
        assert why in str(result.stats["why_transport"])
