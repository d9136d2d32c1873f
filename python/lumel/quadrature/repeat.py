"""Repeated comparisons: the errors that estimators really make, where the integral is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from ..errors import SettingsError
from .comparison import Analysis, compare
from .estimates import Estimate, PerEstimator, no_overflow
from .samples import Array, Function, Sampler, check_whole


@dataclass(frozen=True, eq=False)
class Measured:
    """What one estimator did over many seeds; arrays of shape () or (c,), except `values` (seeds,) or (seeds, c).

    `mse` and `bias` are measured against the truth, with standard errors. `predicted_mse` is the mean of what the samples themselves
    predicted. `coverage` is the share of the 95 % confidence intervals that hold the truth, all channels together, and `invalid`
    how many values were the classical fallback because no sample hit g.
    """

    values: Array
    mse: Array
    mse_stderr: Array
    bias: Array
    bias_stderr: Array
    predicted_mse: Array
    coverage: float
    invalid: int


@dataclass(frozen=True, eq=False)
class Experiment(PerEstimator[Measured]):
    """The outcome of `experiment`: `mixed` is None without samples of g; `covered` is the share of runs that passed the test of support."""

    mixed: PerEstimator[Measured] | None
    covered: float


def experiment(
    f: Function,
    g: Function,
    p: Function,
    sample_p: Sampler,
    *,
    truth: ArrayLike,
    seeds: int = 200,
    n: int = 256,
    seed: int = 0,
    sample_g: Sampler | None = None,
    n_g: int = 0,
    p_g: Function | None = None,
    batches: int = 16,
) -> Experiment:
    """Run `compare` with the seeds seed, seed + 1, ..., and measure mean square errors, biases and the coverage of intervals.

    `truth` is the integral of f, of shape () or (c,). The other arguments are those of `compare`. Raises SettingsError.
    """
    if text := check_whole("seeds", seeds, 2) or check_whole("seed", seed, 0):
        raise SettingsError(text)
    target = np.asarray(truth, dtype=np.float64)
    if not np.isfinite(target).all():
        raise SettingsError(f"truth: {truth!r}; allowed: finite numbers")
    runs = []
    for number in range(seed, seed + seeds):
        run = compare(f, g, p, sample_p, n=n, seed=number, sample_g=sample_g, n_g=n_g, p_g=p_g, batches=batches)
        if run.classical.value.shape != target.shape:
            raise SettingsError(f"truth: shape {target.shape}; allowed: {run.classical.value.shape}, that of an estimate")
        runs.append(run)
    with no_overflow():
        alone = _measure_all(runs, target)
        together = [run.mixed for run in runs if run.mixed]
        mixed = _measure_all(together, target) if together else None
    covered = sum(run.support.covered for run in runs) / seeds
    return Experiment(alone.classical, alone.weighted, alone.regression, mixed, covered)


def _measure_all(runs: Sequence[Analysis], truth: Array) -> PerEstimator[Measured]:
    return PerEstimator(
        _measure([run.classical for run in runs], [run.predicted_mse.classical for run in runs], truth),
        _measure([run.weighted for run in runs], [run.predicted_mse.weighted for run in runs], truth),
        _measure([run.regression for run in runs], [run.predicted_mse.regression for run in runs], truth),
    )


def _measure(estimates: Sequence[Estimate], predicted: Sequence[Array], truth: Array) -> Measured:
    values = np.stack([estimate.value for estimate in estimates])
    errors = values - truth
    root = np.sqrt(len(values))
    inside = [(lower <= truth) & (truth <= upper) for lower, upper in (estimate.interval(0.95) for estimate in estimates)]
    return Measured(
        values=values,
        mse=(errors**2).mean(0),
        mse_stderr=(errors**2).std(0, ddof=1) / root,
        bias=errors.mean(0),
        bias_stderr=errors.std(0, ddof=1) / root,
        predicted_mse=np.mean(predicted, axis=0),
        coverage=float(np.mean(inside)),
        invalid=sum(not estimate.valid for estimate in estimates),
    )
