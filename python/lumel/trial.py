"""Which transport a scene is best rendered by: each is tried for a while."""

from __future__ import annotations

import math
from collections.abc import Callable

from .error_bars import pictures, squared_difference
from .work import Work

TRIED = ("rays", "bundles")
SHORTEST_WITH_TRIAL = 30.0  # s on the clock of the budget that a render must have to begin with a trial of them
TRIAL_SHARE, TRIAL_REPLICAS = 0.02, 3  # of the time for the trial of each
CLEARLY = 0.5  # of the error of `rays` times time: what is less pays, though patches are even and what all pictures have wrong is not seen


def has_time_for_trial(seconds: float | None) -> bool:
    """Is there a budget on a clock, and is it long enough to try transports at the start?"""
    return seconds is not None and seconds >= SHORTEST_WITH_TRIAL


def best_transport(work: Work, seconds: float, stop: Callable[[], bool]) -> tuple[str, str]:
    """Try each transport for so many seconds of the clock; gives the one that brings the least error in the same time, and why.
    `stop` is asked between steps."""
    first, *others = TRIED
    cost = {transport: try_transport(work, transport, seconds, stop) for transport in TRIED}
    if stop():
        return first, "by default, since the trial of others was interrupted"
    if math.isinf(cost[first]):
        return first, "by default, since a trial saw no light"
    best = min((t for t in others if cost[t] < CLEARLY * cost[first]), key=cost.__getitem__, default=first)
    compared = ", ".join(f"{cost[t] / max(cost[best], 1e-30):.2g} times that of {best} with {t}" for t in TRIED if t != best)
    return best, f"in a trial the squared error at equal time was {compared}"


def try_transport(work: Work, transport: str, seconds: float, stop: Callable[[], bool]) -> float:
    """Squared relative error of the solution that a transport reaches, times the seconds that this took; infinite where it shows no light,
    or was stopped.

    The error is what a last replica changes in the pictures. Error bars take patches as independent, but those that a bundle meets are
    not: smoothing makes the bars smaller, and the error stays (docs/results.md).
    """
    work.use(transport)
    seen = []
    for replica in range(TRIAL_REPLICAS):
        until = work.clock.now() + seconds / TRIAL_REPLICAS
        work.begin(work.pilot_rays(seconds))
        if replica == 0:
            work.first_step(seconds)
        work.steps_until(until, stop)
        work.session.end_replica()
        if stop():
            return math.inf
        if replica >= TRIAL_REPLICAS - 2:
            # Fields made anew are seen by the same samples as those before, whose noise falls out of the difference.
            work.session.reconstruct()
            work.timed_see(1)
            seen.append(pictures(work.session, work.cameras))

    # A mean M of n samples of variance V is off by V / n; it differs from the one before by E (M_n - M_{n-1})^2 = V / (n (n - 1)).
    return squared_difference(*seen) * (TRIAL_REPLICAS - 1) * work.shot
