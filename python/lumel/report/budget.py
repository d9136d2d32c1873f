"""The time of a report, dealt out to its works."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping

DRAWING = 0.08  # share of the time that drawing and writing take


class Budget:
    """`seconds` from now on for all works of `weights`: each gets its share of the time that is left when it begins."""

    def __init__(self, seconds: float, weights: Mapping[str, float]) -> None:
        self.started = time.monotonic()
        self.seconds = seconds
        self._waiting = dict(weights)

    @property
    def fraction(self) -> float:
        """Share of the time that is over, 0..1."""
        return min(1.0, (time.monotonic() - self.started) / self.seconds)

    @property
    def elapsed(self) -> float:
        """Seconds since the start."""
        return time.monotonic() - self.started

    def take(self, work: str) -> float:
        """Begin `work`; gives the seconds that it may take. What one work takes too long is shared by those after it."""
        left = self.started + self.seconds * (1 - DRAWING) - time.monotonic()
        share = self._waiting[work] / sum(self._waiting.values())
        del self._waiting[work]
        return max(0.0, left) * share


def until(seconds: float) -> Callable[[], bool]:
    """Whether less than so many seconds have passed from now on."""
    end = time.monotonic() + seconds
    return lambda: time.monotonic() < end
