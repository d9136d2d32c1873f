"""The light in gloss, where estimators differ: the layer `indirect.specular`, and its error over the pixels that have any."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

LAYER = "indirect.specular"


def relmse(image: npt.ArrayLike, reference: npt.ArrayLike, variance: npt.ArrayLike = 0.0) -> float:
    """Mean of ((I-R)^2 - variance) / (R^2 + e) over the channels and the pixels that are not black in `reference`.

    e = 0.01 mean(R)^2, over these pixels. `image` and `reference` are (h, w, 3), W/(m2 sr); `variance`, of the same shape, is that of
    the reference: its own noise is subtracted. nan where all of the reference is black.
    """
    R = np.asarray(reference, np.float64)
    glossy = R.max(axis=-1) > 0
    if not glossy.any():
        return float("nan")
    noise = np.broadcast_to(np.asarray(variance, np.float64), R.shape)[glossy]
    R, I = R[glossy], np.asarray(image, np.float64)[glossy]  # noqa: E741
    return float(np.mean(((I - R) ** 2 - noise) / (R**2 + 0.01 * R.mean() ** 2)))
