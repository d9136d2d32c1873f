"""`lumel.render`: from a scene and settings to pictures."""

from __future__ import annotations

import hashlib
import math
import time as clock
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from . import _core
from .core import MORE_PATCHES, camera_to_core, to_core, wanted_patches
from .error_bars import errors_of
from .errors import SettingsError
from .explanation import Explanation, explain, why_auto
from .memory import expected
from .pace import RAYS_PER_SAMPLE, WorkClock
from .progress import Progress
from .result import Patches, Result
from .scene import FloatArray, Scene
from .schedule import Schedule
from .settings import MOST_GATHERING, QUALITIES, Settings
from .trial import OTHER
from .work import Work

WORTH_SAYING = 0.02  # share of flagged areas; up to half of it comes by chance
PARITY_WORTH_SAYING = 1000.0  # lines of a million
LEAK_WORTH_SAYING = 1e-3  # share of the light
DIRECT_SAMPLES = 4  # shadow rays a side and replica for the first shot


def render(
    scene: Scene,
    *,
    transport: str | None = None,
    areas: str = "patches",
    estimator: str = "auto",
    defensive: float | None = None,
    gather: float | None = None,
    weight_diffuse: bool | None = None,
    first_shot: bool = True,
    rays: int | None = None,
    time: float | None = None,
    error: float | None = None,
    patches: int | None = None,
    adaptive: bool | None = None,
    quality: str = "medium",
    camera: str | None = None,
    size: tuple[int, int] | None = None,
    seed: int = 0,
    threads: int = 0,
    layers: Sequence[str] | Literal["all"] | None = None,
    explain: bool = False,
    directions: int | None = None,
    window: int | None = None,
    iteration: str = "frozen",
    isa: str | None = None,
    progress: Callable[[Progress], None] | None = None,
    draft: Callable[[Result], None] | None = None,
    interrupted: Callable[[], bool] | None = None,
    started: float | None = None,
) -> Result:
    """Render `scene` by shooting light.

    transport: `rays` (shoot from a solved state), `walk` (random walks from the lights) or `bundles` (the whole scene at once along one
    direction after the other); None: `rays`, or with a time or a quality `bundles`, where rays are slow to solve and a trial finds these
    better.
    areas: `patches` or `pixels`, where the light in gloss is measured. estimator: `auto`,
    `weighted`, `regression` or `classical`. defensive: share of rays that starts anywhere, 0..1 (None: chosen by scene and
    estimator). gather: gathering rays for every glossy area in view per 2^20 shooting rays or 1024 directions, under one
    density with them (None: 16, fewer where cameras are so many that this is more than 4 for a shooting ray, and 0 for `classical`).
    weight_diffuse: weigh diffuse light, too (None: where the estimator
    is `auto` and defensive rays cover all directions). first_shot: compute direct light apart. One budget: rays (shooting rays),
    directions (of bundles), time (s, from `started` until the picture is complete) or error (relative); with none,
    `quality` (draft, medium, high) sets the work. patches: how many, about (None: 20,000 more than there are triangles; fewer
    in less than 2 s of all threads together, and up to 150,000 more where they are adaptive and the time is long or the quality high).
    adaptive: a short look at the light makes them small where it varies, above all in view; else, and with bundles, all are about as large
    (None: in all but short renders: a draft, less than 2.5 s for each 25,000 triangles, or less than 4 M rays). camera: a name, `all`, or
    None for the first. size: (width, height) in pixels. threads: 0 for all. layers: names that the result must have. window: pixels of an
    edge of the square that bundles are rasterised into, 16 to 4096 (None: about 16 pixels a patch). iteration: bundles carry the light of a
    solved state (`frozen`), or what the bundle before brought (`plain`, as in the paper). isa: the instruction set that rays are traced
    with, `avx2` or `avx512` (None: the best that there is). explain: the result tells where the light went and what was made of it.
    progress is called now and then; draft is given a first result after a second or so, then better ones, each after twice the time;
    interrupted is asked between steps, and True ends the work early with a valid result. started: time.monotonic() of when the files were
    read. Equal seed and rays, directions or quality give equal bytes for any number of threads, and with an isa on any machine that has it.

    Raises SettingsError or SceneError with all that is wrong.
    """
    started = clock.monotonic() if started is None else started
    if not isinstance(scene, Scene):
        raise SettingsError(f"scene is {scene!r:.80}; allowed: a lumel.Scene, such as lumel.load makes")
    scene, framed = with_camera(scene)
    settings = Settings(
        transport, areas, estimator, defensive, gather, weight_diffuse, first_shot, rays, time, error, patches, adaptive, quality, camera,
        size, seed, threads, layers, directions, window, iteration, isa,
    )  # fmt: skip
    settings.check(scene)
    cameras = settings.cameras(scene)
    views = [camera_to_core(c) for c in cameras]
    triangles = scene.triangle_count
    more_patches = settings.more_patches(triangles)
    even, left_out = to_core(scene, patches, min(MORE_PATCHES, more_patches))
    adaptive_patches = wanted_patches(even.triangles, patches, more_patches) if settings.wants_adaptive(triangles) else 0

    def session(transport: str, adaptive_patches: int) -> _core.Session:
        return _core.Session(
            scene=even,
            cameras=views,
            transport=transport,
            areas=areas,
            estimator=estimator,
            defensive=-1.0 if defensive is None else defensive,
            gather=settings.gather_rays(),
            most_gathering=MOST_GATHERING if gather is None else 0.0,
            weight_diffuse=weight_diffuse,
            first_shot=first_shot,
            direct_samples=DIRECT_SAMPLES,
            seed=seed,
            threads=settings.thread_count(),
            iteration=iteration,
            window=window or 0,
            adaptive_patches=adaptive_patches,
            isa=isa,
        )

    pixels = sum(c.width * c.height for c in cameras)
    first = settings.first_transport
    at = Work(session(first, adaptive_patches), len(cameras), pixels, first, iteration == "plain", window)
    schedule = Schedule(at, started, progress, interrupted or (lambda: False))
    if settings.is_free:
        schedule.other = lambda: session(OTHER, 0)
    else:
        schedule.why = _why_first(settings)

    def result(explained: bool) -> Result:
        session, core = schedule.at.session, schedule.at.session.scene
        layers = [session.layers(i) for i in range(len(cameras))]
        schedule.error = math.hypot(*errors_of(layers))
        pictures = {c.name: _picture(of) for c, of in zip(cameras, layers, strict=True)}
        stats = _stats(session, schedule, clock.monotonic() - started, core)
        if estimator == "auto":
            stats["why_estimator"] = why_auto(session, cameras)
        used = replace(settings, transport=schedule.at.transport)
        notes = (*scene.notes, *framed, *left_out, *_dark(scene, pictures), *_uncovered(used, stats), *_bundled(used, stats))
        story = _explanation(core, session, scene, used, stats) if explained else None
        return Result(pictures, _patches(core, session, scene), _metadata(scene, settings, stats), stats, notes, story)

    if draft:
        schedule.draft = lambda: draft(result(explained=False))
    _work(schedule, settings)
    return result(explain)


def _work(schedule: Schedule, settings: Settings) -> None:
    """Do what the budget asks for; with none, what the quality does."""
    if settings.time is not None:
        schedule.by_time(settings.time)
    elif settings.error is not None:
        schedule.by_error(settings.error)
    elif given := settings.rays or settings.directions:
        schedule.by_work(given, QUALITIES[settings.quality].samples)
    else:
        quality, pace, patches = QUALITIES[settings.quality], schedule.at.pace, schedule.at.patches
        units = quality.directions if pace.unit == "directions" else max(quality.rays, quality.rays_per_patch * patches)
        schedule.by_quality((units * pace.rays + RAYS_PER_SAMPLE * quality.samples * schedule.at.pixels) / WorkClock.SPEED)


def _why_first(settings: Settings) -> str:
    """Why a render begins with its transport, and stays with it."""
    if settings.transport is not None:
        return "as asked for"
    if settings.beyond_bundles:
        return f"by default, since bundles have no {settings.beyond_bundles}"
    return "by default, since " + ("an error" if settings.error else "its work") + " is given"


def describe(scene: Scene, patches: int | None = None) -> dict[str, Any]:
    """What is in a scene: `patches`, `triangles`, `degenerate`, `duplicate`, `huge`, `nonfinite` (counts), `memory_bytes` that a render
    of the first camera will take, `surface_area` (m2), `power` (W, RGB), `lights` (list of `name`, `kind`, `power`). Raises SceneError."""
    core, _ = to_core(scene, patches)
    report = core.report
    lights: list[dict[str, Any]] = [
        {"name": mesh.name, "kind": "area", "power": tuple(math.pi * area * e for e in mesh.emission)}
        for mesh, area in zip(scene.meshes, core.lamp_areas, strict=True)
        if area > 0
    ]
    lights += [{"name": light.name, "kind": "point", "power": tuple(4 * math.pi * i for i in light.intensity)} for light in scene.lights]
    return {
        "patches": core.patches,
        "triangles": core.triangles,
        **{key: report[key] for key in ("degenerate", "duplicate", "huge", "nonfinite")},
        "memory_bytes": expected(scene, Settings(patches=patches)),
        "surface_area": core.total_area,
        "power": tuple(float(p) for p in np.sum([light["power"] for light in lights], axis=0)) if lights else (0.0, 0.0, 0.0),
        "lights": lights,
    }


def with_camera(scene: Scene) -> tuple[Scene, tuple[str, ...]]:
    """The scene with at least one camera, and a note if one had to be framed."""
    if scene.cameras or not scene.meshes:
        return scene, ()
    from .readers.defaults import framed_camera

    return replace(scene, cameras=(framed_camera(scene.meshes),)), ("the scene has no camera: one that sees all of it was added",)


def scene_hash(scene: Scene) -> str:
    """SHA-256 over all that a picture depends on, in hexadecimal."""
    digest = hashlib.sha256()
    for mesh in scene.meshes:
        digest.update(repr((mesh.name, mesh.material, mesh.emission, mesh.normals is None)).encode())
        for array in (mesh.vertices, mesh.triangles, mesh.normals):
            digest.update(b"" if array is None else np.ascontiguousarray(array).tobytes())
    digest.update(repr((sorted(scene.materials.items()), scene.lights)).encode())
    for camera in scene.cameras:
        view = (camera.fov, camera.fov_axis, camera.width, camera.height)
        digest.update(repr((camera.name, np.asarray(camera.to_world).tolist(), *view)).encode())
    return digest.hexdigest()


def _explanation(core: _core.Scene, session: _core.Session, scene: Scene, settings: Settings, stats: dict[str, object]) -> Explanation:
    return explain(session, scene, core.lamp_areas, settings.cameras(scene), settings.first_transport, settings.estimator, stats)


def _dark(scene: Scene, pictures: dict[str, dict[str, FloatArray]]) -> Iterator[str]:
    """Say why pictures are black."""
    if not any(max(mesh.emission) > 0 for mesh in scene.meshes) and not any(max(light.intensity) > 0 for light in scene.lights):
        yield "the scene has no light: the picture is black"
        return
    for name, picture in pictures.items():
        if not picture["rgb"].any():
            yield f"camera '{name}' sees no light at all: it may be inside a wall"


def _uncovered(settings: Settings, stats: dict[str, object]) -> Iterator[str]:
    """Say where estimators that divide by the density cannot be trusted."""
    share = float(str(stats["flagged"]))
    if settings.estimator != "classical" and settings.transport != "bundles" and share > WORTH_SAYING:
        yield (
            f"the sampling density does not cover what {share:.0%} of the glossy areas in view reflect (layer 'flag'): "
            "they may be too bright; gather (--gather) or shoot from everywhere (--defensive)"
        )


def _bundled(settings: Settings, stats: dict[str, object]) -> Iterator[str]:
    """Say where bundles lose light, or cannot be averaged."""
    if settings.transport != "bundles":
        return
    violations, escaped, mispaired = (
        float(str(stats[key])) for key in ("parity_violations_per_million", "escaped_share", "mispaired_share")
    )
    if violations > PARITY_WORTH_SAYING:
        yield (
            f"{violations:.3g} of a million lines do not enter and leave closed meshes in turn, so these cross themselves: {mispaired:.2%} "
            "of the light of the bundles went between faces that look the same way"
        )
    if not stats["open"] and escaped > LEAK_WORTH_SAYING:
        yield f"{escaped:.2%} of the light of the bundles left the scene, which looked closed: it has gaps"
    growth = float(str(stats.get("variance_growth", 0)))
    if growth >= 1:
        yield (
            f"the plain iteration multiplies its variance by {growth:.2g} with every direction in this scene, so its noise has no bound; "
            "leave out --iteration plain"
        )


def _metadata(scene: Scene, settings: Settings, stats: dict[str, object]) -> dict[str, str]:
    from . import __version__

    return {
        "software": "lumel",
        "version": __version__,
        "scene": scene.source,
        "scene hash": scene_hash(scene),
        "transport": str(stats["transport"]),
        "why transport": str(stats["why_transport"]),
        "areas": settings.areas,
        "estimator": settings.estimator,
        "seed": str(settings.seed),
        "rays": str(stats["rays"]),
        **({"directions": str(stats["directions"])} if "directions" in stats else {}),
        "time": f"{stats['time']:.3f}",
        **settings.chosen(),
    }


def _picture(layers: dict[str, FloatArray]) -> dict[str, FloatArray]:
    parts = (layers[name] for name in ("emission", "direct", "indirect.diffuse", "indirect.specular"))
    layers.pop("stderr.solution")
    return {"rgb": np.asarray(sum(parts), dtype=np.float32), **layers}


def _stats(session: _core.Session, schedule: Schedule, seconds: float, core: _core.Scene) -> dict[str, object]:
    return {
        **session.stats,
        "transport": schedule.at.transport,
        "why_transport": schedule.why,
        "division": schedule.division,
        f"{schedule.at.pace.unit}_per_s": schedule.at.speed,
        "time": seconds,
        "error": schedule.error,
        "interrupted": schedule.was_interrupted,
        "patches": core.patches,
        "adaptive": not core.is_uniform,
        "borrowed": session.borrowed(),
        "unfilled": session.unfilled(),
        "flagged": session.flagged(),
    }


def _patches(core: _core.Scene, session: _core.Session, scene: Scene) -> Patches:
    geometry = core.patch_geometry()
    (direct, direct_var), (indirect, indirect_var) = session.direct(), session.indirect()
    irradiance = np.moveaxis(direct + indirect, 0, 1)
    materials = list(scene.materials.values())
    index = geometry[:, 7].astype(np.intp)
    albedo = np.array([m.diffuse for m in materials], np.float32)[index]
    back = np.array([m.two_sided for m in materials], np.float32)[index]
    sides = np.stack([np.ones_like(back), back], axis=1)[:, :, None] * albedo[:, None, :]
    stderr = np.sqrt(np.moveaxis(direct_var + indirect_var, 0, 1)) * sides
    return Patches(
        irradiance * sides, irradiance, stderr, geometry[:, 0], geometry[:, 1:4], geometry[:, 4:7], int(str(session.stats["replicas"]))
    )
