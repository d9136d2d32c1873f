"""The figure of the demo: pictures side by side, parts of them magnified, and below them the errors over time."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

from .images.png import to_bytes
from .scene import FloatArray

# All lengths in inches, 100 pixels each.
COLUMN, GAP, TITLE, CURVES, MARGIN = 4.8, 0.06, 0.42, 2.3, 0.65

# What is magnified: left and upper border as shares of width and height, and the side of a square as a share of the width.
INSET = (0.40, 0.10, 0.19)
COLOURS = ("#c8553d", "#2878b5")

Curves = Mapping[str, Sequence[tuple[float, float]]]  # name -> (seconds, error)


def draw(pictures: Sequence[tuple[str, FloatArray, FloatArray]], errors: Mapping[str, Curves], exposure: float) -> bytes:
    """The bytes of a PNG: `pictures` (title, picture and its indirect specular light, (h, w, 3), all of one size), `errors` below them.

    `exposure` is that of the pictures, in EV; the indirect specular light is shown 1 EV brighter. `errors` are titles and curves.
    """
    from matplotlib.figure import Figure

    rows, columns = pictures[0][1].shape[:2]
    tall, inset = COLUMN * rows / columns, (COLUMN - GAP) / 2
    width = len(pictures) * (COLUMN + GAP) - GAP
    height = TITLE + tall + GAP + inset + TITLE + CURVES + MARGIN
    figure = Figure(figsize=(width, height), facecolor="white")

    def show(left: float, top: float, wide: float, high: float, image: FloatArray, brighter: float = 0, label: str = "") -> None:
        axes = figure.add_axes((left / width, 1 - (top + high) / height, wide / width, high / height))
        axes.imshow(to_bytes(image, exposure + brighter), aspect="auto", interpolation="nearest")
        axes.text(0.03, 0.03, label, transform=axes.transAxes, color="white", fontsize=10)
        axes.set_axis_off()

    x, y, side = INSET
    x0, y0, size = int(x * columns), int(y * rows), max(1, int(side * columns))
    inside = (slice(y0, y0 + size), slice(x0, x0 + size))
    below = TITLE + tall + GAP
    for column, (title, image, gloss) in enumerate(pictures):
        left = column * (COLUMN + GAP)
        figure.text((left + COLUMN / 2) / width, 1 - TITLE / 2 / height, title, ha="center", va="center", fontsize=14)
        show(left, TITLE, COLUMN, tall, image)
        show(left, below, inset, inset, image[inside])
        show(left + inset + GAP, below, inset, inset, gloss[inside], 1, "indirect specular light alone")

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
