"""Pictures to hold others against: the mean of two long runs with seeds of their own, whose difference tells how much noise is left."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import gloss
from ..result import Result
from ..scene import FloatArray
from .lab import BUST, Lab

SEEDS = (1001, 1002)  # of the two runs; none of the runs that are judged has one of these
GATHERED = 32.0


@dataclass(frozen=True)
class Reference:
    """`image` and `light` (the layer in gloss) are (h, w, 3), W/(m2 sr), each with its variance."""

    image: FloatArray
    image_variance: FloatArray
    light: npt.NDArray[np.float64]
    variance: npt.NDArray[np.float64]
    made: str

    def error(self, result: Result) -> float:
        """relMSE of the light in gloss on the pixels that have any, less the noise of the reference."""
        return self.error_of_light(result.layer(gloss.LAYER))

    def error_of_light(self, light: FloatArray) -> float:
        """The same of a layer, (h, w, 3)."""
        return gloss.relmse(light, self.light, self.variance)

    def error_of_picture(self, result: Result) -> float:
        """relMSE of the whole picture, less the noise of the reference."""
        R = self.image.astype(np.float64)
        return float(np.mean(((result.image() - R) ** 2 - self.image_variance) / (R**2 + 0.01 * R.mean() ** 2)))

    @property
    def noise(self) -> float:
        """The noise that the reference still has, as relMSE: it is subtracted from all errors."""
        return -gloss.relmse(self.light, self.light, self.variance)

    def ratio(self, result: Result) -> float:
        """Mean light in gloss, over that of the reference."""
        return float(result.layer(gloss.LAYER).mean(dtype=np.float64) / self.light.mean())


def mean_of(made: str, first: Result, second: Result) -> Reference:
    """The mean of two independent runs; a quarter of their squared difference is its variance."""
    a, b = (np.asarray(r.layer(gloss.LAYER), np.float64) for r in (first, second))
    image, other = first.image(), second.image()
    return Reference((image + other) / 2, (image - other) ** 2 / 4, (a + b) / 2, (a - b) ** 2 / 4, made)


def mean_time(runs: Iterable[Result]) -> float:
    """Mean of the seconds that renders took."""
    return float(np.mean([float(str(run.stats["time"])) for run in runs]))


def make(lab: Lab, scene: str, seconds: float, **settings: Any) -> Reference:
    """Two runs of `auto` that share `seconds`, with many gathering rays."""
    settings = {"estimator": "auto", "gather": GATHERED, **settings}
    runs = [lab.render(scene, time=seconds / 2, seed=seed, **settings) for seed in SEEDS]
    taken = sum(float(str(run.stats["time"])) for run in runs)
    made = f"two runs of `auto` with `--gather {settings['gather']:g}` and seeds {SEEDS[0]} and {SEEDS[1]}, {taken:.1f} s together"
    reference = mean_of(made, *runs)
    lab.check_lit(scene, float(reference.light.mean()))
    return reference


def of_bust(lab: Lab) -> Reference:
    """The reference of the pictures of the bust. Takes the time of the work `reference`."""

    def begin() -> Reference:
        lab.begin("reference pictures")
        return make(lab, BUST, lab.budget.take("reference"))

    return lab.once("reference", begin)
