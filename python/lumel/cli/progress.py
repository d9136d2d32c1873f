"""Show on stderr how a render gets on: as a bar, as plain lines, or as one JSON object a line."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from typing import TYPE_CHECKING

from . import text

if TYPE_CHECKING:
    from ..progress import Progress

KINDS = ("bar", "plain", "json")
PHASES = {"solve": "solving", "shoot": "shooting", "eye": "eye pass"}
_PLAIN_INTERVAL = 5.0  # seconds between plain lines
_JSON_INTERVAL = 0.1

Show = Callable[["Progress"], None]


@contextmanager
def showing(kind: str, *, quiet: bool = False) -> Iterator[Show | None]:
    """Give a function that shows a Progress as `kind` says, None where `quiet`; what it has put on the terminal ends with the context."""
    if quiet:
        yield None
    elif kind == "bar":
        with _bar() as show:
            yield show
    elif kind == "json":
        yield _Throttled(_json_line, _JSON_INTERVAL)
    else:
        yield _Throttled(plain_line, _PLAIN_INTERVAL)


@contextmanager
def showing_stages(*, quiet: bool = False) -> Iterator[Callable[[str, float], None] | None]:
    """Give a function that shows what is done and the share (0..1) that is over: as a bar for people, as a line a stage for logs."""
    if quiet:
        yield None
    elif default_kind() == "bar":
        with _stage_bar() as show:
            yield show
    else:
        yield _stage_lines()


def default_kind() -> str:
    """A bar for people, lines for logs."""
    return "bar" if sys.stderr.isatty() else "plain"


def plain_line(progress: Progress) -> str:
    """`shooting  42 %, 3.2 M rays, 4.1 M rays/s, error 1.2 %, 5.0 s left`, without what is unknown."""
    parts = [f"{PHASES.get(progress.phase, progress.phase):9}"]
    if math.isfinite(progress.fraction):
        parts[0] += f"{100 * progress.fraction:4.0f} %"
    parts.append(text.count(progress.rays, progress.unit))
    if math.isfinite(progress.rays_per_s):
        parts.append(text.count(progress.rays_per_s, f"{progress.unit}/s"))
    if math.isfinite(progress.error):
        parts.append(f"error {text.error(progress.error)}")
    if math.isfinite(progress.remaining):
        parts.append(f"{text.seconds(progress.remaining)} left")
    return ", ".join(part.rstrip() for part in parts)


def _json_line(progress: Progress) -> str:
    return text.to_json(asdict(progress))


class _Throttled:
    """Print a line when the phase changes and else once in `interval` seconds."""

    def __init__(self, line: Callable[[Progress], str], interval: float) -> None:
        self._line, self._interval = line, interval
        self._phase = ""
        self._last = -math.inf

    def __call__(self, progress: Progress) -> None:
        now = time.monotonic()
        if progress.phase == self._phase and now - self._last < self._interval and progress.fraction != 1:
            return
        self._phase, self._last = progress.phase, now
        print(self._line(progress), file=sys.stderr, flush=True)


@contextmanager
def _bar() -> Iterator[Show]:
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn
    from rich.progress import Progress as Bar

    columns = (TextColumn("{task.description:9}"), BarColumn(), TextColumn("{task.fields[facts]}"))
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=None, facts="")

        def show(progress: Progress) -> None:
            known = math.isfinite(progress.fraction)
            facts = plain_line(progress).partition(", ")[2]
            bar.update(
                task,
                description=PHASES.get(progress.phase, progress.phase),
                total=1.0 if known else None,
                completed=progress.fraction if known else 0.0,
                facts=facts,
            )

        yield show


@contextmanager
def _stage_bar() -> Iterator[Callable[[str, float], None]]:
    from rich.console import Console
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeElapsedColumn
    from rich.progress import Progress as Bar

    columns = (BarColumn(), TaskProgressColumn(), TimeElapsedColumn(), TextColumn("{task.description}"))
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task = bar.add_task("starting", total=1.0)
        yield lambda doing, fraction: bar.update(task, description=doing, completed=fraction)


def _stage_lines() -> Callable[[str, float], None]:
    last = ""

    def show(doing: str, fraction: float) -> None:
        nonlocal last
        if doing != last:
            last = doing
            print(f"{100 * fraction:3.0f} %  {doing}", file=sys.stderr, flush=True)

    return show
