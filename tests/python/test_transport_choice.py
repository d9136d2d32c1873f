"""The transport is chosen by a trial where there is time for one, and the summary says why."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pytest

import lumel
from lumel import trial


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


def test_work_alone_decides_nothing() -> None:
    result = lumel.render(lumel.load("lumel:cornell"), rays=20_000, size=(16, 12), patches=200)
    assert result.stats["transport"] == "rays"
    assert str(result.stats["why_transport"]).startswith("by default")
