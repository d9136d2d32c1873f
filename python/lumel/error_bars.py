"""How far off the pictures are: what their error bars come to, and how much they still change."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from . import _core
from .scene import FloatArray

Doubles = npt.NDArray[np.float64]


def errors(session: _core.Session, cameras: int) -> tuple[float, float]:
    """Those of the pictures of all `cameras`."""
    return errors_of([session.layers(camera) for camera in range(cameras)])


def errors_of(pictures: Sequence[Mapping[str, FloatArray]]) -> tuple[float, float]:
    """Relative error sqrt(mean(stderr^2 / (I^2 + e))), e = 0.01 mean(I)^2, over all pictures, given by their layers, that are not black:
    of the solution and of the eye."""
    parts = []
    for layers in pictures:
        scale = _scale(_picture(layers))
        if not np.any(scale > 0):
            continue
        solution = layers["stderr.solution"].astype(np.float64) ** 2
        total = layers["stderr"].astype(np.float64) ** 2
        parts.append((np.mean(solution / scale), np.mean(np.maximum(total - solution, 0) / scale)))
    if not parts:
        return 0.0, 0.0
    solved, seen = np.mean(parts, axis=0)
    return math.sqrt(solved), math.sqrt(seen)


def pictures(session: _core.Session, cameras: int) -> list[Doubles]:
    """The pictures of all `cameras`, each (height, width, 3), W/(m2 sr)."""
    return [_picture(session.layers(camera)) for camera in range(cameras)]


def squared_difference(before: Sequence[Doubles], after: Sequence[Doubles]) -> float:
    """Mean of (B-A)^2 / (A^2 + e), e = 0.01 mean(A)^2, over all pictures B and A, `before` and `after`, that are not black; infinite where
    all are."""
    parts = []
    for b, a in zip(before, after, strict=True):
        scale = _scale(a)
        if np.any(scale > 0):
            parts.append(np.mean((b - a) ** 2 / scale))
    return float(np.mean(parts)) if parts else math.inf


def _picture(layers: Mapping[str, FloatArray]) -> Doubles:
    names = ("emission", "direct", "indirect.diffuse", "indirect.specular")
    return np.asarray(np.sum([layers[name] for name in names], axis=0, dtype=np.float64))


def _scale(picture: Doubles) -> Doubles:
    return np.asarray(picture**2 + 0.01 * np.mean(picture) ** 2)
