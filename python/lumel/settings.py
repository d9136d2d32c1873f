"""What can be set for a render, checked all at once."""

from __future__ import annotations

import math
import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields
from numbers import Integral, Real
from typing import Literal

from . import _core
from .core import MORE_PATCHES
from .errors import Problem, SettingsError, nearest
from .result import DIAGNOSTICS, LAYERS
from .scene import Camera, Scene

TRANSPORTS = ("rays", "walk", "bundles")
DEFAULT_TRANSPORT = "rays"
LONGEST = 1e8  # s that a time may be
MOST_MORE_PATCHES = 150_000  # than triangles, where no number is given and they are adaptive,
SHORT_TIME = 2.0  # s of all threads below which fewer than MORE_PATCHES are better, in proportion to the time,
LEAST_PATCHES = 0.2  # but not less than this share of them
PATCHES_TIME = 16.0  # s of all threads from which on more than MORE_PATCHES pay, in proportion to the power 2/3 of the time
ADAPTIVE_TIME, ADAPTIVE_RAYS = 2.5, 4_000_000  # s and rays from which on adaptive ones pay,
MANY_TRIANGLES = 25_000  # where the scene has more, later in proportion: to look at it takes longer, and patches are small anyway
ITERATIONS = ("frozen", "plain")
WINDOWS = (16, 4096)  # least and most pixels of an edge
AREAS = ("patches", "pixels")
ISAS = ("avx2", "avx512")
GATHER = 16.0  # gathering rays an area and 2^20 shooting rays, where the estimator divides by their density: measured in docs/results.md
MOST_GATHERING = 4.0  # gathering rays for a shooting ray, where the number is not given: many cameras get fewer an area
LARGEST_PICTURE = 32_768  # pixels a side
BYTES_PER_PIXEL = 700  # of memory, for each camera
BYTES_PER_PATCH = 640


@dataclass(frozen=True)
class Quality:
    """Work that is done when no budget is given: shooting rays (at least, and a patch), or directions, and eye samples a pixel."""

    rays: int
    rays_per_patch: int
    directions: int
    samples: int


QUALITIES = {
    "draft": Quality(1_000_000, 20, 256, 16),
    "medium": Quality(10_000_000, 200, 2048, 64),
    "high": Quality(80_000_000, 1500, 16_384, 256),
}


@dataclass(frozen=True)
class Settings:
    """The settings of `lumel.render`, with the same names and defaults."""

    transport: str | None = None
    areas: str = "patches"
    estimator: str = "auto"
    defensive: float | None = None
    gather: float | None = None
    weight_diffuse: bool | None = None
    first_shot: bool = True
    rays: int | None = None
    time: float | None = None
    error: float | None = None
    patches: int | None = None
    adaptive: bool | None = None
    quality: str = "medium"
    camera: str | None = None
    size: tuple[int, int] | None = None
    seed: int = 0
    threads: int = 0
    layers: Sequence[str] | Literal["all"] | None = None
    directions: int | None = None
    window: int | None = None
    iteration: str = "frozen"
    isa: str | None = None

    def check(self, scene: Scene) -> None:
        """Raise SettingsError with all that is out of range or unknown."""
        views = () if any(self._kinds()) else self._views(scene)
        if problems := (*self.problems(), *(Problem(text) for text in views)):
            raise SettingsError(problems)

    def problems(self) -> tuple[Problem, ...]:
        """All that is out of range or unknown, whatever the scene."""
        kinds = tuple(self._kinds())
        # Ranges mean nothing for what is no number.
        ranges = () if kinds else (*self._budgets(), *self._bundles(), *self._numbers(), *self._sizes())
        return tuple(Problem(text) for text in (*self._names(), *kinds, *ranges))

    def cameras(self, scene: Scene) -> tuple[Camera, ...]:
        """The cameras to render, with the size that was asked for."""
        if self.camera == "all":
            chosen = scene.cameras
        elif self.camera is None:
            chosen = scene.cameras[:1]
        else:
            chosen = tuple(camera for camera in scene.cameras if camera.name == self.camera)
        return tuple(camera.with_size(*self.size) for camera in chosen) if self.size else chosen

    def chosen(self) -> dict[str, str]:
        """The settings that differ from their defaults, as text, by name: what it takes to make a picture again."""
        said = {f.name: getattr(self, f.name) for f in fields(self) if getattr(self, f.name) != f.default}
        return {
            name: str(value) for name, value in said.items() if name not in ("layers", "camera", "threads", "rays", "directions", "time")
        }

    @property
    def first_transport(self) -> str:
        """The transport to start with: the one that was asked for."""
        return DEFAULT_TRANSPORT if self.transport is None else self.transport

    @property
    def is_free(self) -> bool:
        """May another transport be chosen? Not where one is asked for, nor what only the first one has, nor work or an error."""
        return self.transport is None and self.beyond_bundles is None and self.is_on_clock

    @property
    def beyond_bundles(self) -> str | None:
        """What is asked for that bundles do not have, in words."""
        asked = {
            "defensive rays": self.defensive is not None,
            "weighed diffuse light": self.weight_diffuse is not None,
            "adaptive patches": bool(self.adaptive),
        }
        return next((name for name, is_asked in asked.items() if is_asked), None)

    @property
    def is_on_clock(self) -> bool:
        """Is the budget a time, or that of a quality, whose clock counts work? Not where work or an error is given."""
        return not (self.rays or self.directions or self.error)

    def more_patches(self, triangles: int) -> int:
        """How many more patches than triangles, of which the scene has so many, the budget pays for.

        The error of patches falls as a power of their number, and the noise of the light on each grows with it, as does the time before the
        eye can look; see docs/results.md.
        """
        if self.time is not None:
            seconds = self.time * self.thread_count()
            if not self.wants_adaptive(triangles):
                return int(MORE_PATCHES * min(1.0, max(LEAST_PATCHES, seconds / SHORT_TIME)))
            return int(min(MORE_PATCHES * max(1.0, seconds / PATCHES_TIME) ** (2 / 3), MOST_MORE_PATCHES))
        if not self.wants_adaptive(triangles):
            return MORE_PATCHES
        return MOST_MORE_PATCHES if self.quality == "high" and self.is_on_clock else MORE_PATCHES

    def wants_adaptive(self, triangles: int) -> bool:
        """Shall patches be small where the light varies? The look at it costs time, so not in the shortest renders by default."""
        if self.first_transport == "bundles" or self.adaptive is not None:
            return bool(self.adaptive)
        if self.time is not None or self.rays is not None:
            least = ADAPTIVE_TIME * max(1.0, triangles / MANY_TRIANGLES)
            return (self.time or 0) >= least or (self.rays or 0) >= ADAPTIVE_RAYS
        return self.error is not None or self.quality != "draft"

    def gather_rays(self) -> float:
        """Gathering rays for every measured area per 2^20 shooting rays."""
        if self.gather is not None:
            return self.gather
        return 0.0 if self.estimator == "classical" else GATHER

    def thread_count(self) -> int:
        """Threads to work with: 0 means as many as this process may use."""
        return self.threads or len(os.sched_getaffinity(0))

    def _names(self) -> Iterator[str]:
        choices = {
            "transport": (self.first_transport, TRANSPORTS),
            "areas": (self.areas, AREAS),
            "estimator": (self.estimator, tuple(_core.estimators())),
            "quality": (self.quality, tuple(QUALITIES)),
            "iteration": (self.iteration, ITERATIONS),
        }
        if self.isa is not None:
            choices["isa"] = (self.isa, ISAS)
        for name, (value, allowed) in choices.items():
            if value not in allowed:
                yield f"unknown {name} '{value}'; {nearest(str(value), allowed)}"
        if self.isa in ISAS and self.isa not in (here := _core.isas()):
            yield f"isa is {self.isa}, which this processor does not have; allowed: {', '.join(here)}"
        for layer in (self.layers,) if isinstance(self.layers, str) else self.layers or ():
            if layer not in ("all", "rgb", *LAYERS, *DIAGNOSTICS):
                yield f"unknown layer '{layer}'; {nearest(layer, ('all', 'rgb', *LAYERS, *DIAGNOSTICS))}"

    def _kinds(self) -> Iterator[str]:
        whole: dict[str, object] = {name: getattr(self, name) for name in ("rays", "directions", "window", "patches", "seed", "threads")}
        real: dict[str, object] = {"time": self.time, "error": self.error, "defensive": self.defensive, "gather": self.gather}
        for kind, allowed, values in ((Integral, "a whole number", whole), (Real, "a number", real)):
            for name, value in values.items():
                if not isinstance(value, kind) and (value is not None or name in ("seed", "threads")):
                    yield f"{name} is {value!r}; allowed: {allowed}"
        size: object = self.size
        if size is not None and not _is_pair(size):
            yield f"size is {size!r}; allowed: (width, height), two whole numbers of pixels"

    def _budgets(self) -> Iterator[str]:
        given = [name for name in ("rays", "directions", "time", "error") if getattr(self, name) is not None]
        if len(given) > 1:
            yield f"{' and '.join(given)} are given; allowed: one of them"
        if self.rays is not None and not 1 <= self.rays <= 10**13:
            yield f"rays is {self.rays}; allowed: 1 to 10^13"
        if self.directions is not None and not 1 <= self.directions <= 10**9:
            yield f"directions is {self.directions}; allowed: 1 to 10^9"
        if self.time is not None and not 0 < self.time <= LONGEST:
            yield f"time is {self.time:g}; allowed: more than 0 and at most {LONGEST:g} seconds"
        if self.error is not None and not 0 < self.error < math.inf:
            yield f"error is {self.error:g}; allowed: a finite number, more than 0"

    def _bundles(self) -> Iterator[str]:
        """What has a meaning with bundles alone, or with all but them."""
        bundles = self.first_transport == "bundles"
        for name in ("rays", "defensive", "weight_diffuse", "adaptive") if bundles else ("directions", "window", "iteration"):
            if (value := getattr(self, name)) != getattr(Settings, name):
                others = " and ".join(other for other in TRANSPORTS if (other == "bundles") != bundles)
                yield f"{name} is {value}, which the transport {self.first_transport} does not have; allowed: with {others}"
        if self.window is not None and not WINDOWS[0] <= self.window <= WINDOWS[1]:
            yield f"window is {self.window}; allowed: {WINDOWS[0]} to {WINDOWS[1]} pixels"

    def _numbers(self) -> Iterator[str]:
        if self.defensive is not None and not 0 <= self.defensive <= 1:
            yield f"defensive is {self.defensive:g}; allowed: 0 to 1, the share of defensive rays"
        if self.gather is not None and not 0 <= self.gather <= 65_536:
            yield f"gather is {self.gather:g}; allowed: 0 to 65536, gathering rays an area and 2^20 shooting rays"
        if self.patches is not None and not 1 <= self.patches <= 2**30:
            yield f"patches is {self.patches}; allowed: 1 to 2^30"
        if not 0 <= self.seed < 2**64:
            yield f"seed is {self.seed}; allowed: 0 to 2^64 - 1"
        if not 0 <= self.threads <= 1024:
            yield f"threads is {self.threads}; allowed: 0 (all) to 1024"

    def _views(self, scene: Scene) -> Iterator[str]:
        names = [camera.name for camera in scene.cameras]
        if self.camera not in (None, "all") and self.camera not in names:
            yield f"unknown camera '{self.camera}'; {nearest(str(self.camera), ['all', *names])}"
        cameras = self.cameras(scene)
        for camera in cameras if self.size is None else ():
            if not _is_size(camera.width, camera.height):
                yield f"camera '{camera.name}' has size {camera.width}x{camera.height}; allowed: 1x1 to {LARGEST_PICTURE}x{LARGEST_PICTURE}"
        if self.size is None or _is_size(*self.size):
            yield from _too_much("the pictures", sum(camera.width * camera.height for camera in cameras) * BYTES_PER_PIXEL)

    def _sizes(self) -> Iterator[str]:
        if self.size is not None and not _is_size(*self.size):
            yield f"size is {self.size[0]}x{self.size[1]}; allowed: 1x1 to {LARGEST_PICTURE}x{LARGEST_PICTURE}"
        if self.patches is not None and 1 <= self.patches <= 2**30:
            yield from _too_much(f"{self.patches:,} patches", self.patches * BYTES_PER_PATCH)


def memory_of_machine() -> int:
    """Bytes."""
    return os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")


def _is_pair(value: object) -> bool:
    return isinstance(value, tuple | list) and len(value) == 2 and all(isinstance(side, Integral) for side in value)


def _is_size(width: int, height: int) -> bool:
    return 1 <= width <= LARGEST_PICTURE and 1 <= height <= LARGEST_PICTURE


def _too_much(what: str, size: int) -> Iterator[str]:
    """Say so where `size` bytes are more than this machine has."""
    if size > (memory := memory_of_machine()):
        yield f"{what} would take about {size / 2**30:,.0f} GB of memory; this machine has {memory / 2**30:,.0f} GB"
