"""Whether another transport is better for a scene: it is tried for a while."""

from __future__ import annotations

from collections.abc import Callable

from .error_bars import Doubles, pictures, squared_difference
from .work import Work

OTHER = "bundles"  # is tried where rays, which all renders begin with, are slow to solve
SOLVE_HARD = 0.6  # of the time, which rays need where that is so
TRIAL_SHARE = 0.03  # of the time of a render for a trial; where starting takes long, it is
STARTS = 2  # times as long as the start of a replica, for each,
LONGEST_SHARE = 0.15  # but there is none that would take more
TRIAL_REPLICAS = 2
MOST_PATCHES = 1 << 19  # that a scene may have, since a trial needs memory for them of its own
CLEARLY = 0.5  # of the error of `rays` times time: what is less pays, though patches are even and what all pictures have wrong is not seen


def trial_seconds(start: float, seconds: float) -> float:
    """How long a trial takes in a render of so many seconds, where a replica takes `start` seconds before it measures; 0: there is none."""
    wanted = max(TRIAL_SHARE * seconds, TRIAL_REPLICAS * STARTS * start)
    return wanted if wanted <= LONGEST_SHARE * seconds else 0.0


def is_better(other: Work, work: Work, seconds: float, replica: Callable[[], None], stop: Callable[[], bool]) -> tuple[bool, str]:
    """Try `other` for so many seconds of the clock against `work`, which makes one more `replica` meanwhile: does it bring clearly less
    error in the same time? And why. `stop` is asked between steps. What `other` shot is forgotten."""
    # The fewer patches, the more light each has to tell its own from, and `other` has even ones: fewer, where the time is long.
    present = error_times_seconds(work, replica) * other.patches / work.patches
    found = tried(other, seconds, stop)
    other.forget()
    if stop():
        return False, "by default, since a trial of others was interrupted"
    better = found < CLEARLY * present
    (few, best), (many, worst) = ((found, other), (present, work)) if better else ((present, work), (found, other))
    ratio = many / max(few, 1e-300)
    return better, f"in a trial the squared error at equal time was {ratio:.2g} times that of {best.transport} with {worst.transport}"


def tried(work: Work, seconds: float, stop: Callable[[], bool]) -> float:
    """What `error_times_seconds` is after TRIAL_REPLICAS replicas from nothing, in so many seconds of the clock."""
    work.begin(work.pilot_rays(seconds))
    work.first_step(seconds)
    work.steps_until(work.clock.now() + seconds / TRIAL_REPLICAS - work.shot, stop)
    work.session.end_replica()
    return error_times_seconds(work, lambda: work.replica(seconds / TRIAL_REPLICAS, stop))


def error_times_seconds(work: Work, replica: Callable[[], None]) -> float:
    """Squared relative error of the solution after one more `replica`, times the seconds in which it was measured; infinite where it shows
    no light.

    The error is what that replica changes in the pictures. Error bars take patches as independent, but those that a bundle meets are
    not: smoothing makes the bars smaller, and the error stays (docs/results.md).
    """
    before = _seen(work)
    replica()
    # A mean M of n samples of variance V is off by V / n; it differs from the one before by E (M_n - M_{n-1})^2 = V / (n (n - 1)).
    return squared_difference(before, _seen(work)) * (int(str(work.session.stats["replicas"])) - 1) * work.stepped


def _seen(work: Work) -> list[Doubles]:
    """Pictures of the solution so far. Fields made anew are seen by the same samples as those before, whose noise falls out of a
    difference."""
    work.session.reconstruct()
    work.timed_see(1)
    return pictures(work.session, work.cameras)
