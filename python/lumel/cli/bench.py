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
    isa: options.Isa = None,
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

        settings = Settings(patches=count, threads=threads or 0, isa=isa)
        problems += settings.problems()
        if problems:
            raise SettingsError(problems)
        from ..bench import run
        from ..readers import load

        loaded = load(scene, defines=defines, lenient=lenient)
        found = run(loaded, count, cameras, settings.thread_count(), isa=isa)
        print(text.to_json(found, indent=2) if as_json else tell(found))


def tell(found: Mapping[str, Any]) -> str:
    """The numbers for people, with the ratios behind them."""
    size = f"{found['triangles']:,} triangles, {found['patches']:,} patches"
    lines = [
        f"scene      {size}, {_plural(found['cameras'], 'eye')}, {_plural(found['threads'], 'thread')}, {found['isa']}",
        f"Embree     {text.count(found['embree_rays_per_s'], 'rays/s')}, closest hits of the rays that are shot, eight at a time",
        f"           {text.count(found['embree_single_rays_per_s'], 'rays/s')} one by one",
        f"           {text.count(found['ordered_rays_per_s'], 'rays/s')} ordered by direction, as shooting traces them",
        f"shooting   {text.count(found['shooting_rays_per_s'], 'rays/s')} all in, {_ratios(found, 'shooting', 2)}",
        f"bundles    {text.count(found['bundle_transfers_per_s'], 'transfers/s')}, {_ratios(found, 'bundles', 0)}",
        f"eye pass   {text.count(found['eye_pixels_per_s'], 'samples/s')}",
        f"           {text.count(found['eye_pixels_per_s_without_direct'], 'samples/s')} without direct light",
        f"memory     {found['peak_rss_bytes'] / 2**20:,.0f} MB at most",
    ]
    return "\n".join(lines)


def _ratios(found: Mapping[str, Any], what: str, digits: int) -> str:
    eight, one = (found[f"{what}_over_embree{which}"] for which in ("", "_single"))
    return f"{eight:.{digits}f} of Embree eight at a time, {one:.{digits}f} of one by one"


def _plural(number: int, noun: str) -> str:
    return f"{number} {noun}{'s' * (number > 1)}"
