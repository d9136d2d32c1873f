"""How fast work goes: how that of a transport is dealt out, and the clocks that a budget is measured by."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from typing import Literal, Protocol

RAYS_PER_STEP = 1 << 22  # what a step costs for every patch is little then, beside its rays


@dataclass(frozen=True)
class Pace:
    """How the work of a transport, in units of its own, is dealt out."""

    unit: Literal["rays", "directions"]
    per_replica: int  # below this, fewer replicas are better
    most_per_replica: int  # above this, more replicas are better: what a replica solved stays as it is
    per_step: int  # between two looks at the clock
    least: int  # of a step
    rays: float  # shot in the time of a unit, about: to know the size of a solve before anything was timed


RAYS = Pace("rays", 100_000, 1 << 25, RAYS_PER_STEP, 256, 1.0)
BUNDLES = Pace("directions", 64, 1 << 14, 128, 1, 10_000.0)
PLAIN = replace(BUNDLES, per_replica=1024)  # bundles as the paper iterates them: many directions pass before a replica has settled


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
