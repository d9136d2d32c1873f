"""What the figures of the report measure, on samples whose answers are known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lumel import gloss
from lumel.quadrature.student import t_quantile
from lumel.report import coverage, figure4, figure5, hits
from lumel.report.areas import Truth
from lumel.report.figure import gain, times
from lumel.report.iterations import ESTIMATORS, TRANSPORTS, Iterations, looks
from lumel.report.pictures import exposure_for, part_with_detail
from lumel.scene import Camera

AREAS = 20_000
NOISE = 0.3  # standard deviation of what is judged
OWN = 0.1  # and of the truth
EXACT = 2.0


def truth_of(rng: np.random.Generator) -> Truth:
    """A truth with noise of its own."""
    value = EXACT + OWN * rng.standard_normal((AREAS, 3))
    return Truth(np.arange(AREAS), value, np.full((AREAS, 3), OWN**2))


def test_the_noise_of_the_truth_is_not_counted() -> None:
    rng = np.random.default_rng(1)
    value = EXACT + NOISE * rng.standard_normal((4, 3, AREAS, 3))  # runs, iterations
    mean, stderr = figure4.relative_rmse(truth_of(rng), value)
    assert mean.shape == stderr.shape == (3,)
    # The mean square of N values has a relative standard deviation of sqrt(2/N), a root half of it.
    within = 4 * (1 + (OWN / NOISE) ** 2) / math.sqrt(2 * 3 * AREAS)
    np.testing.assert_allclose(mean, NOISE / EXACT, rtol=within)
    assert np.all(stderr < within * mean)


def test_relmse_of_gloss_is_over_lit_pixels_less_the_noise_of_the_reference() -> None:
    reference = np.zeros((4, 4, 3))
    reference[:2] = EXACT
    image = np.full((4, 4, 3), EXACT + 0.5)  # wrong where there is no gloss, too
    assert gloss.relmse(image, reference) == pytest.approx(0.25 / (EXACT**2 * 1.01))
    assert gloss.relmse(image, reference, np.full((4, 4, 3), 0.05)) == pytest.approx(0.2 / (EXACT**2 * 1.01))
    assert math.isnan(gloss.relmse(image, np.zeros((4, 4, 3))))


def test_intervals_of_normal_samples_hold_the_truth_as_often_as_they_claim() -> None:
    rng = np.random.default_rng(2)
    truth = truth_of(rng)
    samples = EXACT + NOISE * rng.standard_normal((coverage.REPLICAS, AREAS, 3))
    variance = samples.var(axis=0, ddof=1) / coverage.REPLICAS
    exact = Truth(truth.index, np.full((AREAS, 3), EXACT), np.zeros((AREAS, 3)))
    shares = coverage.covered(samples.mean(axis=0), variance, exact)
    for level, share in zip(coverage.LEVELS, shares, strict=True):
        assert share == pytest.approx(level, abs=4 * math.sqrt(level * (1 - level) / (3 * AREAS)))
    assert coverage.covered(samples.mean(axis=0), variance / 4, exact)[coverage.QUOTED] < 0.75  # bars half as long promise too much
    assert t_quantile(0.95, coverage.REPLICAS - 1) > 2


def test_areas_are_sorted_by_their_hits() -> None:
    rng = np.random.default_rng(3)
    counts = np.array([4.0, 16.0, 64.0])  # hits after each iteration
    truth = Truth(np.arange(AREAS), np.full((AREAS, 3), EXACT), np.zeros((AREAS, 3)))
    value = EXACT + NOISE * rng.standard_normal((1, 3, AREAS, 3)) / np.sqrt(counts)[:, None, None]
    same = {(transport, name): value for transport in TRANSPORTS for name in ESTIMATORS}
    hit = {key: np.broadcast_to(counts[None, :, None], (1, 3, AREAS)) for key in same}
    found = hits.by_hits(Iterations([1, 4, 16], same, hit, {}), truth, "weighted")
    assert set(found) == {2, 4, 6}
    for b, error in found.items():
        assert error == pytest.approx(NOISE / (EXACT * math.sqrt(1.01) * 2 ** (b / 2)), rel=4 / math.sqrt(2 * 3 * AREAS))


def test_gains_that_noise_hides_are_unknown() -> None:
    assert gain(4.0, 2.0) == 2
    assert times(gain(4.0, 2.0)) == "2 times"
    for classical, other in ((1.0, 0.0), (1.0, -1e-5), (-1e-5, 1.0)):
        assert math.isnan(gain(classical, other))
    assert times(math.nan) == "an unknown number of times"


def test_looks_are_dense_at_first_and_end_with_the_last() -> None:
    assert looks(1) == [1]
    assert looks(64)[:4] == [1, 2, 3, 4]
    assert looks(64)[-1] == 64
    assert len(looks(64)) < 30


def test_a_point_is_found_in_the_picture() -> None:
    camera = Camera.look_at("eye", (1, 2, 3), (1, 2, 0), fov=90, width=200, height=100)  # looks along -z: right is +x
    found = figure5.seen_at(camera, [(1, 2, 0), (4, 2, 0), (1, 3.5, 0), (1, 2, 4)])
    np.testing.assert_allclose(found, [(100, 50), (200, 50), (100, 0), (np.nan, np.nan)], atol=1e-9)
    assert figure5.nearest_to_the_middle(found[1:], camera) == 1


def test_the_part_with_detail_is_where_light_varies() -> None:
    light = np.ones((40, 60, 3))
    light[30:38, 45:55] += np.random.default_rng(4).random((8, 10, 1))
    rows, columns = part_with_detail(light)
    assert rows.start <= 30 < 38 <= rows.stop
    assert columns.start <= 45 < 55 <= columns.stop
    assert part_with_detail(np.ones((1, 1, 3))) == (slice(0, 1), slice(0, 1))
    assert exposure_for(np.zeros((2, 2, 3))) == 0
    assert exposure_for(np.full((2, 2, 3), 0.1)) == pytest.approx(3)
