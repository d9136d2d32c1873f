"""`lumel demo`: both estimators at equal time, side by side."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from . import options, progress
from .errors import reporting


def demo(
    output: Annotated[Path, typer.Option("--output", "-o", metavar="DIR", help="Folder for the pictures.")] = Path("out/demo"),
    quiet: options.Quiet = False,
) -> None:
    """Render the built-in demo scene with both estimators at equal time, and print the error of each."""
    from ..demo import run

    with reporting():
        with progress.showing(progress.default_kind(), quiet=quiet) as shown:
            report = run(output, shown)
        if not quiet:
            print("\n".join(report))
