"""Numbers, colours and vectors from the text of XML attributes.

Every function raises ValueError that says what was found and what is allowed.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import TypeAlias, TypeVar

from ..scene import Rgb
from .tree import Node

_T = TypeVar("_T")
Parser: TypeAlias = Callable[[Node], _T]


class UnsupportedError(ValueError):
    """The value is allowed by the format, but lumel does not read it."""


_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", re.ASCII)
_LARGEST = 1e30  # what a float32 holds, with room for a product with a size in metres
_SMALLEST = 1e-30

# A constant spectrum seen as linear Rec.709 RGB: equal energy at all wavelengths is not the white of that space.
EQUAL_ENERGY: Rgb = (1.20479398, 0.948291, 0.90891603)


def number(text: str) -> float:
    """A finite number; those too small for a float32 are 0."""
    text = text.strip()
    if not _NUMBER.fullmatch(text):
        raise ValueError(f"'{text[:40]}' is not a finite number")
    value = float(text)
    if abs(value) > _LARGEST:
        raise ValueError(f"{text[:40]} is out of range, at most {_LARGEST:g} is allowed")
    return value if abs(value) >= _SMALLEST else 0.0


def numbers(text: str) -> list[float]:
    """Numbers with commas or blanks between them."""
    return [number(word) for word in re.split(r"[\s,]+", text) if word]


def rgb(text: str) -> Rgb:
    """A colour: one number (grey), three (linear Rec.709), or `#rrggbb` (sRGB, made linear)."""
    text = text.strip()
    if text.startswith("#"):
        if not re.fullmatch(r"#[0-9a-fA-F]{6}", text):
            raise ValueError(f"'{text[:40]}' is not a colour, such as #80c0ff")
        red, green, blue = (_linear(int(text[i : i + 2], 16) / 255) for i in (1, 3, 5))
        return red, green, blue
    values = numbers(text)
    if len(values) == 1:
        values *= 3
    if len(values) != 3:
        raise ValueError(f"a colour has 1 or 3 numbers, not {len(values)}: '{text[:40]}'")
    return values[0], values[1], values[2]


def _linear(encoded: float) -> float:
    return encoded / 12.92 if encoded <= 0.04045 else math.pow((encoded + 0.055) / 1.055, 2.4)


def vector(text: str) -> Rgb:
    """Three numbers."""
    values = numbers(text)
    if len(values) != 3:
        raise ValueError(f"needs 3 numbers, not {len(values)}: '{text[:40]}'")
    return values[0], values[1], values[2]


def xyz(node: Node, missing: float | None) -> Rgb:
    """The vector in `value` (3 numbers, or 1 for all) or in `x`, `y`, `z`; `missing` stands for those left out (None: not allowed)."""
    given = [axis for axis in "xyz" if axis in node.attributes]
    if "value" in node.attributes:
        if given:
            raise ValueError(f"has both 'value' and '{given[0]}'")
        values = numbers(node.value)
        return vector(node.value) if len(values) != 1 else (values[0], values[0], values[0])
    absent = [axis for axis in "xyz" if axis not in node.attributes]
    if absent and missing is None:
        raise ValueError(f"lacks {', '.join(absent)}")
    x, y, z = (number(node.attributes[axis]) if axis in node.attributes else missing or 0.0 for axis in "xyz")
    return x, y, z
