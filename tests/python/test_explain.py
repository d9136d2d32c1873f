"""`explain`: what a render tells of itself must add up."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import lumel
from lumel.scenes import cornell
from running import run


def test_shares_add_up_and_classical_gains_nothing() -> None:
    scene = cornell.scene()
    for estimator in ("classical", "auto"):
        result = lumel.render(scene, rays=300_000, size=(40, 30), estimator=estimator, gather=0, explain=True)
        told = result.explanation
        assert told is not None
        assert told.work == result.stats["rays"]
        assert sum(lamp.share for lamp in told.lamps) == pytest.approx(1)
        for lamp in told.lamps:
            assert sum(share.share for share in lamp.onto) + lamp.escaped <= 1 + 1e-4
        (areas,) = told.areas
        assert areas.count > 0
        assert areas.hits[0] <= areas.hits[1] <= areas.hits[2]
        assert areas.filled + areas.lowered + areas.empty <= 1 + 1e-9
        if estimator == "classical":
            assert areas.gain == pytest.approx(1)
            assert areas.correction == pytest.approx(0, abs=1e-9)
        else:
            assert areas.gain > 1.5
            assert areas.correction > 0


def test_a_lamp_tells_what_it_shines_on() -> None:
    scene = cornell.scene()
    told = lumel.render(scene, rays=1000, size=(8, 6), explain=True).explanation
    assert told is not None
    # The lamp hangs under the ceiling and shines down: the floor gets light, the ceiling nothing.
    assert any(share.name.startswith("floor") for share in told.lamps[0].onto)
    assert not any(share.name.startswith("ceiling") for share in told.lamps[0].onto)


def test_without_asking_nothing_is_told() -> None:
    assert lumel.render(cornell.scene(), rays=1000, size=(8, 6)).explanation is None


def test_a_scene_without_gloss_or_light_is_explained_too() -> None:
    scene = cornell.scene()
    matte = {name: replace(material, specular=(0.0, 0.0, 0.0)) for name, material in scene.materials.items()}
    dark = replace(scene, materials=matte, meshes=tuple(replace(mesh, emission=(0.0, 0.0, 0.0)) for mesh in scene.meshes))
    told = lumel.render(dark, rays=1000, size=(8, 6), explain=True).explanation
    assert told is not None
    assert told.lamps == ()
    assert told.areas[0].count == 0


def test_the_command_writes_a_picture_of_the_correction(tmp_path: Path) -> None:
    done = run(
        "render", "lumel:cornell", "--rays", 20_000, "--size", "24x18", "--explain", "--progress", "plain", "-o", "a.png", cwd=tmp_path
    )
    assert done.code == 0, done.err
    assert "Lamps: where their light goes first" in done.out
    assert "glossy areas" in done.out
    from PIL import Image

    with Image.open(tmp_path / "a.explain.png") as picture:
        assert picture.size == (24, 18)
        assert len(np.unique(np.asarray(picture)[..., 0])) > 3
