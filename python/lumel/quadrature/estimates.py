"""Estimators of an integral from samples of f and g: one value each, with its standard error and confidence interval."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from ..errors import SettingsError
from .samples import Array
from .student import t_quantile

T = TypeVar("T")

# Below this relative variation g is taken for proportional to the density that was sampled: what varies is rounding.
ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class Estimate:
    """A value with its error: arrays of shape (), or (c,) for c channels.

    `stderr` is infinite where fewer than two batches hit the target density, so that nothing can be said about a ratio.
    `dof` are the degrees of freedom of `stderr`. `valid` is False where no sample hit it: the value is then the classical one.
    """

    value: Array
    stderr: Array
    dof: int
    valid: bool = True

    def interval(self, level: float = 0.95) -> tuple[Array, Array]:
        """The confidence interval (lower, upper) of probability `level`, 0 < level < 1, by Student's t."""
        half = t_quantile(level, self.dof) * self.stderr
        return self.value - half, self.value + half

    def sign(self, level: float = 0.95) -> NDArray[np.int64]:
        """1 or -1 where the confidence interval of that level lies above or below 0, and 0 where it does not tell."""
        lower, upper = self.interval(level)
        return np.asarray(np.where(lower > 0, 1, np.where(upper < 0, -1, 0)), dtype=np.int64)

    def __str__(self) -> str:
        pairs = zip(np.ravel(self.value), np.ravel(self.stderr), strict=True)
        return ", ".join(f"{value:.6g} +- {error:.2g}" for value, error in pairs)


@dataclass(frozen=True, eq=False)
class PerEstimator(Generic[T]):
    """One thing for each estimator. With F = mean(f/p) and G = mean(g/p):

    `classical` is F: unbiased. `weighted` is F/G: consistent, bias O(1/n). `regression` is F - b (G - 1) with b = Cov(f/p, g/p) /
    Var(g/p) of the samples: consistent, asymptotically never worse than the others.
    """

    classical: T
    weighted: T
    regression: T


@dataclass(frozen=True, eq=False)
class Terms:
    """What samples of one kind add to F and G, f (B, m, c) and g (B, m): the sum over one of B batches is an estimate by itself."""

    f: Array
    g: Array


def estimate(kinds: Sequence[Terms], scalar: bool) -> PerEstimator[Estimate]:
    """The estimates from all batches together: sums first, then ONE ratio. Standard errors take the batches as replicas."""
    F_b = sum_of([kind.f.sum(1) for kind in kinds])
    G_b = sum_of([kind.g.sum(1) for kind in kinds])[:, None]
    F, G = F_b.mean(0), G_b.mean(0)
    hit_batches = int((G_b > 0).sum())

    def made(value: Array, residual: Array, enough: int = 0, inflation: float = 1.0) -> Estimate:
        error = np.sqrt(inflation) * standard_error(residual)
        error = error if hit_batches >= enough else np.full_like(error, np.inf)
        return Estimate(shaped(value, scalar), shaped(error, scalar), len(F_b) - 1, valid=enough == 0 or hit_batches > 0)

    # The delta method: F/G varies as (F_b - R G_b) / G does ([WIS] section 2). Without a hit both corrections fall back to F.
    R = F / G if hit_batches else F
    b, inflation = _slope(kinds, F_b, G, R)
    return PerEstimator(
        classical=made(F, F_b - F),
        weighted=made(R, (F_b - R * G_b) / (G if hit_batches else 1.0), enough=2),
        regression=made(F - b * (G - 1) if hit_batches else F, F_b - F - b * (G_b - G), enough=2, inflation=inflation),
    )


def _slope(kinds: Sequence[Terms], F_b: Array, G: Array, R: Array) -> tuple[Array, float]:
    """b = Cov(F, G) / Var(G) by the samples, and what the variance of F - b (G - 1) grows by because b is estimated, too."""
    covariance, variance, count = np.zeros_like(R), np.float64(0), 0
    for kind in kinds:  # each kind varies about its own mean: how many samples there are of it is not left to chance
        g = kind.g.reshape(-1, 1)
        f = kind.f.reshape(len(g), -1)
        g_rest = g - g.mean(0)
        covariance = covariance + (g_rest * (f - f.mean(0))).sum(0)
        variance = variance + (g_rest**2).sum()
        count += len(g)
    scale = float(sum((kind.g**2).sum() for kind in kinds))
    if variance <= ROUNDING**2 * scale:
        return R, 1.0  # G is known without error: any b is right, and this one equals F/G
    # The textbook variance of a regression on count samples, at a G that is (G - 1) away from its mean.
    off = (G[0] * len(F_b) - len(F_b)) ** 2 / variance
    return covariance / variance, float((count - 1) / (count - 2) * (1 + off / count))


def standard_error(residual: Array) -> Array:
    """Of a mean over batches, from what each batch is off by: (B, c) -> (c,)."""
    batches = len(residual)
    return np.asarray(np.sqrt((residual**2).sum(0) / (batches - 1) / batches))


def shaped(values: Array, scalar: bool) -> Array:
    """Channels (c,) as they are, a scalar as an array of shape ()."""
    return np.asarray(values)[..., 0] if scalar else np.asarray(values)


def sum_of(arrays: Sequence[Array]) -> Array:
    """The sum of equal-shaped arrays, first to last."""
    total = arrays[0]
    for array in arrays[1:]:
        total = total + array
    return total


@contextmanager
def no_overflow() -> Iterator[None]:
    """Turn an overflow, which would go on as infinity or NaN, into a SettingsError."""
    try:
        with np.errstate(over="raise", invalid="raise", divide="raise", under="ignore"):
            yield
    except FloatingPointError as error:
        raise SettingsError("f, g, p: values so large or so small that their squares leave the range of floats; scale them") from error
