"""Weighted importance sampling as a library, on inputs of every kind: bounds, scales, and what is wrong with wrong ones."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st

from bins import ESTIMATORS, HALF, WINS, Array, Bins
from lumel import quadrature
from lumel.errors import SettingsError

positive = st.floats(0.01, 100)


@st.composite
def any_bins(draw: st.DrawFn) -> Bins:
    k = draw(st.integers(2, 6))
    lists = [draw(st.lists(s, min_size=k, max_size=k)) for s in (st.just(0) | positive, st.just(0) | positive, positive)]
    assume(any(lists[1]))
    return Bins(*(tuple(values) for values in lists))


@settings(max_examples=50, deadline=None)
@given(bins=any_bins(), seed=st.integers(0, 1000))
def test_weights_and_values_are_bounded(bins: Bins, seed: int) -> None:
    found = bins.compare(n_g=32, sample_g=bins.sample_g, seed=seed)
    assert found.mixed
    assert found.mixed.largest_weight <= 1 / 32
    for part in (found, found.mixed):
        assert all(np.isfinite(getattr(part, name).value) for name in ESTIMATORS)
        assert not any(np.isnan(getattr(part, name).stderr) for name in ESTIMATORS)
    # Where f is 0 if g is, F/G is a mean of f/g over the samples.
    lit = Bins(tuple(f * g for f, g in zip(bins.heights, bins.target, strict=True)), bins.target, bins.density)
    bright = lit.compare(n_g=32, sample_g=bins.sample_g, seed=seed)
    assert bright.mixed
    for part in (bright, bright.mixed):
        assert 0 <= part.weighted.value <= max(bins.heights) * np.mean(bins.target) * (1 + 1e-9)


@settings(max_examples=50, deadline=None)
@given(bins=any_bins())
def test_the_conditions_suffice(bins: Bins) -> None:
    predicted = bins.predict(64)
    if predicted.conditions.certain:
        assert predicted.improvement >= -1e-9 * predicted.mse.classical
    assert predicted.mse.regression <= min(predicted.mse.classical, predicted.mse.weighted) + 1e-9 * np.mean(bins.heights) ** 2


@settings(max_examples=50, deadline=None)
@given(bins=any_bins(), scale=st.floats(-1e3, 1e3).filter(lambda s: abs(s) > 1e-3))
def test_estimates_scale_with_the_integrand(bins: Bins, scale: float) -> None:
    more = {"n_g": 32, "sample_g": bins.sample_g}
    found, scaled = bins.compare(**more), Bins(tuple(scale * f for f in bins.heights), bins.target, bins.density).compare(**more)
    assert found.mixed
    assert scaled.mixed
    for part, other in ((found, scaled), (found.mixed, scaled.mixed)):
        for name in ESTIMATORS:
            tolerance = 1e-7 * max(bins.heights) * abs(scale)
            assert getattr(other, name).value == pytest.approx(scale * getattr(part, name).value, rel=1e-7, abs=tolerance)


power = st.just(0.0) | st.integers(-310, 305).map(lambda e: float(f"1e{e}"))


@settings(max_examples=100, deadline=None)
@given(f=power, g=power, p=power)
@example(f=5e-324, g=1, p=1)
def test_no_nan_comes_out(f: float, g: float, p: float) -> None:
    noise = Bins((1, 3), (2, 1), (1, 1))
    try:
        found = quadrature.compare(lambda x: f * noise.f(x), lambda x: g * noise.g(x), lambda x: p * noise.p(x), noise.sample_p, n=64)
    except SettingsError:
        return
    for name in ESTIMATORS:
        assert np.isfinite(getattr(found, name).value)
        assert not np.isnan(getattr(found, name).stderr)
        assert np.isfinite(getattr(found.predicted_mse, name))
    assert np.isfinite(found.improvement.value)
    assert not np.isnan(found.improvement.stderr)
    assert np.isfinite([found.support.mean, found.support.stderr, found.support.p_value, found.effective_hits, found.largest_weight]).all()


@settings(max_examples=50, deadline=None)
@given(exponent=st.integers(-100, 100))
def test_far_but_possible_scales_are_handled(exponent: int) -> None:
    scale = 10.0**exponent
    found = quadrature.compare(lambda x: scale * WINS.f(x), WINS.g, WINS.p, WINS.sample_p, n=64)
    assert found.weighted.value / scale == pytest.approx(WINS.compare().weighted.value, rel=1e-12)
    assert found.weighted.stderr / scale == pytest.approx(WINS.compare().weighted.stderr, rel=1e-9)
    assert found.improvement.stderr / scale**2 == pytest.approx(WINS.compare().improvement.stderr, rel=1e-9)


def change(**more: Any) -> dict[str, Any]:
    """Arguments of `compare` that are right, but for those given."""
    right = {"f": WINS.f, "g": WINS.g, "p": WINS.p, "sample_p": WINS.sample_p, "n": 64, "sample_g": WINS.sample_g, "n_g": 16}
    return right | more


def nan_at_the_left(x: Array) -> Array:
    return np.where(x < 0.5, np.nan, 1.0)


WRONG: list[tuple[dict[str, Any], list[str]]] = [
    ({"f": nan_at_the_left}, [r"^f: nan at x = 0\.\d+, and \d+ more like it; allowed: finite"]),
    ({"g": nan_at_the_left}, ["^g: nan at x"]),
    ({"p": lambda x: np.full(len(x), np.inf)}, ["^p: inf at x"]),
    ({"g": lambda x: -WINS.g(x)}, ["^g: -[0-9.]+ at x = .*; allowed: densities of 0 or more"]),
    ({"p": lambda x: x - 0.5}, ["^p: -0"]),
    ({"p": HALF.p}, ["^p: 0.0 at x = .*; allowed: more than 0 wherever sample_p draws points"]),
    ({"sample_g": WINS.sample_p, "g": HALF.g, "p_g": HALF.p}, ["^p_g: 0.0 at x = .* wherever sample_g draws"]),
    ({"p": lambda _: 1.0}, [r"^p: returned shape \(\) for 4 points; allowed: \(4,\)$"]),
    ({"g": lambda x: x[:, None]}, [r"^g: returned shape \(4, 1\)"]),
    ({"f": lambda _: np.ones((3, 4))}, [r"^f: returned shape \(3, 4\) for 4 points; allowed: \(4,\) or \(4, c\)"]),
    ({"f": lambda x: np.ones((len(x), 0))}, [r"^f: returned shape \(4, 0\)"]),
    ({"f": lambda x: x * 1j}, ["^f: returned values of type complex128; allowed: real"]),
    ({"f": lambda x: np.full(len(x), "bright")}, ["^f: returned values of type <U6"]),
    ({"f": lambda x: np.ones((len(x), 1 + (len(x) == 1)))}, ["^f, sample_p, sample_g: the shapes"]),
    ({"sample_p": lambda _, n: np.zeros(n + 1)}, [r"^sample_p: shape \(5,\); allowed: \(4,\) or \(4, d\)"]),
    ({"sample_p": lambda _, n: np.full(n, np.nan)}, ["^sample_p: holds what is not a finite number"]),
    ({"sample_g": lambda _, n: np.zeros((n, 2, 2))}, [r"^sample_g: shape \(1, 2, 2\)"]),
    ({"n": 0, "n_g": 0}, ["^n: 0; allowed: whole numbers of 4 or more"]),
    ({"n": 100}, ["^n: 100 is no multiple of batches = 16; allowed: for example 96 or 112"]),
    ({"n_g": 1}, ["^n_g: 1 is no multiple of batches = 16; allowed: for example 16 or"]),
    ({"n": 2.5, "seed": -1, "batches": 1}, ["^n: 2.5", "^seed: -1", "^batches: 1; allowed: whole numbers of 2 or more"]),
    ({"n": True}, ["^n: True"]),
    ({"sample_g": None}, ["^n_g: 16 without sample_g"]),
    ({"sample_g": None, "n_g": 0, "p_g": WINS.g}, ["^p_g: given without sample_g"]),
    ({"f": nan_at_the_left, "g": lambda x: -x, "p": lambda _: 1.0}, ["^f: nan", "^g: -0", "^p: returned shape"]),
]


@pytest.mark.parametrize(("wrong", "messages"), WRONG)
def test_wrong_arguments_are_named(wrong: dict[str, Any], messages: list[str]) -> None:
    with pytest.raises(SettingsError) as caught:
        quadrature.compare(**change(**wrong))
    texts = [problem.message for problem in caught.value.problems]
    for message in messages:
        assert any(re.search(message, text) for text in texts), f"{message} in {texts}"


def test_other_wrong_arguments_are_named() -> None:
    points, weights = quadrature.grid(0, 1, 4)
    calls: list[tuple[str, Callable[[], object]]] = [
        ("g: integrates to 2 over", lambda: quadrature.predict(WINS.f, lambda x: 2 * WINS.g(x), WINS.p, points, n=9, weights=weights)),
        ("p: 0 at one of the points", lambda: quadrature.predict(WINS.f, WINS.g, HALF.p, points, n=9)),
        (r"weights: shape \(3,\); allowed: \(4,\)", lambda: quadrature.predict(WINS.f, WINS.g, WINS.p, points, n=9, weights=weights[1:])),
        ("n: 0; allowed", lambda: WINS.predict(0)),
        (r"points: shape \(0,\)", lambda: quadrature.predict(WINS.f, WINS.g, WINS.p, [], n=9)),
        ("lower, upper: 1, 0; allowed", lambda: quadrature.grid(1, 0, 4)),
        ("cells: 0; allowed", lambda: quadrature.grid(0, 1, 0)),
        (r"cells: 100000; allowed: .* 20000000 cells", lambda: quadrature.grid((0, 0), (1, 1), 100_000)),
        ("truth: nan; allowed", lambda: quadrature.experiment(WINS.f, WINS.g, WINS.p, WINS.sample_p, truth=np.nan)),
        (r"truth: shape \(2,\); allowed: \(\)", lambda: quadrature.experiment(WINS.f, WINS.g, WINS.p, WINS.sample_p, truth=(1, 2))),
        ("seeds: 1; allowed", lambda: WINS.experiment(seeds=1)),
        ("level: 1; allowed", lambda: WINS.compare().weighted.interval(1)),
        ("dof: 0; allowed", lambda: quadrature.t_quantile(0.5, 0)),
        ("t: -1; allowed", lambda: quadrature.t_probability(-1, 3)),
        ("other: batches of", lambda: WINS.draw(n=64).join(WINS.draw(n=32))),
    ]
    for message, call in calls:
        with pytest.raises(SettingsError, match=f"^{message}"):
            call()
