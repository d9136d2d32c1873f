"""Clay for sculpting: implicit solids and the ways to blend them.

A solid is a function of points (n, 3) that is negative inside, positive outside and close to the distance near the surface.
Each function here takes points and returns such values (n,), all float64, in the unit of the points.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import numpy.typing as npt

Points = npt.NDArray[np.float64]
Values = npt.NDArray[np.float64]
Field = Callable[[Points], Values]
Vec = tuple[float, float, float]


def _length(q: Points) -> Values:
    return np.asarray(np.sqrt(np.einsum("ij,ij->i", q, q)))


def ellipsoid(p: Points, center: Vec, radii: Vec, turn: npt.NDArray[np.float64] | None = None) -> Values:
    """An ellipsoid with half axes `radii`, turned by the rotation matrix `turn`. Near the surface it is the distance to first order."""
    q = p - np.asarray(center)
    if turn is not None:
        q = q @ turn  # rows are points, so this applies the inverse rotation
    q = q / np.asarray(radii)
    k0, k1 = _length(q), _length(q / np.asarray(radii))
    # At the very centre both lengths vanish; the smallest radius is then the distance to the surface.
    return np.where(k1 > 1e-9, k0 * (k0 - 1) / np.maximum(k1, 1e-9), -min(radii))


def ball(p: Points, center: Vec, radius: float) -> Values:
    """A sphere."""
    q = p - np.asarray(center)
    return _length(q) - radius


def limb(p: Points, a: Vec, b: Vec, ra: float, rb: float) -> Values:
    """A round bone from `a` to `b` whose radius goes from `ra` to `rb`."""
    start, along = np.asarray(a), np.asarray(b) - np.asarray(a)
    q = p - start
    h = np.clip(q @ along / (along @ along), 0.0, 1.0)
    q = q - h[:, None] * along
    return np.asarray(_length(q) - (ra + h * (rb - ra)))


def arc(p: Points, points: tuple[Vec, ...], radii: tuple[float, ...]) -> Values:
    """A chain of limbs through `points`: an eyelid, a lip, a clavicle."""
    pieces = [limb(p, a, b, ra, rb) for (a, b), (ra, rb) in zip(pairwise(points), pairwise(radii), strict=True)]
    return np.asarray(np.minimum.reduce(pieces))


def ring(p: Points, center: Vec, axis: Vec, radius: float, thickness: float) -> Values:
    """A torus about `axis` (any length) through `center`; `thickness` is the radius of its tube."""
    q = p - np.asarray(center)
    n = np.asarray(axis) / np.linalg.norm(axis)
    height = q @ n
    around = _length(q - height[:, None] * n)
    return np.asarray(np.hypot(around - radius, height) - thickness)


def join(a: Values, b: Values, k: float) -> Values:
    """The union, with a fillet about `k` wide where the two meet."""
    h = np.maximum(k - np.abs(a - b), 0.0) / k
    return np.asarray(np.minimum(a, b) - h * h * k / 4)


def cut(a: Values, b: Values, k: float) -> Values:
    """`a` without `b`, with an edge rounded over `k`."""
    return -join(-a, b, k)


def common(a: Values, b: Values, k: float) -> Values:
    """What is inside both, with an edge rounded over `k`."""
    return -join(-a, -b, k)


def fade(t: Values, lo: float, hi: float) -> Values:
    """0 below `lo`, 1 above `hi` (or the other way round where hi < lo), smooth between."""
    s = np.clip((t - lo) / (hi - lo), 0.0, 1.0)
    return np.asarray(s * s * (3 - 2 * s))


def rotation(axis: Vec, degrees: float) -> npt.NDArray[np.float64]:
    """The (3, 3) matrix of a turn by `degrees` about `axis` (any length), counter-clockwise seen from its tip."""
    x, y, z = np.asarray(axis) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = np.radians(degrees)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross)


def probe(field: Field, p: Points, step: Values) -> tuple[Values, Points]:
    """Values (n,) and unit gradients (n, 3) of the field as seen through a tetrahedron of half width `step` (n,) about each point.

    Detail finer than `step` is smoothed away.
    """
    value, slope = np.zeros(len(p)), np.zeros_like(p)
    for corner in np.array([(1.0, -1.0, -1.0), (-1.0, -1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, 1.0, 1.0)]):
        sample = field(p + step[:, None] * corner)
        value += sample / 4
        slope += sample[:, None] * corner
    return value, np.asarray(slope / np.maximum(np.linalg.norm(slope, axis=1, keepdims=True), 1e-12))
