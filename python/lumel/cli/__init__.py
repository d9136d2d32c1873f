"""The command `lumel`. Heavy modules are imported inside the commands, so that `--help` answers at once."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from . import bench, compare, demo, info, render, report

app = typer.Typer(
    name="lumel",
    help="Render global illumination by shooting light.",
    add_completion=False,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode=None,
)
app.command("render")(render.render)
app.command("info")(info.info)
app.command("compare")(compare.compare)
app.command("demo")(demo.demo)
app.command("report")(report.report)
app.command("bench")(bench.bench)


def _show_version(wanted: bool) -> None:
    if wanted:
        import lumel

        typer.echo(f"lumel {lumel.__version__}")
        raise typer.Exit


@app.callback()
def _lumel(
    version: Annotated[bool, typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version and exit.")] = False,
) -> None:
    pass


def main() -> None:
    """Run the command line of this process; exits with the codes of `cli.errors`."""
    sys.exit(app())
