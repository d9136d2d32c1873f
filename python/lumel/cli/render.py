"""`lumel render`: a scene file in, pictures out."""

from __future__ import annotations

import shlex
import sys
import time as clock
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import OutputError, Problem, SettingsError
from . import options, progress, summary, values
from .errors import reporting
from .interrupt import run_interruptibly

if TYPE_CHECKING:
    from ..result import Result
    from ..scene import Scene
    from ..settings import Settings

WORTH_SAYING = 1 << 30  # bytes of memory


def render(
    scene: options.Scene,
    output: options.Outputs,
    transport: options.Transport = None,
    areas: options.Areas = None,
    estimator: options.Estimator = None,
    defensive: options.Defensive = None,
    gather: options.Gather = None,
    weight_diffuse: options.WeightDiffuse = None,
    first_shot: options.FirstShot = None,
    rays: options.Rays = None,
    directions: options.Directions = None,
    time: options.Time = None,
    error: options.Error = None,
    patches: options.Patches = None,
    adaptive: options.Adaptive = None,
    window: options.Window = None,
    iteration: options.Iteration = None,
    quality: options.Quality = None,
    camera: options.Camera = None,
    size: options.Size = None,
    layers: options.Layers = None,
    half: options.Half = False,
    exposure: options.Exposure = 0.0,
    seed: options.Seed = None,
    threads: options.Threads = None,
    isa: options.Isa = None,
    define: options.Define = None,
    lenient: options.Lenient = False,
    explain: options.Explain = False,
    quiet: options.Quiet = False,
    show: options.Progress = None,
) -> None:
    """Render SCENE into pictures."""
    problems: list[Problem] = []
    defines = values.defines(define or [], problems)
    wanted = values.layers(layers, problems)
    budgets = {
        "rays": values.count("--rays", rays, problems), "directions": values.count("--directions", directions, problems),
        "time": time, "error": error,
    }  # fmt: skip
    settings: dict[str, Any] = {
        "transport": transport, "areas": areas, "estimator": estimator, "defensive": defensive, "gather": gather,
        "weight_diffuse": weight_diffuse, "first_shot": first_shot, "patches": values.count("--patches", patches, problems),
        "quality": quality, "camera": camera, "size": values.size(size, problems), "layers": wanted, "explain": explain or None,
        "seed": seed, "threads": threads, "window": window, "iteration": iteration, "adaptive": adaptive, "isa": isa,
    }  # fmt: skip
    show = show or progress.default_kind()
    values.choice("--progress", show, progress.KINDS, problems)
    if values.exclusive({"--rays": rays, "--directions": directions, "--time": time, "--error": error}, problems):
        settings |= budgets
    values.exposure(exposure, problems)
    # Flags that were not given are left to the defaults of lumel.render.
    given = {name: value for name, value in settings.items() if value is not None}
    with reporting():
        settled = _check(problems, given, output)
        loaded = _load(scene, defines, lenient)
        started = clock.monotonic()
        if camera == "all":
            _check_outputs([path for path, _ in _targets(output, [view.name for view in loaded.cameras])])
        if not quiet and show != "json":
            _announce_memory(loaded, settled)
        write = partial(_write, outputs=output, every_camera=camera == "all", layers=wanted, exposure=exposure, half=half)
        drafts = {"draft": write} if show == "bar" and not quiet else {}
        result = _run(loaded, given | {"started": started} | drafts, show, quiet)
        files = write(result)
        if not quiet:
            summary.show(result, files, as_json=show == "json")
            if result.explanation and show != "json":
                from .explain import show as show_explanation

                show_explanation(result.explanation)


def _check(problems: Sequence[Problem], settings: Mapping[str, Any], outputs: Sequence[Path]) -> Settings:
    """Raise now what would else be found after the scene was read, or after a long render; gives the settings but for layers."""
    from ..images.files import problems_with
    from ..settings import Settings

    # The problems of flags say what the user typed, so they stand for the same one in the settings.
    known = {name: value for name, value in settings.items() if name not in ("layers", "explain")}
    settled = Settings(**known)
    bad = [*problems, *settled.problems()]
    unwritable = problems_with(outputs)
    if bad:
        raise SettingsError([*bad, *unwritable])
    if unwritable:
        raise OutputError(unwritable)
    return settled


def _announce_memory(scene: Scene, settings: Settings) -> None:
    """Say how much memory a large scene will take, before it does."""
    from ..memory import expected
    from ..settings import memory_of_machine

    size = expected(scene, settings)
    if size > WORTH_SAYING:
        print(f"memory: about {size / 2**30:.1f} GB; this machine has {memory_of_machine() / 2**30:.0f} GB", file=sys.stderr)


def _check_outputs(paths: Sequence[Path]) -> None:
    from ..images.files import problems_with

    if problems := problems_with(paths):
        raise OutputError(problems)


def _load(scene: str, defines: dict[str, str], lenient: bool) -> Scene:
    from ..readers import load

    return load(scene, defines=defines, lenient=lenient)


def _run(scene: Scene, settings: dict[str, Any], show: str, quiet: bool) -> Result:
    """Render with progress on stderr and an ear for Ctrl-C; the command line joins the metadata."""
    from ..render import render as render_scene

    with progress.showing(show, quiet=quiet) as shown:
        result = run_interruptibly(lambda interrupted: render_scene(scene, **settings, progress=shown, interrupted=interrupted))
    return replace(result, metadata={**result.metadata, "command": shlex.join(["lumel", *sys.argv[1:]])})


def _write(result: Result, outputs: Sequence[Path], *, every_camera: bool, **how: Any) -> list[Path]:
    """Write all pictures, or none where one of them cannot be written; gives the files."""
    from ..images.files import write_pictures

    targets = _targets(outputs, result.cameras) if every_camera else [(output, result.cameras[0]) for output in outputs]
    files = {path: result.encode(path, camera=camera, **how) for path, camera in targets}
    if result.explanation:
        from . import explain

        files |= {explain.path_of_picture(path): explain.picture(result, camera) for path, camera in targets}
    write_pictures(files)
    return list(files)


def _targets(outputs: Sequence[Path], cameras: Sequence[str]) -> list[tuple[Path, str]]:
    """A file of each output for each camera."""
    from ..result import path_of_camera

    targets = [(path_of_camera(output, camera), camera) for output in outputs for camera in cameras]
    if len({path for path, _ in targets}) < len(targets):
        raise OutputError(f"cameras {', '.join(cameras)} would share a file: their names are too alike for file names")
    return targets
