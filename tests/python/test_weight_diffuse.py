"""Weighing diffuse light: the same light, with less noise where patches have few hits."""

from __future__ import annotations

import numpy as np
import pytest

import lumel
from lumel.scenes import cornell
from running import assert_same_mean

SEEDS = 6


def irradiances(rays: int, **settings: object) -> list[lumel.scene.FloatArray]:
    """Irradiance of the patches that get light, by seed."""
    results = [
        lumel.render(cornell.scene(), rays=rays, patches=800, size=(4, 4), quality="draft", gather=0, seed=seed, **settings)  # type: ignore[arg-type]
        for seed in range(SEEDS)
    ]
    return [result.patches.irradiance for result in results]


def spread(values: list[lumel.scene.FloatArray], truth: lumel.scene.FloatArray) -> float:
    """Mean square error."""
    return float(np.mean([(value - truth) ** 2 for value in values]))


@pytest.mark.parametrize("estimator", ["auto", "weighted", "regression"])
def test_it_is_the_same_light(estimator: str) -> None:
    plain = irradiances(60_000, estimator=estimator, weight_diffuse=False)
    weighed = irradiances(60_000, estimator=estimator, weight_diffuse=True)
    # The bias of a ratio of some 50 hits is below 2 %.
    assert_same_mean(weighed, plain, slack=0.02)


def test_auto_has_less_noise_where_there_are_hits_enough() -> None:
    def pictures(rays: int, seeds: range, **settings: object) -> list[lumel.scene.FloatArray]:
        small = {"patches": 4000, "size": (48, 48), "quality": "draft", "gather": 0}
        results = (lumel.render(cornell.scene(), rays=rays, seed=seed, **small, **settings) for seed in seeds)  # type: ignore[arg-type]
        return [result.layer("indirect.diffuse") for result in results]

    truth = np.mean(pictures(1_000_000, range(90, 92), estimator="classical", weight_diffuse=False), axis=0)
    plain, weighed = (pictures(150_000, range(SEEDS), estimator="auto", weight_diffuse=weigh) for weigh in (False, None))
    assert spread(weighed, truth) < spread(plain, truth)


def test_auto_weighs_where_the_density_covers_the_hemisphere() -> None:
    def render(**settings: object) -> bytes:
        settings = {"rays": 20_000, **settings}
        result = lumel.render(cornell.scene(), patches=4000, size=(4, 4), quality="draft", **settings)  # type: ignore[arg-type]
        return result.patches.irradiance.tobytes()

    assert render(gather=0, rays=1_000_000) == render(gather=0, rays=1_000_000, weight_diffuse=True)
    assert render(gather=0) == render(gather=0, weight_diffuse=False)  # too few hits
    assert render(gather=0, defensive=0) == render(gather=0, defensive=0, weight_diffuse=False)
    assert render() == render(weight_diffuse=False)
