"""How curves look: matplotlib's axes, and SVG that takes the colour of the text around it."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Readable on white and on black; told apart by those who see few colours (after Okabe and Ito), and by their marks.
COLOURS = {"classical": "#d55e00", "weighted": "#0072b2", "regression": "#cc79a7", "auto": "#009e73"}
MARKS = {"classical": "o", "weighted": "s", "regression": "^", "auto": "D"}
INK = "#010203"  # stands for the colour of the text in the page
PANEL = (5.2, 3.6)  # inches
_STYLE = {
    "svg.fonttype": "none",
    "svg.hashsalt": "lumel",
    "font.family": "sans-serif",
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.edgecolor": INK,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "xtick.color": INK,
    "ytick.color": INK,
    "text.color": INK,
    "grid.color": INK,
    "grid.alpha": 0.13,
    "legend.frameon": False,
    "lines.linewidth": 1.8,
    "lines.markersize": 4.5,
}


@contextmanager
def panels(titles: Sequence[str], *, share_y: bool = False) -> Iterator[tuple[Figure, Sequence[Axes]]]:
    """A figure with one panel beside the other, each with its title, in the style of the report; `to_svg` must be called inside."""
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    with rc_context(_STYLE):  # type: ignore[arg-type]  # keys of matplotlib, which it knows as literals
        figure = Figure(figsize=(PANEL[0] * len(titles), PANEL[1]), layout="constrained")
        axes = figure.subplots(1, len(titles), squeeze=False, sharey=share_y)[0]
        for panel, title in zip(axes, titles, strict=True):
            panel.set_title(title)
            panel.grid(visible=True)
            panel.spines[["top", "right"]].set_visible(False)
        yield figure, list(axes)


def line(axes: Axes, x: npt.ArrayLike, y: npt.ArrayLike, name: str, *, error: npt.ArrayLike | None = None, marks: bool = True) -> None:
    """A labelled curve in the colour of the estimator `name`; `error` is one standard error of `y`, drawn as a band."""
    x, y = np.asarray(x, np.float64), np.asarray(y, np.float64)
    axes.plot(x, y, marker=MARKS[name] if marks else None, color=COLOURS[name], label=name)
    if error is not None:
        spread = np.asarray(error, np.float64)
        axes.fill_between(x, np.maximum(y - spread, y * 0.05), y + spread, color=COLOURS[name], alpha=0.18, linewidth=0)


def error_and_gain(
    name: str,
    titles: tuple[str, str],
    x: Sequence[float],
    error: Mapping[str, Sequence[float]],
    gain: Mapping[str, Sequence[float]],
    *,
    xlabel: str,
    ticks: Sequence[float],
) -> str:
    """Two panels over a logarithmic `x`, as SVG: relative RMSE by estimator, and how many times larger the error of `classical` is."""
    with panels(titles) as (figure, (left, right)):
        for panel, curves in ((left, error), (right, gain)):
            for estimator, y in curves.items():
                line(panel, x, y, estimator)
        right.axhline(1, color=INK, linewidth=1)
        for panel in (left, right):
            panel.set(xscale="log", xlabel=xlabel)
            logarithmic(panel)
            plain_ticks(panel, ticks)
            panel.legend()
        left.set_ylabel("relative RMSE")
        right.set_ylabel("MSE of classical / MSE")
        return to_svg(figure, name)


def slope(axes: Axes, x: npt.NDArray[np.float64], y: float, power: float, label: str) -> None:
    """A dashed guide through (x[0], y) that falls as x^power over all of `x`."""
    axes.plot(x, y * (x / x[0]) ** power, "--", color=INK, linewidth=1, alpha=0.6)
    middle = len(x) // 2
    axes.annotate(
        label, (x[middle], y * (x[middle] / x[0]) ** power), textcoords="offset points", xytext=(4, 4), color=INK, alpha=0.8, fontsize=9
    )


def plain_ticks(axes: Axes, x: Sequence[float], text: Sequence[str] | None = None) -> None:
    """Ticks at `x` of a logarithmic axis, written as plain numbers."""
    axes.set_xticks(list(x), list(text or [f"{value:g}" for value in x]))
    axes.minorticks_off()


def logarithmic(axes: Axes) -> None:
    """Make the y axis logarithmic if anything on it is above 0, with ticks in plain numbers, more than one a decade where it has few."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

    if not any(np.any(np.asarray(drawn.get_ydata(), np.float64) > 0) for drawn in axes.get_lines()):
        return
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    axes.yaxis.set_major_locator(LogLocator(subs=(1.0,) if high > 300 * low else (1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())


def to_svg(figure: Figure, name: str) -> str:
    """The SVG element, with ids that start with `name`; lines and letters have the colour of the text around it."""
    buffer = io.StringIO()
    figure.savefig(buffer, format="svg", transparent=True, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    text = text[text.index("<svg") :]
    for before in (' id="', "url(#", 'href="#'):
        text = text.replace(before, f"{before}{name}-")
    return text.replace(INK, "currentColor")
