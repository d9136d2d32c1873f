"""Weighted importance sampling for integrals of any kind, without any scene.

    from lumel import quadrature

    found = quadrature.compare(f, g, p, sample_p, n=4096, seed=1)
    print(found)                            # classical, weighted, regression: values, standard errors, predicted errors
    found.weighted.interval(0.95)           # by batches, with Student's t quantile
    found.improvement.sign()                # 1 where weighted has the lower mean square error, -1 where classical has

The integral of f is sampled with density p, and corrected by what the same samples say about the integral of the target
density g, which is known to be 1. [WIS] is Szirmay-Kalos, Antal, Balazs: "Weighted Importance Sampling in Shooting Algorithms"
(SCCG 2003). All is float64; functions take points of shape (n,) or (n, d) and return (n,), f also (n, c) for c channels at once.
"""

from __future__ import annotations

from .comparison import Analysis, Comparison, Support, analyse, compare
from .estimates import Estimate, PerEstimator
from .repeat import Experiment, Measured, experiment
from .samples import Array, Draw, Function, Sampler, Samples, draw
from .student import t_probability, t_quantile
from .theory import Conditions, Prediction, grid, predict

__all__ = [
    "Analysis",
    "Array",
    "Comparison",
    "Conditions",
    "Draw",
    "Estimate",
    "Experiment",
    "Function",
    "Measured",
    "PerEstimator",
    "Prediction",
    "Sampler",
    "Samples",
    "Support",
    "analyse",
    "compare",
    "draw",
    "experiment",
    "grid",
    "predict",
    "t_probability",
    "t_quantile",
]
