"""The demo: the built-in scene with the `classical` and the `weighted` estimator at equal time, and how far each is from the truth."""

from __future__ import annotations

import io
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from .errors import OutputError
from .images.compare import Comparison, compare
from .images.files import write_files
from .images.png import encode_png, to_bytes
from .progress import Progress
from .readers import load
from .render import render
from .result import Result
from .scene import FloatArray, Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SCENE = "lumel:demo"
ESTIMATORS = ("classical", "weighted")
SECONDS = 2.0  # for each estimator
REFERENCE_SHARE = 8  # times the shooting rays of the longer of the two runs
GLOSS = "indirect.specular"

Show = Callable[[Progress], None]


@dataclass
class Run:
    """One timed run and its errors: relMSE of the indirect specular light on glossy pixels, and of the whole picture."""

    estimator: str
    result: Result
    curve: list[tuple[float, float]] = field(default_factory=list)  # (seconds, estimated error) while it ran
    gloss: float = 0.0
    whole: Comparison | None = None

    @property
    def rays(self) -> int:
        """Shooting rays of the run."""
        return int(str(self.result.stats["rays"]))


def run(directory: Path, progress: Show | None = None) -> list[str]:
    """Write classical.png, weighted.png and side_by_side.png to `directory` (made where missing); gives lines that say the error of each.

    Raises OutputError where that cannot be written.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder '{directory}': {error.strerror}") from error
    scene = load(SCENE)
    runs = [_timed(scene, estimator, progress) for estimator in ESTIMATORS]
    reference = render(scene, estimator="weighted", rays=REFERENCE_SHARE * max(run.rays for run in runs), seed=1, progress=progress)
    for timed in runs:
        timed.gloss = gloss_error(timed.result, reference)
        timed.whole = compare(timed.result.image(), reference.image(), None, reference.stderr())
    files = {directory / f"{timed.estimator}.png": encode_png(timed.result.image(), timed.result.metadata) for timed in runs}
    files[directory / "side_by_side.png"] = _figure_bytes(_side_by_side(runs, reference))
    write_files(files)
    return [
        f"{SECONDS:g} s each, against a run of {REFERENCE_SHARE} times the rays with another seed:",
        *(caption(timed) for timed in runs),
        f"in indirect specular light, the mean square error of classical is {runs[0].gloss / runs[1].gloss:.3g} times that of weighted",
        *(f"wrote {path}" for path in files),
    ]


def gloss_error(result: Result, reference: Result) -> float:
    """relMSE of the indirect specular light over the pixels that have any in the reference (the mean in e is over them too)."""
    R = reference.layer(GLOSS).astype(np.float64)
    glossy = R.max(axis=-1) > 0
    R, I = R[glossy], result.layer(GLOSS)[glossy]  # noqa: E741
    return float(np.mean((I - R) ** 2 / (R**2 + 0.01 * R.mean() ** 2)))


def caption(timed: Run) -> str:
    """One line about a run."""
    whole = f", whole picture {timed.whole.relmse:.3g}" if timed.whole else ""
    return f"{timed.estimator:9}  {timed.rays / 1e6:.2f} M rays, relMSE: indirect specular {timed.gloss:.3g}{whole}"


def _timed(scene: Scene, estimator: str, progress: Show | None) -> Run:
    curve: list[tuple[float, float]] = []

    def note(state: Progress) -> None:
        if np.isfinite(state.error) and state.error > 0:
            curve.append((state.elapsed, state.error))
        if progress:
            progress(state)

    return Run(estimator, render(scene, estimator=estimator, time=SECONDS, progress=note), curve)


def _side_by_side(runs: list[Run], reference: Result) -> Figure:
    """Pictures above, what they miss of the indirect specular light below, and the estimated error over time where the runs told it."""
    from matplotlib.figure import Figure

    curves = any(len(timed.curve) > 1 for timed in runs)
    figure = Figure(figsize=(12, 12.5 if curves else 9.5), layout="constrained", facecolor="white")
    grid = figure.add_gridspec(3 if curves else 2, len(runs), height_ratios=[1, 1, 0.5][: 3 if curves else 2])
    truth = reference.layer(GLOSS)
    scale = float(np.percentile(truth[truth > 0], 95)) if np.any(truth > 0) else 1.0
    for column, timed in enumerate(runs):
        top, below = (figure.add_subplot(grid[row, column]) for row in (0, 1))
        top.imshow(to_bytes(timed.result.image()))
        top.set_title(f"{timed.estimator}, {SECONDS:g} s, {timed.rays / 1e6:.2f} M rays")
        below.imshow(_luminance(np.abs(timed.result.layer(GLOSS) - truth)), cmap="magma", vmin=0, vmax=scale)
        below.set_title(f"error of the indirect specular light: relMSE {timed.gloss:.3g}")
        for axes in (top, below):
            axes.set_axis_off()
    if curves:
        axes = figure.add_subplot(grid[2, :])
        for timed in runs:
            axes.loglog(*np.transpose(timed.curve), marker=".", label=timed.estimator)
        axes.set(xlabel="time, s", ylabel="estimated relative error")
        axes.legend()
        axes.grid(visible=True, which="both", alpha=0.3)
    return figure


def _luminance(rgb: FloatArray) -> FloatArray:
    return np.asarray(rgb @ np.array((0.2126, 0.7152, 0.0722), dtype=np.float32))


def _figure_bytes(figure: Figure) -> bytes:
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=100)
    return buffer.getvalue()
