"""How a budget is divided between shooting and seeing."""

from __future__ import annotations

from typing import Any

import pytest

import lumel
from lumel import schedule
from lumel.settings import QUALITIES, Quality
from test_render_determinism import assert_same


@pytest.fixture(autouse=True)
def small_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """A quality that takes half a second, and is divided and shown all the same."""
    monkeypatch.setitem(QUALITIES, "draft", Quality(rays=2_000_000, rays_per_patch=0, directions=8, samples=64))
    monkeypatch.setattr(schedule, "SHORTEST_LOOK", 0.1)
    monkeypatch.setattr(schedule, "SHORTEST_WITH_DRAFT", 0.1)


def rendered(**settings: Any) -> lumel.Result:
    """A small room by that quality."""
    return lumel.render(lumel.load("lumel:cornell"), patches=1500, quality="draft", size=(96, 72), **settings)


def test_what_a_quality_decides_is_the_same_for_any_threads_and_with_drafts() -> None:
    # Decisions are by work that is counted, not by time; drafts do not count.
    drafts: list[lumel.Result] = []
    plain, drafted = rendered(threads=1), rendered(threads=2, draft=drafts.append)
    assert drafts
    assert_same(plain, drafted)


def test_the_noisier_part_gets_more(monkeypatch: pytest.MonkeyPatch) -> None:
    rays = []
    for found in ((1e-3, 1e-1), (1e-1, 1e-3)):
        monkeypatch.setattr(schedule, "errors", lambda _session, _cameras, found=found: found)
        rays.append(float(str(rendered().stats["rays"])))
    low, high = schedule.SHOOT_SHARES
    assert rays[1] / rays[0] == pytest.approx(high / low, rel=0.2)
