"""What the error bars of the pictures come to."""

from __future__ import annotations

import math

import numpy as np

from . import _core


def errors(session: _core.Session, cameras: int) -> tuple[float, float]:
    """Relative error sqrt(mean(stderr^2 / (I^2 + e))), e = 0.01 mean(I)^2, over all `cameras`: of the solution and of the eye."""
    parts = []
    for camera in range(cameras):
        layers = session.layers(camera)
        image = sum(layers[name].astype(np.float64) for name in ("emission", "direct", "indirect.diffuse", "indirect.specular"))
        scale = image**2 + 0.01 * np.mean(image) ** 2
        if not np.any(scale > 0):
            return 0.0, 0.0
        solution = layers["stderr.solution"].astype(np.float64) ** 2
        total = layers["stderr"].astype(np.float64) ** 2
        parts.append((np.mean(solution / scale), np.mean(np.maximum(total - solution, 0) / scale)))
    solved, seen = np.mean(parts, axis=0)
    return math.sqrt(solved), math.sqrt(seen)
