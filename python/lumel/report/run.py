"""Make a report: the figures that were asked for, the page, and the files beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ..errors import OutputError, Problem, SceneError, SettingsError, nearest
from ..files import problem_with_place, write_files
from ..scene import Scene
from ..settings import Settings
from . import FIGURES
from .budget import Budget
from .figure import Figure
from .lab import BOX, BUST, Lab
from .page import page, to_csv

SECONDS = 240.0
LEAST_SECONDS = 1.0
PAGE = "report.html"

Show = Callable[[str, float], None]


@dataclass(frozen=True)
class Order:
    """What was asked for: `scene` None for those of the figures, `only` empty for all; `size` and `patches` None for the defaults.

    `command` is the line that asked for it.
    """

    scene: Scene | None = None
    only: Sequence[str] = ()
    seconds: float = SECONDS
    size: tuple[int, int] | None = None
    patches: int | None = None
    threads: int = 0
    command: str = ""


def run(directory: Path, order: Order, show: Show | None = None) -> tuple[dict[str, Figure], list[Path]]:
    """Make the figures, and write the page and all files beside it to `directory` (made where missing); gives figures and these files.

    Other files there are left alone; those of an earlier report are replaced, all at once. Raises SettingsError, SceneError where
    nothing glossy is seen, or OutputError; then nothing has been changed.
    """
    names = _checked(order)
    works = {work: weight for name in names for work, weight in FIGURES[name].works.items()}
    with folder(directory):
        lab = Lab(Budget(order.seconds, works), order.scene, order.size, order.patches, order.threads, show or (lambda *_: None))
        _check_scenes(lab)
        figures = {name: FIGURES[name].make(lab) for name in names}
        lab.begin("writing")
        files: dict[Path, bytes] = {}
        for figure in figures.values():
            files |= {directory / f"{picture.name}.png": picture.png for picture in figure.pictures}
            files |= {directory / f"{curve.name}.svg": curve.svg.encode() for curve in figure.curves}
            files |= {directory / f"{table.name}.csv": to_csv(table).encode() for table in figure.tables}
        # The page comes last: it is never newer than the files beside it.
        write_files(files | {directory / PAGE: page(figures, order.command, not order.only, lab).encode()})
    return figures, list(files)


def _checked(order: Order) -> list[str]:
    """The names of the figures, in the order of the page. Raises SettingsError with all that is wrong."""
    problems = [Problem(f"unknown figure '{name}'; {nearest(name, FIGURES)}") for name in order.only if name not in FIGURES]
    if not LEAST_SECONDS <= order.seconds < float("inf"):
        problems.append(Problem(f"time is {order.seconds:g}; allowed: a finite number of seconds, {LEAST_SECONDS:g} or more"))
    problems += Settings(size=order.size, patches=order.patches, threads=order.threads).problems()
    if problems:
        raise SettingsError(problems)
    return [name for name in FIGURES if not order.only or name in order.only]


def _check_scenes(lab: Lab) -> None:
    """Raise SceneError where the estimators have nothing to differ in."""
    for name in (BUST, BOX) if lab.given is None else (BUST,):
        if lab.subject(name).session(0).stats["measured_sides"] == 0:
            found = "the first camera sees nothing glossy"
            raise SceneError(Problem(f"{found}: a report compares the light in gloss", lab.scene(name).source or None))


@contextmanager
def folder(directory: Path) -> Iterator[None]:
    """Make `directory` for what happens inside, and take it away where that fails. Raises OutputError where it cannot be written to."""
    made = [path for path in (directory, *directory.parents) if not path.exists()]
    try:
        directory.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise OutputError(f"cannot make the folder '{directory}': {error.strerror}") from error
    try:
        if problem := problem_with_place(directory / PAGE):
            raise OutputError(problem)
        yield
    except BaseException:
        for path in made:
            if not any(path.iterdir()):
                path.rmdir()
        raise
