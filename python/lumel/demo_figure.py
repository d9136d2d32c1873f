"""The figure of the demo: pictures side by side, parts of them magnified, and below them the errors over time."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

from .images.png import to_bytes
from .scene import FloatArray

# All lengths in inches, 100 pixels each.
COLUMN, GAP, TITLE, CURVES, MARGIN = 4.8, 0.06, 0.42, 2.3, 0.65

# What is magnified: left and upper border as shares of width and height, and the side of a square as a share of the width.
INSETS = ((0.40, 0.10, 0.19), (0.35, 0.50, 0.26))
COLOURS = ("#c8553d", "#2878b5")

Curves = Mapping[str, Sequence[tuple[float, float]]]  # name -> (seconds, error)


def draw(pictures: Sequence[tuple[str, FloatArray]], errors: Mapping[str, Curves], exposure: float) -> bytes:
    """The bytes of a PNG: `pictures` (title and (h, w, 3), of one size) with `exposure` in EV, below them `errors` (title and curves)."""
    from matplotlib.figure import Figure

    rows, columns = pictures[0][1].shape[:2]
    tall, inset = COLUMN * rows / columns, (COLUMN - GAP) / len(INSETS)
    width = len(pictures) * (COLUMN + GAP) - GAP
    height = TITLE + tall + GAP + inset + TITLE + CURVES + MARGIN
    figure = Figure(figsize=(width, height), facecolor="white")

    def show(left: float, top: float, wide: float, high: float, image: FloatArray) -> None:
        axes = figure.add_axes((left / width, 1 - (top + high) / height, wide / width, high / height))
        axes.imshow(to_bytes(image, exposure), aspect="auto", interpolation="nearest")
        axes.set_axis_off()

    for column, (title, image) in enumerate(pictures):
        left = column * (COLUMN + GAP)
        figure.text((left + COLUMN / 2) / width, 1 - TITLE / 2 / height, title, ha="center", va="center", fontsize=14)
        show(left, TITLE, COLUMN, tall, image)
        for i, (x, y, side) in enumerate(INSETS):
            x0, y0, size = int(x * columns), int(y * rows), max(1, int(side * columns))
            show(left + i * (inset + GAP), TITLE + tall + GAP, inset, inset, image[y0 : y0 + size, x0 : x0 + size])

    room = width / len(errors)
    for i, (title, curves) in enumerate(errors.items()):
        axes = figure.add_axes(((i * room + MARGIN) / width, MARGIN / height, (room - 1.5 * MARGIN) / width, CURVES / height))
        for colour, (name, points) in zip(COLOURS, curves.items(), strict=False):
            axes.loglog(*zip(*points, strict=True), "o-", color=colour, label=name, linewidth=2)
        axes.set_title(title, fontsize=12)
        axes.set_xlabel("time, s")
        axes.set_xticks(*_ticks(curves))
        axes.minorticks_off()
        axes.grid(visible=True, axis="y", alpha=0.3)
        axes.spines[["top", "right"]].set_visible(False)
        axes.legend(frameon=False)

    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    return buffer.getvalue()


def _ticks(curves: Curves) -> tuple[list[float], list[str]]:
    """The times that were measured, and how they are written."""
    times = sorted({seconds for points in curves.values() for seconds, _ in points})
    return times, [f"{seconds:g}" for seconds in times]
