"""Where a look says that rays are slow to solve, another transport is tried, and the summary says what was chosen and why."""

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


def chosen(
    monkeypatch: pytest.MonkeyPatch, costs: Mapping[str, float] | None = None, hard: float = 0.0, scene: str = "lumel:cube", **settings: Any
) -> lumel.Result:
    """A small render by a quality, where another transport is tried if rays need the share `hard` of the time; of these costs, where they
    are given."""
    monkeypatch.setattr("lumel.schedule.SHORTEST_LOOK", 0.0)
    monkeypatch.setattr("lumel.schedule.SOLVE_HARD", hard)
    monkeypatch.setattr(trial, "LONGEST_SHARE", 1.0)
    monkeypatch.setitem(QUALITIES, "medium", Quality(rays=1_500_000, rays_per_patch=0, directions=8, samples=32))
    if costs:
        monkeypatch.setattr(trial, "error_times_seconds", lambda work, _replica: costs[work.transport] * work.patches)
    small: dict[str, Any] = {"size": (48, 36), "patches": 1500}
    return lumel.render(lumel.load(scene), **small | settings)


@pytest.mark.parametrize(
    ("costs", "best"),
    [({"rays": 1.0, "bundles": 0.1}, "bundles"), ({"rays": 1.0, "bundles": 0.9}, "rays"), ({"rays": 1.0, "bundles": 5.0}, "rays")],
)
def test_what_is_clearly_better_is_chosen(monkeypatch: pytest.MonkeyPatch, costs: Mapping[str, float], best: str) -> None:
    result = chosen(monkeypatch, costs)
    assert result.stats["transport"] == best == result.metadata["transport"]
    ratio = {"bundles": "10 times that of bundles with rays", "rays": f"{costs['bundles']:.2g} times that of rays with bundles"}[best]
    assert str(result.stats["why_transport"]).endswith(ratio)
    assert ("directions" in result.stats) == (best == "bundles")
    assert result.stats["adaptive"] == (best == "rays")


def test_a_trial_leaves_a_good_picture(monkeypatch: pytest.MonkeyPatch) -> None:
    # What a trial shot is forgotten: the light is that of a render without any, to within both their errors.
    plain = lumel.render(lumel.load("lumel:cube"), rays=2_000_000, size=(48, 36), patches=1500, seed=5)
    for costs in (None, {"rays": 1.0, "bundles": 0.1}):
        tried = chosen(monkeypatch, costs)
        assert "trial" in str(tried.stats["why_transport"])
        difference = float(np.mean(tried.image()) / np.mean(plain.image()) - 1)
        assert abs(difference) < 0.02


@pytest.mark.parametrize("settings", [{"transport": "rays"}, {"defensive": 0.2}, {"adaptive": True}])
def test_nothing_is_tried_where_rays_are_asked_for(monkeypatch: pytest.MonkeyPatch, settings: dict[str, Any]) -> None:
    result = chosen(monkeypatch, {"rays": 1.0, "bundles": 0.1}, **settings)
    assert result.stats["transport"] == "rays"
    assert "trial" not in str(result.stats["why_transport"])


def test_nothing_is_tried_that_lets_light_through_walls(monkeypatch: pytest.MonkeyPatch) -> None:
    # Boxes stand across patches of the floor, and bundles send from all of these.
    result = chosen(monkeypatch, {"rays": 1.0, "bundles": 0.1}, scene="lumel:cornell")
    assert result.stats["transport"] == "rays"
    assert "walls divide patches" in str(result.stats["why_transport"])


@pytest.mark.parametrize("settings", [{"rays": 20_000}, {"error": 0.5}, {"time": 0.3}, {"quality": "draft"}])
def test_nothing_is_tried_where_there_is_no_time_for_it(settings: dict[str, Any]) -> None:
    result = lumel.render(lumel.load("lumel:cornell"), size=(16, 12), patches=200, **settings)
    assert result.stats["transport"] == "rays"
    assert str(result.stats["why_transport"]).startswith("by default")


def test_others_are_tried_only_where_rays_are_slow_to_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    # The noise of few pixels is soon gone, and that of the light stays: of many pixels it is the other way round.
    for size, is_tried in (((12, 9), True), ((160, 120), False)):
        why = str(chosen(monkeypatch, hard=0.15, size=size).stats["why_transport"])
        assert ("trial" in why) == is_tried
        assert ("a look says" in why) == (not is_tried)


def test_a_trial_is_no_large_part_of_a_render() -> None:
    for seconds in (0.5, 5.0, 50.0):
        for start in (0.001, 0.1, 1.0):
            assert trial.trial_seconds(start, seconds) <= trial.LONGEST_SHARE * seconds
    assert trial.trial_seconds(0.001, 50.0) == trial.TRIAL_SHARE * 50
    assert trial.trial_seconds(1.0, 5.0) == 0


def test_the_summary_says_who_asked_for_a_transport() -> None:
    result = lumel.render(lumel.load("lumel:cornell"), transport="bundles", directions=16, size=(16, 12), patches=200)
    assert result.stats["why_transport"] == "as asked for"


@pytest.mark.parametrize("best", ["rays", "bundles"])
def test_a_quality_decides_the_same_for_any_threads(monkeypatch: pytest.MonkeyPatch, best: str) -> None:
    # A trial goes by work that is counted. Which transport wins is bent, so that both ways on from it are seen.
    monkeypatch.setattr(trial, "CLEARLY", 1e6 if best == "bundles" else 1e-6)
    one, two = (chosen(monkeypatch, threads=threads) for threads in (1, 2))
    assert "trial" in str(one.stats["why_transport"])
    assert one.stats["transport"] == best
    assert one.stats["why_transport"] == two.stats["why_transport"]
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


def test_a_look_at_the_dark_or_one_that_is_stopped_changes_nothing() -> None:
    scene = lumel.load("lumel:cornell")
    dark = replace(scene, meshes=tuple(replace(mesh, emission=(0, 0, 0)) for mesh in scene.meshes))
    for shown, interrupted in ((dark, None), (scene, lambda: True)):
        result = lumel.render(shown, time=1.2, size=(16, 12), patches=200, interrupted=interrupted)
        assert result.stats["transport"] == "rays"
        assert str(result.stats["why_transport"]).startswith("by default")
