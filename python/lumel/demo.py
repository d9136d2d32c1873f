"""The demo: the built-in scene with the `classical` and the `weighted` estimator at equal time, and how far each is from the truth.

Both have their defaults: `weighted` joins gathering samples to those of shooting, and mixes rays of the lobe into the picture where that is
better, in its time; `classical` is shooting alone.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from . import demo_figure, gloss
from .errors import OutputError
from .images.compare import Comparison, compare
from .images.files import write_pictures
from .images.png import encode_png
from .progress import Progress
from .readers import load
from .render import render
from .result import Result

SCENE = "lumel:demo"
PATCHES = 21_000
ESTIMATORS = ("classical", "weighted")
SECONDS = (0.5, 1.0, 1.75)  # the error is told after each of these; the pictures are those of the last
REFERENCE_SHARE = 8  # times the shooting rays of the longest run
EXPOSURE = 0.0  # EV

Show = Callable[[Progress], None]


@dataclass(frozen=True)
class Run:
    """One timed run and its errors: relMSE of the indirect specular light on glossy pixels, and of the whole picture."""

    estimator: str
    seconds: float
    result: Result
    in_gloss: float
    whole: Comparison

    @property
    def rays(self) -> int:
        """Shooting rays of the run."""
        return rays_of(self.result)


def run(directory: Path, progress: Show | None = None) -> list[str]:
    """Write classical.png, weighted.png and side_by_side.png to `directory` (made where missing); gives lines that say the error of each.

    Raises OutputError where that cannot be written.
    """
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder '{directory}': {error.strerror}") from error
    go = partial(render, load(SCENE), patches=PATCHES, progress=progress)
    results = {(estimator, s): go(estimator=estimator, time=s) for s in SECONDS for estimator in ESTIMATORS}
    rays = REFERENCE_SHARE * max(map(rays_of, results.values()))
    reference = go(estimator="weighted", rays=rays, seed=1)

    runs = [_judged(estimator, s, result, reference) for (estimator, s), result in results.items()]
    last = runs[-len(ESTIMATORS) :]
    files = {directory / f"{r.estimator}.png": encode_png(r.result.image(), r.result.metadata, exposure=EXPOSURE) for r in last}
    curves = {estimator: [r for r in runs if r.estimator == estimator] for estimator in ESTIMATORS}
    files[directory / "side_by_side.png"] = demo_figure.draw(
        [(f"{r.estimator}, {r.seconds:g} s, {r.rays / 1e6:.1f} M rays", r.result.image(), r.result.layer(gloss.LAYER)) for r in last]
        + [(f"reference, {rays_of(reference) / 1e6:.0f} M rays", reference.image(), reference.layer(gloss.LAYER))],
        {
            "relMSE of the indirect specular light": {e: [(r.seconds, r.in_gloss) for r in of] for e, of in curves.items()},
            "relMSE of the whole picture": {e: [(r.seconds, r.whole.relmse) for r in of] for e, of in curves.items()},
        },
        EXPOSURE,
    )
    write_pictures(files)
    return [
        f"{SECONDS[-1]:g} s each, against a run of {rays_of(reference) / 1e6:.1f} M rays with another seed:",
        *(caption(r) for r in last),
        f"in indirect specular light, the relMSE of classical is {last[0].in_gloss / last[1].in_gloss:.3g} times that of weighted",
        *(f"wrote {path}" for path in files),
    ]


def gloss_error(result: Result, reference: Result) -> float:
    """relMSE of the indirect specular light over the pixels that have any in the reference."""
    return gloss.relmse(result.layer(gloss.LAYER), reference.layer(gloss.LAYER))


def caption(timed: Run) -> str:
    """One line about a run."""
    errors = f"relMSE: indirect specular {timed.in_gloss:.3g}, whole picture {timed.whole.relmse:.3g}"
    return f"{timed.estimator:9}  {timed.rays / 1e6:.2f} M rays, {errors}"


def rays_of(result: Result) -> int:
    """Shooting rays of a result."""
    return int(str(result.stats["rays"]))


def _judged(estimator: str, seconds: float, result: Result, reference: Result) -> Run:
    whole = compare(result.image(), reference.image(), None, reference.stderr())
    return Run(estimator, seconds, result, gloss_error(result, reference), whole)
