"""What a render did and why: where the light went, what the areas of interest got of it, and what the estimator made of that."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _core
from .scene import LUMINANCE, Camera, Scene

LAMP_RAYS = 4096  # to find out where a lamp shines
MOST_LAMPS = 64  # that are looked at one by one
MOST_AREAS = 1000  # that tell what `auto` was worth,
ALL_AREAS = 2**32 - 1  # where they are described
FLOOR = 0.01  # of the mean square, added where variances are compared with squares


@dataclass(frozen=True)
class Share:
    """A part of a whole: a mesh with its material, and its share, 0..1."""

    name: str
    share: float


@dataclass(frozen=True)
class LampStory:
    """A lamp: its share of the luminous power of all, what it shines on first (largest first), and how much leaves the scene."""

    name: str
    share: float
    onto: tuple[Share, ...]
    escaped: float


@dataclass(frozen=True)
class AreaStory:
    """The areas of interest of one camera.

    `hits`: 5 %, 50 % and 95 % quantiles of samples an area. Shares of the areas: `empty` took their neighbours' samples, `flagged` may
    be off, `filled` had G < 1 and were filled up, `lowered` had G > 1. `correction`: mean of |correction| over the mean value.
    `gain`: variance of the mean of f/p over that of the estimate, both relative, from the same samples: how many times more
    samples `classical` would need.
    """

    camera: str
    count: int
    hits: tuple[float, float, float]
    empty: float
    flagged: float
    filled: float
    lowered: float
    correction: float
    gain: float


@dataclass(frozen=True)
class BundleStory:
    """What bundles met on the lines of their windows.

    `fragments`: patches met, over all lines; `pairs`: neighbours on a line, which see each other; `mean_depth`: fragments a line that has
    any; `parity_violations`: lines of a million that do not enter and leave closed meshes in turn. Shares of the flux that was sent along
    lines: `received`, `escaped` (left the scene) and `mispaired` (of what was received: between neighbours of one closed mesh that look
    the same way); a closed scene of sound meshes has 1, 0 and 0.
    """

    directions: int
    directions_per_s: float
    window: int
    fragments: int
    pairs: int
    mean_depth: float
    parity_violations: float
    received: float
    escaped: float
    mispaired: float


@dataclass(frozen=True)
class Explanation:
    """`work`: shooting rays, or directions of bundles as `unit` says. `landed`: meshes by their share of the transfers, largest first (of
    bundles: one a patch and direction). `escaped`: share of the rays, or of the light of bundles, that left the scene.
    """

    transport: str
    estimator: str
    work: int
    unit: str
    lamps: tuple[LampStory, ...]
    more_lamps: int
    landed: tuple[Share, ...]
    escaped: float
    areas: tuple[AreaStory, ...]
    bundles: BundleStory | None


def explain(
    session: _core.Session,
    scene: Scene,
    lamp_areas: Sequence[float],
    cameras: Sequence[Camera],
    transport: str,
    estimator: str,
    stats: Mapping[str, Any],
) -> Explanation:
    """Look back at a finished `session`. `lamp_areas`: m2 for every mesh, 0 where it does not shine. `stats`: of the result."""
    names = [f"{mesh.name} ({mesh.material})" for mesh in scene.meshes]
    landed = session.landed()
    bundles = _bundles(stats) if transport == "bundles" else None
    lamps = _lamps(session, scene, lamp_areas, names)
    return Explanation(
        transport,
        estimator,
        bundles.directions if bundles else session.rays,
        "directions" if bundles else "rays",
        lamps[:MOST_LAMPS],
        max(0, len(lamps) - MOST_LAMPS),
        _largest(names, landed / max(1, int(landed.sum()))),
        bundles.escaped if bundles else stats["escaped_rays"] / max(1, session.rays),
        tuple(_areas(session, index, camera.name, estimator) for index, camera in enumerate(cameras)),
        bundles,
    )


def why_auto(session: _core.Session, cameras: Sequence[Camera]) -> str:
    """What the estimator `auto` was worth in the areas of the first camera, as some of them tell."""
    story = _areas(session, 0, cameras[0].name, "auto", MOST_AREAS)
    if story.count == 0:
        return "nothing glossy is in view that it could serve"
    return f"chosen area by area; classical would need {story.gain:.2g} times as many samples in the glossy areas in view"


def _bundles(stats: Mapping[str, Any]) -> BundleStory:
    return BundleStory(
        stats["directions"],
        stats["directions_per_s"],
        stats["window"],
        stats["fragments"],
        stats["pairs"],
        stats["mean_depth"],
        stats["parity_violations_per_million"],
        stats["received_share"],
        stats["escaped_share"],
        stats["mispaired_share"],
    )


def _lamps(session: _core.Session, scene: Scene, lamp_areas: Sequence[float], names: list[str]) -> tuple[LampStory, ...]:
    """The lamps, the most powerful first."""
    shining = [(mesh.name, math.pi * area * _lum(mesh.emission)) for mesh, area in zip(scene.meshes, lamp_areas, strict=True) if area > 0]
    powers = [*shining, *((light.name, 4 * math.pi * _lum(light.intensity)) for light in scene.lights)]
    total = sum(power for _, power in powers)
    if not total > 0:
        return ()
    stories = (
        LampStory(name, power / total, _largest(names, reach[:-1]), float(reach[-1]))
        for (name, power), reach in zip(powers, session.lamp_reach(LAMP_RAYS), strict=True)
    )
    return tuple(sorted(stories, key=lambda lamp: -lamp.share))


def _areas(session: _core.Session, index: int, camera: str, estimator: str, most: int = ALL_AREAS) -> AreaStory:
    areas = session.areas(index, estimator, most)
    count = len(areas["index"])
    if count == 0:
        return AreaStory(camera, 0, (0, 0, 0), 0, 0, 0, 0, 0, 1)
    value, plain = (np.asarray(areas[key]) @ LUMINANCE for key in ("value", "mean"))
    own = areas["borrowed"] == 0
    scale = value**2 + FLOOR * np.mean(value**2)
    scale[~(scale > 0)] = 1
    error, classical_error = (
        np.mean((areas[key] @ LUMINANCE)[own] / scale[own]) if own.any() else 0.0 for key in ("variance", "mean.variance")
    )
    low, middle, high = (float(q) for q in np.quantile(areas["hits"], (0.05, 0.5, 0.95)))
    return AreaStory(
        camera,
        count,
        (low, middle, high),
        float(np.mean(~own)),
        float(np.mean(areas["flag"])),
        float(np.mean(own & (areas["weight"] < 1))),
        float(np.mean(own & (areas["weight"] > 1))),
        float(np.mean(np.abs(value - plain)[own]) / max(float(np.mean(value)), 1e-300)) if own.any() else 0.0,
        float(classical_error / error) if error > 0 else 1.0,
    )


def _lum(rgb: Sequence[float]) -> float:
    return float(np.dot(rgb, LUMINANCE))


def _largest(names: Sequence[str], shares: npt.NDArray[np.floating[Any]], most: int = 5) -> tuple[Share, ...]:
    """The largest shares that are not 0."""
    order = np.argsort(-shares, kind="stable")[:most]
    return tuple(Share(names[i], float(shares[i])) for i in order if shares[i] > 0)
