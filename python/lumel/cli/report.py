"""`lumel report`: the figures of the paper, and ours, on one page."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated

import typer

from ..errors import Problem, SettingsError
from . import options, progress, values
from .errors import reporting


def report(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the page and the files beside it.")] = Path(
        "out/report"
    ),
    scene: Annotated[
        str | None, typer.Option("--scene", metavar="SCENE", help="For all figures, as for render; by default built-in ones.")
    ] = None,
    only: Annotated[list[str] | None, typer.Option("--only", metavar="FIGURE", help="Make this figure; repeat for several.")] = None,
    time: Annotated[float | None, typer.Option("--time", metavar="SECONDS", help="For the whole report; 240 by default.")] = None,
    size: options.Size = None,
    patches: options.Patches = None,
    threads: options.Threads = None,
    define: options.Define = None,
    lenient: options.Lenient = False,
    quiet: options.Quiet = False,
) -> None:
    """Measure what weighting is worth here: the figures of the paper, and ours, on one page with its numbers beside it."""
    problems: list[Problem] = []
    defines = values.defines(define or [], problems)
    pixels, count = values.size(size, problems), values.count("--patches", patches, problems)
    if (define or lenient) and scene is None:
        problems.append(Problem("-D and --lenient are for scene files; give one with --scene"))
    with reporting():
        if problems:
            raise SettingsError(problems)
        from ..readers import load
        from ..report.run import PAGE, SECONDS, Order, run

        given = load(scene, defines=defines, lenient=lenient) if scene is not None else None
        seconds = SECONDS if time is None else time
        order = Order(given, tuple(only or ()), seconds, pixels, count, threads or 0, shlex.join(["lumel", *sys.argv[1:]]))
        with progress.showing_stages(quiet=quiet) as shown:
            figures, files = run(output, order, shown)
        if not quiet:
            for figure in figures.values():
                print(figure.title, *(f"  {' '.join(line.replace('`', '').split())}" for line in figure.found), sep="\n")
            print(f"wrote {output / PAGE} and {len(files)} files beside it")
