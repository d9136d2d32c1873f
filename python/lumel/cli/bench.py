"""`lumel bench`: what this machine traces, shoots and sees a second."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from ..errors import Problem, SettingsError
from . import options, text, values
from .errors import reporting

if TYPE_CHECKING:
    from collections.abc import Mapping

MOST_CAMERAS = 1024


def bench(
    scene: Annotated[str, typer.Argument(metavar="[SCENE]", help="As for render; lumel:demo by default.")] = "lumel:demo",
    as_json: options.Json = False,
    patches: options.Patches = None,
    cameras: Annotated[int, typer.Option("--cameras", metavar="N", help="Eyes that measure at once, side by side; 1 by default.")] = 1,
    threads: options.Threads = None,
    define: options.Define = None,
    lenient: options.Lenient = False,
) -> None:
    """Measure on SCENE how fast rays are traced, shot and seen, and how much memory that takes."""
    problems: list[Problem] = []
    defines = values.defines(define or [], problems)
    count = values.count("--patches", patches, problems)
    if not 1 <= cameras <= MOST_CAMERAS:
        problems.append(Problem(f"--cameras must be 1 to {MOST_CAMERAS}, found {cameras}"))
    with reporting():
        from ..settings import Settings

        settings = Settings(patches=count, threads=threads or 0)
        problems += settings.problems()
        if problems:
            raise SettingsError(problems)
        from ..bench import run
        from ..readers import load

        loaded = load(scene, defines=defines, lenient=lenient)
        found = run(loaded, count, cameras, settings.thread_count())
        print(text.to_json(found, indent=2) if as_json else tell(found))


def tell(found: Mapping[str, Any]) -> str:
    """The numbers for people, with the ratios behind them."""
    size = f"{found['triangles']:,} triangles, {found['patches']:,} patches"
    lines = [
        f"scene      {size}, {_plural(found['cameras'], 'eye')}, {_plural(found['threads'], 'thread')}",
        f"Embree     {text.count(found['embree_rays_per_s'], 'rays/s')}, closest hits of the rays that are shot",
        f"shooting   {text.count(found['shooting_rays_per_s'], 'rays/s')} all in, {found['shooting_over_embree']:.2f} of Embree",
        f"bundles    {text.count(found['bundle_transfers_per_s'], 'transfers/s')}, {found['bundles_over_embree']:.0f} of Embree",
        f"eye pass   {text.count(found['eye_pixels_per_s'], 'samples/s')}",
        f"           {text.count(found['eye_pixels_per_s_without_direct'], 'samples/s')} without direct light",
        f"memory     {found['peak_rss_bytes'] / 2**20:,.0f} MB at most",
    ]
    return "\n".join(lines)


def _plural(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number > 1)}"
