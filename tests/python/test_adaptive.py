"""Patches where the light varies: as many as asked for, the same for every seed, and only where they were asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import lumel
from lumel.errors import SettingsError
from lumel.settings import Settings
from running import render

SMALL: dict[str, Any] = {"rays": 20_000, "patches": 3000, "size": (24, 24), "quality": "draft", "adaptive": True}


def test_patches_differ_in_size_and_are_as_many_as_asked() -> None:
    scene = lumel.load("lumel:cornell")
    result, again, uniform = (render(scene, **SMALL | settings) for settings in ({}, {"seed": 1}, {"adaptive": False}))
    assert result.stats["adaptive"]
    assert not uniform.stats["adaptive"]
    areas, same_size = result.patches.area, uniform.patches.area
    assert len(areas) == result.stats["patches"] == pytest.approx(SMALL["patches"], rel=0.05)
    assert len(same_size) == pytest.approx(SMALL["patches"], rel=0.05)
    assert areas.sum() == pytest.approx(same_size.sum(), rel=1e-4)
    # Most cells have 1, 4 or 16 patches, where even ones of walls and boxes differ by rounding alone.
    assert areas.max() > 10 * np.quantile(areas, 0.01)
    assert same_size.max() < 2 * np.quantile(same_size, 0.01)
    np.testing.assert_array_equal(areas, again.patches.area)


def test_bundles_keep_patches_of_one_size() -> None:
    scene = lumel.load("lumel:cornell")
    assert not render(scene, transport="bundles", directions=8, patches=2000, size=(8, 8), quality="draft").stats["adaptive"]
    with pytest.raises(SettingsError, match="adaptive is False, which the transport bundles does not have; allowed: with rays and walk"):
        render(scene, transport="bundles", directions=8, adaptive=False)


def test_small_triangles_are_left_alone() -> None:
    # As many triangles as patches: there is nothing to deal out, and nothing is looked at.
    scene = lumel.load("lumel:cornell")
    triangles = sum(len(mesh.triangles) for mesh in scene.meshes)
    assert not render(scene, **SMALL | {"patches": triangles}).stats["adaptive"]


def test_all_but_short_renders_look_at_the_light_by_default() -> None:
    short = ({"quality": "draft"}, {"time": 2.0}, {"rays": 100_000})
    for settings, expected in (
        *((s, False) for s in short),
        ({}, True),
        ({"time": 5.0}, True),
        ({"rays": 10_000_000}, True),
        ({"error": 0.01}, True),
    ):
        assert Settings(**settings).wants_adaptive(1000) == expected
    assert not Settings(quality="high", rays=1000).wants_adaptive(1000)
    assert not Settings(time=30.0, transport="bundles").wants_adaptive(1000)
    assert not Settings(time=30.0, adaptive=False).wants_adaptive(1000)
    assert Settings(adaptive=True).wants_adaptive(1000)
    # To look at many triangles takes longer.
    assert Settings(time=5.0).wants_adaptive(50_000)
    assert not Settings(time=5.0).wants_adaptive(51_000)
    assert Settings(quality="medium").wants_adaptive(1_000_000)
