"""The raster of bundles and the closest hits that benchmarks/bundles.py measures."""

from __future__ import annotations

import lumel
from lumel import _core
from lumel.core import to_core


def test_sweeps_count_the_same_on_any_number_of_threads() -> None:
    scene, _ = to_core(lumel.load("lumel:cornell"), 2000)
    one, two = (_core.Raster(scene, threads).sweep(100, 12, 3) for threads in (1, 2))
    assert one == two
    assert one["directions"] == 12
    assert one["pairs"] == one["fragments"] - one["lines"] > 0


def test_lines_of_a_closed_room_enter_and_leave() -> None:
    scene, _ = to_core(lumel.load("lumel:furnace"), 500)
    counts = _core.Raster(scene, 1).sweep(64, 10, 1)
    assert counts["parity_violations"] == 0
    assert counts["fragments"] % 2 == 0


def test_no_ray_leaves_a_closed_room() -> None:
    scene, _ = to_core(lumel.load("lumel:furnace"), 500)
    hits = [_core.Accel(scene).closest_hits(4000, 5, threads) for threads in (1, 2)]
    assert hits[0] == hits[1]
    # Half of the rays start outside, from the backs of the walls.
    assert 1500 < hits[0] < 2500
