"""Pictures for the report: exposed so that they can be seen, in part, or as maps of their errors."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
from PIL import Image, ImageDraw

from ..images.png import encode_bytes, encode_png, to_bytes
from ..scene import LUMINANCE, FloatArray
from .figure import Picture

BRIGHT = 0.97  # quantile of the lit pixels
SHOWN_AS = 0.8  # linear value of that quantile on the screen
LARGEST_GAIN = 20.0  # EV
PART = 0.28  # of the width and of the height, the side of a magnified part
CELLS = 60  # along the shorter side, of which the detail of a picture is measured
FULL_COLOUR = 1.0  # relative error

Part = tuple[slice, slice]


def exposure_for(image: npt.ArrayLike) -> float:
    """The exposure (EV) that shows the bright parts of `image` (h, w, 3) bright, and 0 for a black one."""
    luminance = np.asarray(image, np.float64) @ LUMINANCE
    lit = luminance[luminance > 0]
    return float(np.clip(np.log2(SHOWN_AS / np.quantile(lit, BRIGHT)), -LARGEST_GAIN, LARGEST_GAIN)) if lit.size else 0.0


def shown(name: str, image: FloatArray, exposure: float, label: str, alt: str) -> Picture:
    """`image` (h, w, 3), linear, at `exposure` (EV)."""
    height, width = image.shape[:2]
    return Picture(name, label, alt, encode_png(np.asarray(image, np.float32), exposure=exposure), (width, height))


def ringed(name: str, image: FloatArray, at: tuple[float, float], radius: float, label: str, alt: str) -> Picture:
    """`image` (h, w, 3), linear, with a ring around the pixel `at` (x, y), whose radius is a share of the width."""
    height, width = image.shape[:2]
    picture = Image.fromarray(to_bytes(image, exposure_for(image)), "RGB")
    draw, size = ImageDraw.Draw(picture), max(2.0, radius * width)
    box = [at[0] - size, at[1] - size, at[0] + size, at[1] + size]
    draw.ellipse(box, outline="black", width=3)
    draw.ellipse(box, outline="white", width=1)
    return Picture(name, label, alt, encode_bytes(np.asarray(picture)), (width, height))


def part_with_detail(light: npt.ArrayLike) -> Part:
    """The part of a picture (h, w, 3) in which it varies most, noise of single pixels apart."""
    luminance = np.asarray(light, np.float64) @ LUMINANCE
    bounded = np.sqrt(np.clip(luminance, 0, np.quantile(luminance, 0.98)))  # not where one pixel is bright
    # Means of cells hide noise.
    cell = max(1, min(bounded.shape) // CELLS)
    h, w = (side // cell for side in bounded.shape)
    means = bounded[: h * cell, : w * cell].reshape(h, cell, w, cell).mean(axis=(1, 3))
    detail = np.hypot(*np.gradient(means)) if min(means.shape) > 1 else means
    # A table of sums tells that of every window.
    sums = np.pad(detail.cumsum(axis=0).cumsum(axis=1), ((1, 0), (1, 0)))
    rows, columns = (max(1, round(PART * side)) for side in detail.shape)
    inside = sums[rows:, columns:] - sums[:-rows, columns:] - sums[rows:, :-columns] + sums[:-rows, :-columns]
    top, left = (int(i) for i in np.unravel_index(np.argmax(inside), inside.shape))
    return slice(top * cell, (top + rows) * cell), slice(left * cell, (left + columns) * cell)


def magnified(name: str, light: npt.ArrayLike, part: Part, exposure: float, of: str) -> Picture:
    """A part of the light in gloss, (h, w, 3), of an estimator or the reference."""
    cut = np.asarray(light, np.float32)[part]
    return shown(name, cut, exposure, f"{of}: light in gloss, magnified", f"light in gloss of {of}, magnified")


def error_map(name: str, light: npt.ArrayLike, reference: npt.ArrayLike, label: str, alt: str) -> Picture:
    """Signed errors of luminance, (I-R) / sqrt(R^2 + e): red is too bright, blue too dark, both in full at FULL_COLOUR; grey has no such
    light."""
    from matplotlib import colormaps

    R = np.asarray(reference, np.float64)
    glossy = R.max(axis=-1) > 0
    I, R = np.asarray(light, np.float64) @ LUMINANCE, R @ LUMINANCE  # noqa: E741
    e = 0.01 * R[glossy].mean() ** 2
    relative = np.clip((I - R) / np.sqrt(R**2 + e) / FULL_COLOUR, -1, 1)
    pixels = np.asarray(colormaps["RdBu_r"]((relative + 1) / 2, bytes=True))[..., :3].copy()
    pixels[~glossy] = 128
    return Picture(name, label, alt, encode_bytes(pixels), (pixels.shape[1], pixels.shape[0]))
