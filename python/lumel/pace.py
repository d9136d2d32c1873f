"""How fast work goes: how that of a transport is dealt out, and the clocks that a budget is measured by."""

from __future__ import annotations

import math
import time
from dataclasses import dataclass, replace
from typing import Literal, Protocol

from . import _core

RAYS_PER_STEP = 1 << 22  # what a step costs for every patch is little then, beside its rays
DIRECTIONS_PER_STEP = 128  # a thread more or less hardly shows at the end of so many
RAYS_PER_SAMPLE = 3.5  # of the eye: rays that could be shot in its time, see docs/performance.md
RAYS_PER_PATCH_SWEPT = 0.43  # that could be shot while a bundle is cast, for every patch,
RAYS_PER_EDGE_SWEPT = 0.12  # and for every pixel along the edges of patches: see docs/performance.md
FRAGMENTS_PER_PATCH = 8.0  # pixels that a patch covers in the mean, where no window is given


@dataclass(frozen=True)
class Pace:
    """How the work of a transport, in units of its own, is dealt out."""

    unit: Literal["rays", "directions"]
    per_replica: int  # below this, fewer replicas are better
    most_per_replica: int  # above this, more replicas are better: what a replica solved stays as it is
    per_step: int  # between two looks at the clock
    least: int  # of a step
    rays: float  # shot in the time of a unit, about


RAYS = Pace("rays", 100_000, 1 << 25, RAYS_PER_STEP, 256, 1.0)


def pace_of(transport: str, scene: _core.Scene, window: int | None, *, plain: bool) -> Pace:
    """How work with a transport is dealt out. `window`: pixels of an edge of that of bundles (None: chosen by the size of patches);
    `plain`: are they iterated as the paper does? Then many directions pass before a replica has settled."""
    if transport != "bundles":
        return RAYS
    bundles = Pace("directions", 64, 1 << 14, DIRECTIONS_PER_STEP, 1, rays_of_direction(scene, window))
    return replace(bundles, per_replica=1024) if plain else bundles


def rays_of_direction(scene: _core.Scene, window: int | None) -> float:
    """Rays that could be shot in the time of one direction of bundles, the same on every machine; right within some 30 %.

    A sweep makes every patch ready, and then goes from row to row along the edges of patches, which are sqrt(patches fragments) pixels
    long, up to a factor.
    """
    edges = math.sqrt(scene.patches * fragments_of_direction(scene, window))
    return RAYS_PER_PATCH_SWEPT * scene.patches + RAYS_PER_EDGE_SWEPT * edges


def fragments_of_direction(scene: _core.Scene, window: int | None) -> float:
    """Pixels that all patches cover, in the mean over all directions: of each half of its area."""
    if window is None:
        return FRAGMENTS_PER_PATCH * scene.patches
    return scene.total_area / 2 * ((window - 2) / (2 * scene.radius)) ** 2  # the ball around the scene fills all but 2 pixels of an edge


class Clock(Protocol):
    """Seconds from some moment on."""

    def now(self) -> float:
        """The time."""

    def spend(self, rays: float) -> None:
        """Work was done that takes about as long as shooting so many rays."""


class WallClock:
    """The clock of the machine."""

    def now(self) -> float:
        """Seconds of time.monotonic()."""
        return time.monotonic()

    def spend(self, rays: float) -> None:
        """Nothing to note: the time went by."""


class WorkClock:
    """The clock of a machine that shoots SPEED rays a second whatever else it does. What is decided by it is the same everywhere, and for
    any number of threads."""

    SPEED = 5e6

    def __init__(self) -> None:
        self._seconds = 0.0

    def now(self) -> float:
        """Seconds that all work so far takes."""
        return self._seconds

    def spend(self, rays: float) -> None:
        """Add the time of some work."""
        self._seconds += rays / self.SPEED
