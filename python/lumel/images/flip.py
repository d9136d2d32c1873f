"""FLIP, the difference that an observer perceives when flipping between two pictures (Andersson et al. 2020, 2021)."""

from __future__ import annotations

import math

import flip_evaluator
import numpy as np

from ..scene import LUMINANCE, FloatArray
from .png import to_srgb

_MOST_EXPOSURES = 16


def flip_map(image: FloatArray, reference: FloatArray, *, linear: bool = True) -> FloatArray:
    """FLIP of every pixel, float32 (h, w), 0..1, seen at 67 pixels a degree.

    `image` and `reference` are finite and linear, (h, w, 3). HDR-FLIP (the worst over exposures, ACES) where `linear`; else LDR-FLIP
    of what a screen shows at exposure 0. Values below 0 count as 0.
    """
    if linear:
        start, stop = exposures(reference)
        count = min(max(2, math.ceil(stop - start)), _MOST_EXPOSURES)
        settings = {"startExposure": start, "stopExposure": stop, "numExposures": count}
        pictures = (np.ascontiguousarray(np.maximum(p, 0), dtype=np.float32) for p in (reference, image))
        result = flip_evaluator.evaluate(*pictures, "HDR", applyMagma=False, parameters=settings)[0]
    else:
        pictures = (np.ascontiguousarray(to_srgb(p)) for p in (reference, image))
        result = flip_evaluator.evaluate(*pictures, "LDR", applyMagma=False)[0]
    return np.asarray(result, dtype=np.float32)[..., 0]


def exposures(reference: FloatArray) -> tuple[float, float]:
    """First and last exposure (EV) of HDR-FLIP: where the tone mapper takes the brightest and the median pixel to 0.85.

    The median is over lit pixels: with the usual one a picture that is half black has no last exposure at all.
    """
    luminance = reference.astype(np.float64) @ LUMINANCE
    lit = luminance[luminance > 0]
    if not lit.size:
        return 0.0, 0.0
    # Solve (a x^2 + b x) / (c x^2 + d x + e) = 0.85 for the ACES fit with its pre-exposure of 0.6.
    a, b, c, d, e = 0.6 * 0.6 * 2.51, 0.6 * 0.03, 0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14
    t = 0.85
    p, q, r = a - t * c, b - t * d, -t * e
    white = (-q + math.sqrt(q * q - 4 * p * r)) / (2 * p)
    return math.log2(white / float(lit.max())), math.log2(white / float(np.median(lit)))
