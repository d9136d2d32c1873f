"""How fast this machine traces, shoots and sees, in one run: numbers that a user can quote, and ratios that hold on other machines."""

from __future__ import annotations

import resource
import statistics
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from . import _core
from .core import camera_to_core, to_core
from .pace import DIRECTIONS_PER_STEP, RAYS_PER_STEP
from .render import DIRECT_SAMPLES, with_camera
from .scene import Camera, Scene

RAYS = RAYS_PER_STEP  # of a step
WINDOW = 1024  # pixels a side, of bundles
DIRECTIONS = DIRECTIONS_PER_STEP  # of a round of bundles
ROUNDS = 5  # the median of so many is taken
EYE_SAMPLES = 4  # a pixel and pass
BESIDE = 0.01  # metres between eyes, for each metre that the scene is large


def run(
    scene: Scene, patches: int | None = None, cameras: int = 1, threads: int = 1, rays: int = RAYS, isa: str | None = None
) -> dict[str, Any]:
    """Measure on `scene`: the keys of `lumel bench --json` (see docs/cli.md). Steps and raw tracing of the same rays take turns.

    isa: as in `lumel.render`.
    """
    scene, _ = with_camera(scene)
    core, _ = to_core(scene, patches)
    eyes = _row(scene.cameras[0], cameras, core.radius)
    shooting = _session(core, eyes, threads, isa)
    shooting.begin_replica(rays)
    shooting.step(rays)  # opens memory
    traced = shooting.capture(rays)
    raster = _core.Raster(core, threads)
    pairs = raster.sweep(WINDOW, DIRECTIONS, 0)["pairs"]
    single, packets, ordered, step, sweep = _turns(
        lambda: shooting.trace_captured("single"),
        lambda: shooting.trace_captured("packets"),
        lambda: shooting.trace_captured("ordered"),
        lambda: shooting.step(rays),
        lambda: raster.sweep(WINDOW, DIRECTIONS, 0),
    )
    shooting.end_replica()

    dark = _session(core, eyes[:1], threads, isa, first_shot=False)
    for session in (shooting, dark):
        session.begin_replica(rays // 8)
        session.step(rays // 8)
        session.end_replica()
        session.reconstruct()
    seen, without = _turns(lambda: shooting.eye_pass(0, EYE_SAMPLES), lambda: dark.eye_pass(0, EYE_SAMPLES))
    samples = eyes[0].width * eyes[0].height * EYE_SAMPLES
    return {
        "embree_rays_per_s": traced / packets,
        "embree_single_rays_per_s": traced / single,
        "ordered_rays_per_s": traced / ordered,
        "shooting_rays_per_s": rays / step,
        "shooting_over_embree": rays / step / (traced / packets),
        "shooting_over_embree_single": rays / step / (traced / single),
        "shooting_over_ordered": rays / step / (traced / ordered),
        "bundle_transfers_per_s": pairs / sweep,
        "bundles_over_embree": pairs / sweep / (traced / packets),
        "bundles_over_embree_single": pairs / sweep / (traced / single),
        "eye_pixels_per_s": samples / seen,
        "eye_pixels_per_s_without_direct": samples / without,
        "peak_rss_bytes": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024,
        "triangles": core.triangles,
        "patches": core.patches,
        "cameras": cameras,
        "threads": threads,
        "isa": shooting.stats["isa"],
    }


def _session(core: _core.Scene, cameras: list[Camera], threads: int, isa: str | None, first_shot: bool = True) -> _core.Session:
    """Ray shooting alone, weighted, in patches: no ray is gathered."""
    return _core.Session(
        scene=core,
        cameras=[camera_to_core(camera) for camera in cameras],
        transport="rays",
        areas="patches",
        estimator="weighted",
        defensive=-1.0,
        gather=0.0,
        weight_diffuse=None,
        first_shot=first_shot,
        direct_samples=DIRECT_SAMPLES,
        seed=0,
        threads=threads,
        isa=isa,
    )


def _row(camera: Camera, count: int, radius: float) -> list[Camera]:
    """`count` cameras side by side, the first of them as it is."""
    matrix = np.asarray(camera.to_world, np.float64)
    shifted = []
    for i in range(count):
        moved = matrix.copy()
        moved[:3, 3] += i * BESIDE * radius * matrix[:3, 0]
        shifted.append(replace(camera, to_world=moved))
    return shifted


def _turns(*works: Callable[[], object]) -> list[float]:
    """Median seconds of each of `works`, which take turns, so that other load on the machine meets all."""
    times: list[list[float]] = [[] for _ in works]
    for _ in range(ROUNDS):
        for work, spent in zip(works, times, strict=True):
            begin = time.perf_counter()
            work()
            spent.append(time.perf_counter() - begin)
    return [statistics.median(spent) for spent in times]
