"""Error over time as a picture."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path


def draw(curves: Mapping[str, Sequence[tuple[float, float]]], title: str, targets: Sequence[float], file: Path) -> None:
    """Write a PNG of relMSE over seconds, both logarithmic; `targets` are dotted lines."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    axes = figure.add_subplot()
    for label, curve in curves.items():
        shown = [(seconds, error) for seconds, error in curve if error > 0]
        axes.loglog(*zip(*shown, strict=True), marker="o", markersize=3, label=label) if shown else None
    for target in targets:
        axes.axhline(target, color="grey", linestyle=":", linewidth=1)
    axes.set(xlabel="time from when the files are read, s", ylabel="relMSE less the reference's noise", title=title)
    axes.grid(visible=True, which="both", alpha=0.2)
    axes.legend()
    figure.savefig(file, dpi=120)
