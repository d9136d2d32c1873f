"""Weighted importance sampling as a library: values, errors, predictions and intervals against closed forms."""

from __future__ import annotations

import math
import re
from functools import cache
from pathlib import Path
from statistics import NormalDist
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bins import ESTIMATORS, HALF, LOSES, WINS, Array, Bins
from lumel import quadrature
from lumel.quadrature import Comparison, Experiment


@cache
def repeated(bins: Bins) -> Experiment:
    return bins.experiment(n=256, n_g=64, sample_g=bins.sample_g, batches=8, seeds=300, seed=7)


# A product in two dimensions over the unit square, with two channels: int 4xy (x + y) = 4/3, int 4xy = 1; p = 4 (1 - x) (1 - y) + ...


def f2(x: Array) -> Array:
    weight = 4 * x[:, 0] * x[:, 1]
    return np.stack([weight * (x[:, 0] + x[:, 1]), 2 - weight], axis=1)


def g2(x: Array) -> Array:
    return np.asarray(4 * x[:, 0] * x[:, 1])


def p2(x: Array) -> Array:
    return np.asarray(1.5 - x[:, 0])


def sample_p2(rng: np.random.Generator, n: int) -> Array:
    return np.stack([1.5 - np.sqrt(2.25 - 2 * rng.random(n)), rng.random(n)], axis=1)


def sample_g2(rng: np.random.Generator, n: int) -> Array:
    return np.asarray(np.sqrt(1 - rng.random((n, 2))))


TRUTH2 = np.array([4 / 3, 1.0])


@cache
def repeated_2d() -> Experiment:
    return quadrature.experiment(f2, g2, p2, sample_p2, truth=TRUTH2, n=256, n_g=64, sample_g=sample_g2, batches=8, seeds=300)


def test_t_quantiles_are_those_of_the_tables() -> None:
    table = {(0.95, 1): 12.706205, (0.95, 2): 4.302653, (0.95, 5): 2.570582, (0.95, 15): 2.131450, (0.95, 30): 2.042272}
    table |= {(0.9, 4): 2.131847, (0.99, 10): 3.169273, (0.999, 7): 5.407883, (0.95, 100): 1.983972}
    for (level, dof), t in table.items():
        assert quadrature.t_quantile(level, dof) == pytest.approx(t, abs=2e-6)
    assert quadrature.t_quantile(0.95, 20_000) == pytest.approx(NormalDist().inv_cdf(0.975), abs=1e-3)


@given(level=st.floats(0.001, 0.9999), dof=st.integers(1, 200))
def test_t_quantile_inverts_the_probability(level: float, dof: int) -> None:
    assert quadrature.t_probability(quadrature.t_quantile(level, dof), dof) == pytest.approx(level, abs=1e-9)


@pytest.mark.parametrize("bins", [WINS, LOSES], ids=["wins", "loses"])
def test_one_comparison_holds_the_truth(bins: Bins) -> None:
    found = bins.compare(n=65_536, n_g=16_384, sample_g=bins.sample_g)
    assert found.mixed
    for part in (found, found.mixed):
        for name in ESTIMATORS:
            lower, upper = getattr(part, name).interval(0.9999)
            assert lower < np.mean(bins.heights) < upper, name
            assert upper - lower < 0.2
    assert found.support.covered


def test_two_dimensions_and_channels() -> None:
    found = quadrature.compare(f2, g2, p2, sample_p2, n=65_536, n_g=16_384, sample_g=sample_g2)
    assert found.mixed
    for part in (found, found.mixed):
        for name in ESTIMATORS:
            estimate = getattr(part, name)
            assert estimate.value.shape == estimate.stderr.shape == (2,)
            lower, upper = estimate.interval(0.9999)
            assert ((lower < TRUTH2) & (upper > TRUTH2)).all(), name
    # The first channel goes with g, the second against it.
    assert found.improvement.sign().tolist() == [1, -1]
    assert found.conditions.above.shape == (65_536, 2)


def test_intervals_of_95_percent_hold_the_truth_in_95_percent() -> None:
    experiments = [repeated(WINS), repeated(LOSES), repeated_2d(), repeated_2d()]  # twice, as it has two channels
    for name in ESTIMATORS:
        alone = np.mean([getattr(e, name).coverage for e in experiments])
        mixed = np.mean([getattr(e.mixed, name).coverage for e in experiments])
        assert 0.93 <= alone <= 0.97, name
        assert 0.93 <= mixed <= 0.97, f"mixed {name}"


def test_classical_and_balance_heuristic_are_unbiased() -> None:
    for found in (repeated(WINS), repeated(LOSES), repeated_2d()):
        assert found.mixed
        for measured in (found.classical, found.mixed.classical):
            assert (np.abs(measured.bias) < 3.5 * measured.bias_stderr).all()


def test_bias_of_weighted_is_the_predicted_one_and_falls_as_1_over_n() -> None:
    bins = Bins((1, 1, 1, 1), (1, 1, 4, 2), (1, 1, 1, 1))  # F is 1 always, so weighted is 1/G
    biases = []
    for n in (32, 128):
        found = bins.experiment(n=n, batches=2, seeds=600)
        assert found.weighted.bias == pytest.approx(bins.predict(n).weighted_bias, abs=4 * float(found.weighted.bias_stderr))
        # G is known, and its mean is 1: E[1/G] - 1 = E[1/G + G - 2], which has far less noise.
        rest = found.weighted.values + 1 / found.weighted.values - 2
        error = float(rest.std() / np.sqrt(len(rest)))
        biases.append(rest.mean())
        assert rest.mean() == pytest.approx(bins.predict(n).weighted_bias, rel=0.04, abs=4 * error)
    assert 3 < biases[0] / biases[1] < 5.5


@pytest.mark.parametrize("bins", [WINS, LOSES], ids=["wins", "loses"])
def test_measured_errors_are_the_predicted_ones(bins: Bins) -> None:
    found, n, n_g = repeated(bins), 256, 64
    assert found.mixed
    for part, more in ((found, {}), (found.mixed, {"n_g": n_g})):
        predicted = bins.predict(n, **more).mse
        for name in ESTIMATORS:
            measured = getattr(part, name)
            exact = getattr(predicted, name)
            assert measured.mse == pytest.approx(exact, abs=4 * measured.mse_stderr), name
            assert measured.predicted_mse == pytest.approx(exact, rel=0.08), name


def test_predictions_are_equations_3_and_4() -> None:
    F, bins = 2.75, LOSES
    f, g, p = (bins.at(values, quadrature.grid(0, 1, 4)[0]) for values in (bins.heights, bins.target, bins.density))
    g, p = g / g.mean(), p / p.mean()
    predicted = bins.predict(100)
    assert predicted.value == pytest.approx(F)
    assert predicted.mse.classical == pytest.approx(((f**2 / p).mean() - F**2) / 100)  # (4)
    assert predicted.mse.weighted == pytest.approx((((f - F * g) ** 2) / p).mean() / 100)  # (3)
    assert predicted.improvement == pytest.approx(predicted.mse.classical - predicted.mse.weighted)
    assert predicted.covered == pytest.approx(1)


def test_prediction_from_many_samples_is_that_of_the_grid() -> None:
    points = sample_p2(np.random.default_rng(1), 200_000)
    nodes, weights = quadrature.grid((0, 0), (1, 1), 300)
    exact = quadrature.predict(f2, g2, p2, nodes, n=64, weights=weights)
    sampled = quadrature.predict(f2, g2, p2, points, n=64)
    for name in ESTIMATORS:
        assert getattr(sampled.mse, name) == pytest.approx(getattr(exact.mse, name), rel=0.03), name
    assert exact.value == pytest.approx(TRUTH2, rel=1e-4)


@pytest.mark.parametrize(("bins", "sign"), [(WINS, 1), (LOSES, -1)], ids=["wins", "loses"])
def test_sign_of_the_improvement(bins: Bins, sign: int) -> None:
    assert np.sign(bins.predict(64).improvement) == sign
    found = bins.compare(n=4096)
    assert found.improvement.sign() == sign
    assert found.improvement.value == pytest.approx(found.predicted_mse.classical - found.predicted_mse.weighted, rel=1e-9)
    measured = repeated(bins)
    assert np.sign(measured.classical.mse - measured.weighted.mse) == sign


def test_error_of_the_improvement_is_honest() -> None:
    exact = LOSES.predict(1024).improvement
    pulls = [(e.value - exact) / e.stderr for e in (LOSES.compare(n=1024, seed=seed).improvement for seed in range(200))]
    assert abs(np.mean(pulls)) < 0.3
    assert 0.9 < np.std(pulls) < 1.25


def test_pointwise_conditions() -> None:
    # Bins 0 to 3: f/F >= g > p; f/F <= g < p; g > p but f/F < g; g < p but f/F > g.
    bins = Bins((16, 2, 4, 18), (12, 4, 12, 12), (8, 8, 8, 16))
    conditions = bins.predict(64).conditions
    assert conditions.above.tolist() == [True, False, False, False]
    assert conditions.below.tolist() == [False, True, False, False]
    assert (conditions.share_above, conditions.share_below, conditions.share_equal) == pytest.approx((0.2, 0.2, 0))
    assert not conditions.certain
    sampled = bins.compare(n=16_384).conditions
    assert sampled.share_above == pytest.approx(0.2, abs=0.01)
    assert sampled.share_below == pytest.approx(0.2, abs=0.01)


def test_missing_support_is_found_and_measured() -> None:
    found = HALF.compare(n=1024)
    assert not found.support.covered
    assert found.support.mean == pytest.approx(0.5)
    assert found.support.missing == pytest.approx(0.5)
    # Shooting converges to what it sees: classical to the half of the integral there, weighted to the mean of that half.
    assert found.classical.value == pytest.approx(0.75, abs=0.05)
    assert found.weighted.value == pytest.approx(1.5, abs=0.1)
    exact = HALF.predict(10**9)
    assert exact.covered == pytest.approx(0.5)
    assert np.sqrt(exact.mse.weighted) == pytest.approx(2.5 - 1.5, abs=1e-4)
    assert np.sqrt(exact.mse.classical) == pytest.approx(2.5 - 0.75, abs=1e-4)


def test_mixed_samples_mend_missing_support() -> None:
    found = HALF.compare(n=4096, n_g=4096, sample_g=HALF.sample_g)
    assert found.mixed
    assert found.mixed.support.covered
    assert found.support.holes == pytest.approx(2048, abs=200)
    for name in ESTIMATORS:
        lower, upper = getattr(found.mixed, name).interval(0.9999)
        assert lower < 2.5 < upper, name


def test_false_alarms_of_the_support_test_are_rare() -> None:
    assert min(repeated(WINS).covered, repeated(LOSES).covered, repeated_2d().covered) >= 0.994


def test_uneven_support_is_found_too() -> None:
    # g/p varies, and a tenth of g is missing.
    bins = Bins((1, 1, 1, 1, 1), (3, 2, 4, 0.5, 1), (1, 2, 3, 2, 0))
    support = bins.compare(n=16_384).support
    assert not support.covered
    assert support.missing == pytest.approx(1 / 10.5, abs=4 * support.stderr)


def test_errors_are_right_where_g_is_not_covered() -> None:
    found = [HALF.compare(n=256, seed=seed).weighted for seed in range(200)]  # F/G with G near 1/2
    assert np.mean([e.stderr for e in found]) == pytest.approx(np.std([e.value for e in found]), rel=0.15)


def test_a_hole_in_p_is_proof_where_the_mean_is_none() -> None:
    bins = Bins((1,) * 20, (1, 3) * 10, (1,) * 19 + (0,))  # 7.5 % of g is missing: too little to be seen by 64 samples
    alone = bins.compare().support
    assert alone.covered
    assert alone.holes == 0
    support = bins.compare(n_g=64, sample_g=bins.sample_g).support
    assert support.holes > 0
    assert support.mean == alone.mean
    assert not support.covered


def test_samples_of_both_kinds_are_independent() -> None:
    samples = WINS.draw(n=64, n_g=64, sample_g=WINS.sample_p, p_g=WINS.p)
    assert samples.gathered
    points = np.concatenate([samples.shot.x.ravel(), samples.gathered.x.ravel()])
    assert len(np.unique(points)) == 128


def test_gathering_with_another_density_than_g() -> None:
    found = WINS.compare(n=4096, n_g=4096, sample_g=LOSES.sample_g, p_g=LOSES.g)
    assert found.mixed
    lower, upper = found.mixed.weighted.interval(0.9999)
    assert lower < np.mean(WINS.heights) < upper
    bound = max(a / np.mean(WINS.target) / (b / np.mean(LOSES.target)) for a, b in zip(WINS.target, LOSES.target, strict=True))
    assert found.mixed.largest_weight <= bound / 4096


def test_homogeneous_integrand_is_exact_after_one_hit() -> None:
    bins = Bins((3, 6, 12, 0), (1, 2, 4, 0), (1, 1, 1, 1))
    found = bins.compare(n=16, batches=2)
    assert found.weighted.value == pytest.approx(5.25, rel=1e-14)
    assert found.predicted_mse.weighted == pytest.approx(0, abs=1e-14)
    assert found.conditions.certain


def test_no_hit_falls_back_to_classical() -> None:
    bins = Bins((1, 1, 1, 1), (0, 0, 0, 1), (1, 1, 1, 1e-9))
    found = bins.compare(n=64)
    assert found.hits == 0
    for name in ("weighted", "regression"):
        estimate = getattr(found, name)
        assert not estimate.valid
        assert estimate.value == found.classical.value
        assert math.isinf(estimate.stderr)
    assert not found.support.covered
    assert "inf" in str(found)


def test_one_hit_says_nothing_of_the_error() -> None:
    firsts = iter([0.9] + [0.1] * 15)

    def sample(_: np.random.Generator, n: int) -> Array:
        return np.array([next(firsts)] + [0.1] * (n - 1))

    found = quadrature.compare(WINS.f, Bins((0, 0), (0, 1), (1, 1)).g, WINS.p, sample, n=64)
    assert found.hits == 1
    assert found.weighted.valid
    assert math.isinf(found.weighted.stderr)


def test_stratified_batches_have_smaller_errors() -> None:
    def stratified(rng: np.random.Generator, n: int) -> Array:
        return (np.arange(n) + rng.random(n)) / n

    uniform = Bins((0,), (1,), (1,))
    found = quadrature.compare(lambda x: x**2, lambda x: 2 * (1 - x), uniform.p, stratified, n=4096)
    assert found.classical.stderr < 1e-4 < np.sqrt(found.predicted_mse.classical)
    lower, upper = found.classical.interval(0.999)
    assert lower < 1 / 3 < upper


def values(found: Comparison) -> list[bytes]:
    parts = [part for part in (found, found.mixed) if part]
    return [array.tobytes() for part in parts for name in ESTIMATORS for array in (getattr(part, name).value, getattr(part, name).stderr)]


def test_same_seed_same_bytes() -> None:
    first, again, other = (WINS.compare(n=256, n_g=64, sample_g=WINS.sample_g, seed=seed) for seed in (5, 5, 6))
    assert values(first) == values(again)
    assert not set(values(first)) & set(values(other))


@settings(max_examples=20, deadline=None)
@given(split=st.integers(2, 14), seed=st.integers(0, 2**40))
def test_joined_parts_are_the_whole(split: int, seed: int) -> None:
    def part(first: int, batches: int) -> quadrature.Samples:
        more = {"n": 32 * batches, "n_g": 4 * batches, "batches": batches, "first": first}
        return quadrature.draw(f2, g2, p2, sample_p2, seed=seed, sample_g=sample_g2, **more)  # type: ignore[arg-type]

    whole = part(0, 16)
    joined = part(0, split).join(part(split, 16 - split))
    assert (joined.n, joined.n_g, joined.batches) == (512, 64, 16)
    assert values(quadrature.analyse(joined)) == values(quadrature.analyse(whole))
    swapped = quadrature.analyse(part(split, 16 - split).join(part(0, split)))
    assert swapped.weighted.value == pytest.approx(quadrature.analyse(whole).weighted.value, rel=1e-12)


def test_the_documentation_shows_what_comes_out() -> None:
    text = (Path(__file__).resolve().parents[2] / "docs" / "quadrature.md").read_text(encoding="utf-8")
    first, second = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    names: dict[str, Any] = {"f": lambda x: 5 * x**4 * (0.5 + 0.6 * x), "g": lambda x: 5 * x**4, "p": np.ones_like}
    exec(first + second, names)
    assert str(names["found"]) in text.replace("\n    ", "\n")
    assert not names["theory"].conditions.certain
