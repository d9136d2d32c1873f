"""Matrices from `<transform>`: each step is applied after the ones before it, in world axes."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from ..scene import look_at
from .tree import Node
from .values import number, numbers, vector, xyz

Matrix = npt.NDArray[np.float64]


def translate(node: Node) -> Matrix:
    """Move by x, y, z in metres (0 where left out)."""
    matrix = np.eye(4)
    matrix[:3, 3] = xyz(node, 0.0)
    return matrix


def scale(node: Node) -> Matrix:
    """Stretch by x, y, z (1 where left out)."""
    return np.diag([*xyz(node, 1.0), 1.0])


def rotate(node: Node) -> Matrix:
    """Turn by `angle` degrees around the axis x, y, z, which may have any length."""
    axis = np.array(xyz(node, 0.0))
    length = np.linalg.norm(axis)
    if "angle" not in node.attributes:
        raise ValueError("lacks the attribute 'angle'")
    if not length > 0:
        raise ValueError("has a rotation axis of length 0")
    x, y, z = axis / length
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    angle = math.radians(number(node.attributes["angle"]))
    matrix = np.eye(4)
    matrix[:3, :3] += math.sin(angle) * cross + (1 - math.cos(angle)) * (cross @ cross)
    return matrix


def matrix(node: Node) -> Matrix:
    """16 numbers, row by row, or 9 for the upper left part."""
    values = numbers(node.value)
    if len(values) not in (9, 16):
        raise ValueError(f"has 9 or 16 numbers, not {len(values)}")
    result = np.eye(4)
    side = math.isqrt(len(values))
    result[:side, :side] = np.reshape(values, (side, side))
    if not np.array_equal(result[3], [0, 0, 0, 1]):
        raise ValueError("has a last row other than 0 0 0 1")
    return result


def lookat(node: Node) -> Matrix:
    """Place at `origin`, facing `target` with +z; `up` may be left out."""
    for name in ("origin", "target"):
        if name not in node.attributes:
            raise ValueError(f"lacks the attribute '{name}'")
    origin, target = (vector(node.attributes[name]) for name in ("origin", "target"))
    up = vector(node.attributes.get("up", "0 0 0"))
    if not any(up):
        up = _some_up(np.subtract(target, origin))
    return look_at(origin, target, up)


def _some_up(view: Matrix) -> tuple[float, float, float]:
    """A direction across `view` (Duff et al. 2017, the first tangent), so that cameras without `up` stand as in Mitsuba."""
    length = float(np.linalg.norm(view))
    x, y, z = (view / length).tolist() if length > 0 else (0.0, 0.0, 1.0)
    sign = math.copysign(1.0, z)
    a = -1.0 / (sign + z)
    return 1.0 + sign * x * x * a, sign * x * y * a, -sign * x


STEPS: dict[str, Callable[[Node], Matrix]] = {
    "translate": translate,
    "scale": scale,
    "rotate": rotate,
    "matrix": matrix,
    "lookat": lookat,
}


def is_usable(matrix: Matrix) -> bool:
    """Whether the matrix can be inverted, and keeps space within the range of numbers."""
    linear = matrix[:3, :3]
    if not np.abs(matrix).max() <= 1e30:
        return False
    lengths = np.linalg.norm(linear, axis=0)
    return bool(lengths.min() >= 1e-30) and bool(abs(np.linalg.det(linear / lengths)) >= 1e-9)
