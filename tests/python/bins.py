"""Piecewise constant integrands and densities, whose integrals and predicted errors are known exactly."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lumel import quadrature

Array = NDArray[np.float64]
ESTIMATORS = ("classical", "weighted", "regression")


@dataclass(frozen=True)
class Bins:
    """Piecewise constant functions on [0, 1): f is any, g and p are densities, with samplers of both and exact integrals."""

    heights: tuple[float, ...]
    target: tuple[float, ...]
    density: tuple[float, ...]

    def at(self, values: tuple[float, ...], x: Array) -> Array:
        table: Array = np.asarray(values, dtype=np.float64)
        return np.asarray(table[np.minimum((x * len(values)).astype(int), len(values) - 1)])

    def _draw(self, values: tuple[float, ...], rng: np.random.Generator, n: int) -> Array:
        share = np.asarray(values) / np.sum(values)
        return np.minimum((rng.choice(len(share), n, p=share) + rng.random(n)) / len(share), np.nextafter(1, 0))

    def f(self, x: Array) -> Array:
        return self.at(self.heights, x)

    def g(self, x: Array) -> Array:
        return self.at(self.target, x) / np.mean(self.target)

    def p(self, x: Array) -> Array:
        return self.at(self.density, x) / np.mean(self.density)

    def sample_p(self, rng: np.random.Generator, n: int) -> Array:
        return self._draw(self.density, rng, n)

    def sample_g(self, rng: np.random.Generator, n: int) -> Array:
        return self._draw(self.target, rng, n)

    def draw(self, **more: Any) -> quadrature.Samples:
        return quadrature.draw(self.f, self.g, self.p, self.sample_p, **more)

    def compare(self, **more: Any) -> quadrature.Comparison:
        return quadrature.compare(self.f, self.g, self.p, self.sample_p, **({"n": 64} | more))

    def experiment(self, **more: Any) -> quadrature.Experiment:
        return quadrature.experiment(self.f, self.g, self.p, self.sample_p, truth=np.mean(self.heights), **more)

    def predict(self, n: int, **more: Any) -> quadrature.Prediction:
        points, weights = quadrature.grid(0, 1, len(self.heights))
        return quadrature.predict(self.f, self.g, self.p, points, n=n, weights=weights, **more)


WINS = Bins((1, 2.2, 3.6, 1), (1, 2, 4, 1), (1, 1, 1, 1))  # f/F close to g
LOSES = Bins((8, 1, 1, 1), (1, 1, 4, 1), (2, 1, 1, 1))  # light where g is small, and p knows it
HALF = Bins((1, 2, 3, 4), (1, 1, 1, 1), (1, 1, 0, 0))  # p misses half of g
