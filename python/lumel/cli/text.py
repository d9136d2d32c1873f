"""Numbers as people read them, and as scripts do."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any


def si(value: float) -> str:
    """`3.21 M`: three digits and a prefix."""
    for factor, prefix in ((1e12, " T"), (1e9, " G"), (1e6, " M"), (1e3, " k")):
        if abs(value) >= 0.9995 * factor:
            return f"{value / factor:.3g}{prefix}"
    return f"{value:.3g} "


def count(value: float, noun: str) -> str:
    """`3.21 M rays`, `12 rays`."""
    return f"{si(value).strip()} {noun}"


def seconds(value: float) -> str:
    """`4.2 s`, `3 min 05 s`; `?` where unknown."""
    if not math.isfinite(value):
        return "?"
    if value < 60:
        return f"{value:.1f} s"
    minutes, rest = divmod(round(value), 60)
    return f"{minutes} min {rest:02d} s" if minutes < 60 else f"{minutes // 60} h {minutes % 60:02d} min"


def error(value: float) -> str:
    """`1.2 %`; `?` where unknown."""
    return f"{100 * value:.3g} %" if math.isfinite(value) else "?"


def rgb(values: Sequence[float]) -> str:
    """`1 0.5 0.25`."""
    return " ".join(f"{value:.4g}" for value in values)


def to_json(value: object, indent: int | None = None) -> str:
    """JSON with null for every number that is not finite, which JSON cannot say."""
    return json.dumps(_finite(value), indent=indent, allow_nan=False)


def _finite(value: Any) -> Any:
    match value:
        case float():
            return value if math.isfinite(value) else None
        case Mapping():
            return {key: _finite(part) for key, part in value.items()}
        case list() | tuple():
            return [_finite(part) for part in value]
        case _:
            return value
