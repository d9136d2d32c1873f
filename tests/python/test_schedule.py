"""How a budget is divided into replicas."""

from __future__ import annotations

import pytest

import lumel
from lumel.settings import QUALITIES, Quality
from lumel.work import Work


@pytest.mark.parametrize("rays", [20_000, 200_000, 2_000_000])
def test_no_replica_is_solved_with_far_fewer_rays_than_others(monkeypatch: pytest.MonkeyPatch, rays: int) -> None:
    # Replicas count alike. One whose solution is that of a few rays would leave spots of all their light in the mean.
    solved: list[int] = []
    begin = Work.begin

    def noted(self: Work, wanted: int) -> None:
        solved.append(wanted)
        begin(self, wanted)

    monkeypatch.setattr(Work, "begin", noted)
    monkeypatch.setitem(QUALITIES, "medium", Quality(rays=rays, rays_per_patch=0, directions=8, samples=4))
    result = lumel.render(lumel.load("lumel:cornell"), transport="rays", adaptive=False, size=(48, 36), patches=20_000)
    assert int(str(result.stats["replicas"])) == len(solved) >= 2
    assert min(solved) > 0.1 * max(solved)
