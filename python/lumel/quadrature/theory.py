"""The mean square errors that [WIS] section 2 predicts, and the conditions under which the weighted estimator wins."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import prod

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import Problem, SettingsError
from .estimates import ROUNDING, PerEstimator, no_overflow, shaped
from .samples import Array, Function, check_whole, evaluate, points_of

MOST_POINTS = 20_000_000
OFF_BY = 0.01  # how far the integrals of densities over a grid may be from 1


@dataclass(frozen=True, eq=False)
class Conditions:
    """Where the pointwise conditions of [WIS] section 2 hold, at points x (n,) or (n, d).

    `above` says f/F >= g > p and `below` says f/F <= g < p, of shape (n,) or (n, c). The shares are measured by p, arrays () or (c,);
    `share_equal` is where g = p, which favours nobody. Where the three make up 1, weighted cannot lose; the reverse does not hold.
    """

    x: Array
    above: NDArray[np.bool_]
    below: NDArray[np.bool_]
    share_above: Array
    share_below: Array
    share_equal: Array

    @property
    def certain(self) -> NDArray[np.bool_]:
        """Whether the conditions hold at all of the points, () or (c,), and so guarantee that weighted does not lose."""
        return np.asarray(self.share_above + self.share_below + self.share_equal >= 1 - ROUNDING)


@dataclass(frozen=True, eq=False)
class Prediction:
    """What theory says about n samples of p (and n_g of p_g): `value` is the integral of f; arrays of shape () or (c,).

    `mse` are mean square errors, to first order in 1/n: with n_g = 0 `mse.classical` is equation (4) of [WIS], `mse.weighted` equation
    (3). `weighted_bias` is the bias of F/G to first order. `covered` is the share of g where samples can be (taken for 1 where the
    points are samples); where that is less than 1, the bias that stays for any n is in all of them.
    """

    value: Array
    mse: PerEstimator[Array]
    weighted_bias: Array
    covered: float
    conditions: Conditions

    @property
    def improvement(self) -> Array:
        """The classical mean square error less the weighted one: positive where weighted wins."""
        return np.asarray(self.mse.classical - self.mse.weighted)


@dataclass(frozen=True, eq=False)
class Nodes:
    """Points with quadrature weights w, such that the integral of h is sum(w h): f (m, c), the others (m,)."""

    x: Array
    f: Array
    g: Array
    p: Array
    p_g: Array
    w: Array

    def conditions(self, F: Array, scalar: bool) -> Conditions:
        """The pointwise conditions, for the integral F (c,). Differences of the size of rounding count as equality."""
        g, p = self.g[:, None], self.p[:, None]
        target = F * g
        slack = ROUNDING * (np.abs(self.f) + np.abs(target))
        excess = (self.f - target) * np.sign(F)  # f/F >= g without dividing by F, which may be negative, or 0: then nothing holds
        above = (excess >= -slack) & (g > p) & (F != 0)
        below = (excess <= slack) & (g < p) & (F != 0)
        share = self.w * self.p
        shares = [shaped((share[:, None] * mask).sum(0) / share.sum() * np.ones_like(F), scalar) for mask in (above, below, g == p)]
        return Conditions(self.x, above[:, 0] if scalar else above, below[:, 0] if scalar else below, *shares)


class Moments:
    """Covariances of F = sum f/q and G = sum g/q, q = n p + n_g p_g, by quadrature over the nodes where samples can be."""

    def __init__(self, nodes: Nodes, n: int, n_g: int) -> None:
        q = n * nodes.p + n_g * nodes.p_g
        seen = q > 0
        self.n, self.n_g = n, n_g
        self.w = (nodes.w[seen] / q[seen])[:, None]
        self.f, self.g = nodes.f[seen], nodes.g[seen, None]
        self.p, self.p_g = nodes.p[seen, None], nodes.p_g[seen, None]
        self.F = (nodes.w[seen, None] * self.f).sum(0)
        self.G = float((nodes.w[seen] * nodes.g[seen]).sum())
        self.R = self.F / self.G if self.G > 0 else self.F

    def covariance(self, a: Array, b: Array) -> Array:
        """Of sum a/q and sum b/q, a and b (m, c) or (m, 1). With n_g = 0: (integral of a b/p, less that of a times that of b) / n."""
        total = (self.w * a * b).sum(0)
        for count, density in ((self.n, self.p), (self.n_g, self.p_g)):
            if count:
                total = total - count * (self.w * a * density).sum(0) * (self.w * b * density).sum(0)
        return np.asarray(total)

    def variance(self, a: Array) -> Array:
        return np.maximum(self.covariance(a, a), 0.0)

    def errors(self) -> PerEstimator[Array]:
        """The variances of the three estimators, to first order, if the integral of g where samples can be were 1."""
        classical = self.variance(self.f)  # [WIS] eq. 4: (1/n) (integral of f^2/p, less F^2)
        weighted = self.variance(self.f - self.R * self.g)  # [WIS] eq. 3: (1/n) integral of (f - F g)^2 / p
        return PerEstimator(classical, weighted, self.variance(self.f - self.slope() * self.g))

    def slope(self) -> Array:
        """b of the regression; F/G where g/q does not vary."""
        varies = self.variance(self.g)
        known = varies <= ROUNDING**2 * (self.w * self.g**2).sum()
        return self.R if known.all() else self.covariance(self.f, self.g) / varies


def predict(
    f: Function,
    g: Function,
    p: Function,
    points: ArrayLike,
    *,
    n: int,
    weights: ArrayLike | None = None,
    p_g: Function | None = None,
    n_g: int = 0,
) -> Prediction:
    """Predict the errors of n samples of p, joined by n_g samples of p_g (g where it is None).

    Integrals are taken over `points` (m,) or (m, d) with quadrature `weights` (m,) as `grid` makes them; without weights the points
    are samples of p. On a grid the integrals of g and p must be 1 within 1 %. Raises SettingsError with all problems.
    """
    x = points_of("points", points)
    if texts := [text for name, value, least in (("n", n, 1), ("n_g", n_g, 0)) if (text := check_whole(name, value, least))]:
        raise SettingsError([Problem(text) for text in texts])
    problems: list[Problem] = []
    values = evaluate("f", f, x, problems, channels=True)
    target, density = evaluate("g", g, x, problems), evaluate("p", p, x, problems)
    other = evaluate("p_g", p_g, x, problems) if p_g else target
    if weights is None and not (density > 0).all():
        problems.append(Problem("p: 0 at one of the points; allowed: more than 0 at samples of p; give weights if they are none"))
    if problems:
        raise SettingsError(problems)
    with no_overflow():
        w = 1 / (len(x) * density) if weights is None else _weights(weights, len(x))
        nodes = Nodes(x, values.reshape(len(x), -1), target, density, other, w)
        if weights is not None:
            _check_normalised(nodes, {"p_g": other} if p_g and n_g else {})
        return predict_at(nodes, n, n_g, scalar=values.ndim == 1, sampled=weights is None)


def predict_at(nodes: Nodes, n: int, n_g: int, *, scalar: bool, sampled: bool) -> Prediction:
    """The prediction from values at nodes. Where these were `sampled`, what cannot be sampled is not seen, and taken for nothing."""
    moments = Moments(nodes, n, n_g)
    R, G = moments.R, moments.G
    errors = moments.errors()
    bias = R * moments.variance(moments.g) - moments.covariance(moments.f, moments.g)
    if sampled:
        F, covered = R, 1.0
    else:
        # What samples never see stays as a bias for any n: F misses a part of f, and F/G converges to the mean over what is seen.
        F = (nodes.w[:, None] * nodes.f).sum(0)
        total = float((nodes.w * nodes.g).sum())
        covered = G / total
        off = (moments.F - F, R * total - F, moments.F - moments.slope() * (G - total) - F)
        scale = covered if covered > 0 else 1.0
        errors = PerEstimator(errors.classical + off[0] ** 2, errors.weighted / scale**2 + off[1] ** 2, errors.regression + off[2] ** 2)
        bias = bias / scale**2 + off[1]
    mse = PerEstimator(*(shaped(e, scalar) for e in (errors.classical, errors.weighted, errors.regression)))
    return Prediction(shaped(F, scalar), mse, shaped(bias, scalar), covered, nodes.conditions(F, scalar))


def grid(lower: float | Sequence[float], upper: float | Sequence[float], cells: int | Sequence[int]) -> tuple[Array, Array]:
    """Points and weights of the midpoint rule over a box: points (m,) for numbers as bounds, (m, d) for sequences; weights (m,).

    `cells` counts the cells along each axis, one number for all or one for each; 20 million in all at most.
    """
    low, high = np.atleast_1d(np.asarray(lower, dtype=np.float64)), np.atleast_1d(np.asarray(upper, dtype=np.float64))
    if low.ndim != 1 or low.shape != high.shape or not (np.isfinite(low).all() and np.isfinite(high).all() and (low < high).all()):
        raise SettingsError(f"lower, upper: {lower}, {upper}; allowed: finite bounds of one dimension each, lower < upper")
    counts = [cells] * len(low) if isinstance(cells, (int, np.integer)) else list(cells)
    if len(counts) != len(low) or any(check_whole("cells", count, 1) for count in counts) or prod(counts) > MOST_POINTS:
        raise SettingsError(f"cells: {cells}; allowed: a whole number of 1 or more for each of {len(low)} axes, {MOST_POINTS} cells in all")
    steps = [(b - a) / count for a, b, count in zip(low, high, counts, strict=True)]
    axes = [a + step * (np.arange(count) + 0.5) for a, step, count in zip(low, steps, counts, strict=True)]
    x = np.stack([axis.ravel() for axis in np.meshgrid(*axes, indexing="ij")], axis=1)
    return x[:, 0] if np.ndim(lower) == 0 else x, np.full(len(x), float(np.prod(steps)))


def _weights(weights: ArrayLike, n: int) -> Array:
    w = np.asarray(weights, dtype=np.float64)
    if w.shape != (n,) or not np.isfinite(w).all() or (w <= 0).any():
        raise SettingsError(f"weights: shape {w.shape}; allowed: ({n},), all finite and more than 0")
    return w


def _check_normalised(nodes: Nodes, more: dict[str, Array]) -> None:
    totals = {name: float((nodes.w * values).sum()) for name, values in ({"g": nodes.g, "p": nodes.p} | more).items()}
    wrong = [
        Problem(f"{name}: integrates to {total:.4g} over the points; allowed: 1 within {OFF_BY:.0%} (a finer grid?)")
        for name, total in totals.items()
        if not abs(total - 1) <= OFF_BY
    ]
    if wrong:
        raise SettingsError(wrong)
