"""How far a picture is from its reference: relMSE with the reference's own noise, RMSE, FLIP, mean ratio."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np
import numpy.typing as npt

from ..scene import FloatArray
from .files import ImageError
from .flip import flip_map

BLOCK = 8
_Doubles = npt.NDArray[np.float64]


@dataclasses.dataclass(frozen=True, eq=False)
class Comparison:
    """What `compare` found. All errors are over the pixels that are finite in both pictures; nan means undefined.

    relMSE = mean over pixels and channels of (I-R)^2 / (R^2 + e), e = 0.01 mean(R)^2. A noise is the relMSE that the standard
    errors alone explain, mean of stderr^2 / (R^2 + e). `..._8x8` are the same of the means of 8x8 pixels, where noise cancels
    and bias stays. None: there is no stderr layer to compute it from.
    """

    width: int
    height: int
    relmse: float
    reference_noise: float | None
    image_noise: float | None
    relmse_without_noise: float | None  # relmse - reference_noise; slightly below 0 by chance where the pictures agree
    relmse_8x8: float
    reference_noise_8x8: float | None
    relmse_8x8_without_noise: float | None
    rmse: float
    flip: float  # mean over pixels, 0..1; pixels that are not finite count as black
    mean_ratio: float  # sum of I over sum of R
    mean_ratio_rgb: tuple[float, float, float]
    nonfinite_image: int  # pixels with a nan or infinite channel
    nonfinite_reference: int
    flip_map: FloatArray  # (h, w)

    def to_dict(self) -> dict[str, Any]:
        """All numbers by name, without the map."""
        return {field.name: getattr(self, field.name) for field in dataclasses.fields(self) if field.name != "flip_map"}


def compare(
    image: npt.ArrayLike,
    reference: npt.ArrayLike,
    image_stderr: npt.ArrayLike | None = None,
    reference_stderr: npt.ArrayLike | None = None,
    *,
    linear: bool = True,
) -> Comparison:
    """Compare linear pictures of equal shape (h, w, 3). `linear=False` takes FLIP as a screen would show them (see `flip_map`).

    Raises ImageError where shapes differ or no pixel is finite in both.
    """
    I, R = (np.asarray(picture, dtype=np.float64) for picture in (image, reference))  # noqa: E741
    _check_shapes(I, R)
    good = np.isfinite(I).all(axis=-1) & np.isfinite(R).all(axis=-1)
    if not good.any():
        raise ImageError("no pixel is finite in both pictures: nothing to compare")
    e = 0.01 * R[good].mean() ** 2
    weight = R**2 + e
    image_variance, reference_variance = (_variance(stderr, R.shape) for stderr in (image_stderr, reference_stderr))
    coarse_I, coarse_R, count = _block_means(I, good), _block_means(R, good), _block_counts(good)
    coarse_weight = coarse_R**2 + e
    relmse = _mean_ratio((I - R)[good] ** 2, weight[good])
    relmse_8x8 = _mean_ratio((coarse_I - coarse_R) ** 2, coarse_weight)
    noise = _noise(reference_variance, weight, good)
    noise_8x8 = None
    if reference_variance is not None:
        noise_8x8 = _mean_ratio(_block_means(reference_variance, good) / count[:, None], coarse_weight)
    flips = flip_map(*(np.where(good[..., None], picture, 0).astype(np.float32) for picture in (I, R)), linear=linear)
    ratios = [_divide(I[good][:, c].sum(), R[good][:, c].sum()) for c in range(3)]
    return Comparison(
        width=R.shape[1],
        height=R.shape[0],
        relmse=relmse,
        reference_noise=noise,
        image_noise=_noise(image_variance, weight, good),
        relmse_without_noise=None if noise is None else relmse - noise,
        relmse_8x8=relmse_8x8,
        reference_noise_8x8=noise_8x8,
        relmse_8x8_without_noise=None if noise_8x8 is None else relmse_8x8 - noise_8x8,
        rmse=math.sqrt(np.mean((I - R)[good] ** 2)),
        flip=float(flips.mean()),
        mean_ratio=_divide(I[good].sum(), R[good].sum()),
        mean_ratio_rgb=(ratios[0], ratios[1], ratios[2]),
        nonfinite_image=int((~np.isfinite(I).all(axis=-1)).sum()),
        nonfinite_reference=int((~np.isfinite(R).all(axis=-1)).sum()),
        flip_map=flips,
    )


def _check_shapes(image: _Doubles, reference: _Doubles) -> None:
    for name, picture in (("image", image), ("reference", reference)):
        if picture.ndim != 3 or picture.shape[2] != 3:
            raise ImageError(f"the {name} must have shape (h, w, 3), found {picture.shape}")
    if image.shape != reference.shape:
        sizes = [f"{picture.shape[1]}x{picture.shape[0]}" for picture in (image, reference)]
        raise ImageError(f"the image has {sizes[0]} pixels, the reference {sizes[1]}: they must have the same size")


def _variance(stderr: npt.ArrayLike | None, shape: tuple[int, ...]) -> _Doubles | None:
    """Squared standard errors; one that is not finite says nothing and counts as 0."""
    if stderr is None:
        return None
    values = np.asarray(stderr, dtype=np.float64)
    if values.shape != shape:
        raise ImageError(f"the stderr layer has shape {values.shape}, its picture {shape}")
    return np.asarray(np.where(np.isfinite(values), values, 0.0) ** 2, dtype=np.float64)


def _noise(variance: _Doubles | None, weight: _Doubles, good: npt.NDArray[np.bool_]) -> float | None:
    return None if variance is None else _mean_ratio(variance[good], weight[good])


def _block_counts(good: npt.NDArray[np.bool_]) -> _Doubles:
    """Good pixels of each block that has any, (n,); blocks at the right and lower border may be smaller."""
    count = _block_sums(good.astype(np.float64))
    return count[count > 0]


def _block_means(values: _Doubles, good: npt.NDArray[np.bool_]) -> _Doubles:
    """Means over the good pixels of each block that has any, (n, 3)."""
    count = _block_sums(good.astype(np.float64))
    sums = _block_sums(np.where(good[..., None], values, 0.0))
    return np.asarray(sums[count > 0] / count[count > 0][:, None], dtype=np.float64)


def _block_sums(values: _Doubles) -> _Doubles:
    rows = np.add.reduceat(values, np.arange(0, values.shape[0], BLOCK), axis=0)
    return np.add.reduceat(rows, np.arange(0, values.shape[1], BLOCK), axis=1)


def _mean_ratio(numerator: _Doubles, denominator: _Doubles) -> float:
    """Mean of the quotients; nan against a reference that is black all over."""
    return float(np.mean(numerator / denominator)) if np.all(denominator > 0) else math.nan


def _divide(a: float, b: float) -> float:
    return float(a / b) if b else math.nan
