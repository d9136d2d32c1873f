"""What a figure of the report is made of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

Cell = str | float | int


@dataclass(frozen=True)
class Picture:
    """A PNG: `name` is that of its file without ending, `label` stands below it, `alt` in its place."""

    name: str
    label: str
    alt: str
    png: bytes
    size: tuple[int, int]  # pixels


@dataclass(frozen=True)
class Curve:
    """An SVG: `alt` says what it shows."""

    name: str
    alt: str
    svg: str


@dataclass(frozen=True)
class Table:
    """Numbers, written as CSV too; a cell that is nan stands for what could not be measured."""

    name: str
    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True)
class Figure:
    """One figure: `shows` says what is seen and how it was made, `claim` what paper and theory say of it, `found` what was measured.

    Words between `backquotes` are code; line breaks mean nothing. `pictures` come in rows of `columns`.
    """

    title: str
    scene: str
    shows: str
    claim: str
    found: Sequence[str]
    pictures: Sequence[Picture] = ()
    columns: int = 3
    curves: Sequence[Curve] = ()
    tables: Sequence[Table] = ()


def gain(classical: float, other: float) -> float:
    """How many times the mean square error of `classical` is that of another; nan where the noise of the truth hides one of them."""
    return classical / other if classical > 0 and other > 0 else math.nan


def times(gain: float) -> str:
    """`4.39 times`."""
    return f"{gain:.3g} times" if math.isfinite(gain) else "an unknown number of times"


def span(gains: Sequence[float]) -> str:
    """`1.2 to 9.1`, of those that are known."""
    known = [gain for gain in gains if math.isfinite(gain)]
    return f"{min(known):.3g} to {max(known):.3g}" if known else "unknown"
