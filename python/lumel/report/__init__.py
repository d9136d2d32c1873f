"""The report: the figures of the paper and of ours, measured here and now, on one page. FIGURES is its table of contents.

A figure is a module with `make(lab)`, which gives a Figure, and WORKS: the works that it takes time for, and about how many seconds each
takes in a report of default length. Works of one name are done once, whichever figures need them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from . import coverage, figure2, figure4, figure5, figure6, hits, roughness, transports
from .figure import Figure
from .lab import Lab


@dataclass(frozen=True)
class Entry:
    """A figure to make, and the weights of its works."""

    make: Callable[[Lab], Figure]
    works: Mapping[str, float]


FIGURES: Mapping[str, Entry] = {
    "figure2": Entry(figure2.make, figure2.WORKS),
    "figure4": Entry(figure4.make, figure4.WORKS),
    "figure5": Entry(figure5.make, figure5.WORKS),
    "figure6": Entry(figure6.make, figure6.WORKS),
    "transports": Entry(transports.make, transports.WORKS),
    "roughness": Entry(roughness.make, roughness.WORKS),
    "hits": Entry(hits.make, hits.WORKS),
    "coverage": Entry(coverage.make, coverage.WORKS),
}
