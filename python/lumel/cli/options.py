"""The flags, each with its help."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

# typer looks at these annotations when it runs, so they stand outside TYPE_CHECKING.
Scene = Annotated[str, typer.Argument(metavar="SCENE", help="Mitsuba XML, OBJ, PLY or STL file, or a built-in scene such as lumel:demo.")]
Outputs = Annotated[list[Path], typer.Option("--output", "-o", metavar="OUT.exr|OUT.png", help="Picture to write; repeat for several.")]
Transport = Annotated[str | None, typer.Option("--transport", metavar="walk|rays|bundles", help="How light is carried; chosen by default.")]
Areas = Annotated[str | None, typer.Option("--areas", metavar="patches|pixels", help="Where gloss is measured; patches by default.")]
Estimator = Annotated[
    str | None,
    typer.Option("--estimator", metavar="classical|weighted|regression|auto", help="How samples become radiance; auto by default."),
]
Defensive = Annotated[float | None, typer.Option("--defensive", metavar="SHARE", help="Share of the rays, 0 to 1, that start anywhere.")]
Gather = Annotated[
    float | None, typer.Option("--gather", metavar="N", help="Gathering rays for every area per 2^20 shooting rays; 0 for none.")
]
WeightDiffuse = Annotated[
    bool | None,
    typer.Option("--weight-diffuse/--no-weight-diffuse", help="Weigh diffuse light, too; by default where `auto` finds it covered."),
]
FirstShot = Annotated[
    bool | None, typer.Option("--first-shot/--no-first-shot", help="Replace lamps by their first reflection; on by default.")
]
Rays = Annotated[str | None, typer.Option("--rays", metavar="N", help="Stop after N shooting rays (5000, 1e6, 2M).")]
Directions = Annotated[str | None, typer.Option("--directions", metavar="N", help="Stop after N directions of bundles (500, 4k).")]
Window = Annotated[int | None, typer.Option("--window", metavar="N", help="Pixels of an edge of the window that bundles go through.")]
Iteration = Annotated[
    str | None,
    typer.Option("--iteration", metavar="frozen|plain", help="What bundles carry: a solved state, or what the last one brought."),
]
Time = Annotated[float | None, typer.Option("--time", metavar="SECONDS", help="Wall time from the files read to the picture complete.")]
Error = Annotated[float | None, typer.Option("--error", metavar="E", help="Stop when the relative error of the picture is below E.")]
Patches = Annotated[str | None, typer.Option("--patches", metavar="N", help="About so many patches in all.")]
Adaptive = Annotated[
    bool | None,
    typer.Option(
        "--adaptive/--no-adaptive", help="Small patches where the light varies; on by default, but in short renders and with bundles."
    ),
]
Quality = Annotated[str | None, typer.Option("--quality", metavar="draft|medium|high", help="Work without a budget; medium by default.")]
Camera = Annotated[
    str | None, typer.Option("--camera", metavar="NAME|all", help="The first by default; all writes OUT.CAMERA.exr for each.")
]
Size = Annotated[str | None, typer.Option("--size", metavar="WxH", help="Size of the picture in pixels, in place of the scene's.")]
Layers = Annotated[str | None, typer.Option("--layers", metavar="LIST|all", help="Layers of the EXR, with commas between them.")]
Half = Annotated[bool, typer.Option("--half", help="Store 16-bit floats in the EXR.")]
Exposure = Annotated[float, typer.Option("--exposure", metavar="EV", help="Brighten the PNG by 2^EV.")]
Seed = Annotated[int | None, typer.Option("--seed", metavar="N", help="Of the random numbers; 0 by default.")]
Threads = Annotated[int | None, typer.Option("--threads", metavar="N", help="One for each processor by default.")]
Isa = Annotated[str | None, typer.Option("--isa", metavar="avx2|avx512", help="Instructions to trace rays with; the best by default.")]
Define = Annotated[list[str] | None, typer.Option("-D", metavar="name=value", help="Set $name in the scene; repeat for several.")]
Lenient = Annotated[bool, typer.Option("--lenient", help="Go on without what the reader does not know.")]
Explain = Annotated[
    bool, typer.Option("--explain", help="Say where the light went and what the estimator did; OUT.explain.png shows where.")
]
Quiet = Annotated[bool, typer.Option("--quiet", help="Say nothing but errors.")]
Progress = Annotated[
    str | None, typer.Option("--progress", metavar="bar|plain|json", help="How progress shows; bar on a terminal, else plain.")
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
