"""A picture with named layers, as it lies in a file."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from ..scene import FloatArray


@dataclass(frozen=True, eq=False)
class Picture:
    """`layers` by name: float32 (h, w, 3) for colours and vectors, (h, w) for scalars; `metadata`: text that the file carries;
    `linear` is False where the values were stored for a screen (PNG), that is clipped to 0..1 and rounded to 8 bits."""

    layers: dict[str, FloatArray]
    metadata: Mapping[str, str] = field(default_factory=dict)
    linear: bool = True
