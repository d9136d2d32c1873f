"""What ray bundles alone have: numbers of what they met, and the plain iteration."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

import lumel
from running import render, run

SMALL: dict[str, Any] = {"transport": "bundles", "patches": 1000, "size": (16, 16), "quality": "draft"}


def test_numbers_of_what_they_met() -> None:
    stats = render(lumel.load("lumel:cube"), **SMALL, directions=200, window=64).stats
    assert stats["directions"] == 200
    assert stats["window"] == 64
    # Every line through a cube meets two faces, which carry light both ways.
    assert stats["mean_depth"] == pytest.approx(2, abs=1e-3)
    assert stats["fragments"] == pytest.approx(2 * float(str(stats["pairs"])), rel=1e-3)
    assert float(str(stats["parity_violations_per_million"])) < 100
    assert abs(float(str(stats["escaped_share"]))) < 1e-4


def test_the_summary_says_them(tmp_path: Path) -> None:
    flags = ("--transport", "bundles", "--directions", "64", "--window", "64", "--patches", "200", "--size", "8x8", "--quality", "draft")
    ran = run("render", "lumel:cube", *flags, "-o", "a.exr", cwd=tmp_path)
    assert ran.code == 0, ran
    assert "64 directions" in ran.out
    assert "window 64" in ran.out
    assert "parity violations per million lines" in ran.out


def test_explain_tells_what_the_lines_met(tmp_path: Path) -> None:
    scene = lumel.load("lumel:cube")
    result = render(scene, **SMALL, directions=64, window=64, explain=True)
    assert result.explanation is not None
    told, stats = result.explanation.bundles, result.stats
    assert told is not None
    assert (told.directions, told.window, told.fragments, told.pairs) == tuple(
        stats[k] for k in ("directions", "window", "fragments", "pairs")
    )
    assert told.directions_per_s > 0
    assert told.mean_depth == pytest.approx(2, abs=1e-3)
    assert told.parity_violations == stats["parity_violations_per_million"]
    assert (told.received, told.escaped, told.mispaired) == pytest.approx((1, 0, 0), abs=1e-4)
    flags = ("--transport", "bundles", "--directions", "64", "--window", "64", "--patches", "200", "--size", "8x8", "--quality", "draft")
    ran = run("render", "lumel:cube", *flags, "--explain", "-o", "a.exr", cwd=tmp_path)
    assert ran.code == 0, ran
    for said in (
        "directions/s",
        "fragments",
        "pairs",
        "mean depth complexity 2",
        "parity violations per million lines",
        "100.000% arrived",
    ):
        assert said in ran.out.split("\nbundles: ")[1]


def test_plain_iteration_warns_where_its_variance_has_no_bound() -> None:
    bright, dim = (render(with_albedo(albedo), **SMALL, directions=64, iteration="plain", window=64).notes for albedo in (0.95, 0.3))
    assert any("its noise has no bound" in note for note in bright)
    assert not any("its noise has no bound" in note for note in dim)


def with_albedo(albedo: float) -> lumel.Scene:
    """The cube with all faces of one albedo."""
    scene = lumel.load("lumel:cube")
    return replace(scene, materials={name: replace(m, diffuse=(albedo,) * 3) for name, m in scene.materials.items()})
