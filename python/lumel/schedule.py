"""The order of work in a render: replicas of the solve first, then passes of the eye, within a budget of work, time or error."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from . import _core
from .error_bars import errors
from .pace import WorkClock
from .progress import Phase, Progress
from .trial import MOST_PATCHES, OTHER, SOLVE_HARD, is_better, trial_seconds
from .work import FEWEST_REPLICAS, FEWEST_WITH_SPREAD, SOLVE_SHARE, Work

SHOOT_SHARE = 0.4  # of the time that is left after the scene is ready, while nothing is known of it
SHOOT_SHARES = (0.3, 0.6)  # that a look may choose: what is rare, it has not seen, and between these the error hardly changes
LOOK_AFTER = 3  # replicas, a first look at the pictures divides the time
LOOK_SAMPLES = 2  # a pixel and pass of that look
SHORTEST_LOOK = 1.0  # s that must be left for a look to pay
DRAFT_REPLICAS, DRAFT_RAYS = 2, 1 << 16  # of the first draft, and of each of its replicas
SHORTEST_WITH_DRAFT = 4.0  # s that a render must have to begin with a draft
PASS_SAMPLES = 8  # of the largest pass of the eye, for the mean pixel; each tells where to look next, and their spread what to believe
SAMPLES_TO_ERROR = 32  # a pixel, of the first picture on the way to an error
INTERRUPTED_SAMPLES = 8  # a pixel at least, after an interruption
FEWEST_PASSES = 2  # the spread of the passes is part of the error bars


@dataclass
class Schedule:
    """Runs the work `at`. `interrupted` is asked between steps; `show` is told where things are; `draft` is called when films hold a first
    picture, and when they hold a better one after twice the time; `started` is on time.monotonic()."""

    at: Work
    started: float
    show: Callable[[Progress], None] | None = None
    interrupted: Callable[[], bool] = lambda: False
    draft: Callable[[], None] | None = None
    other: Callable[[], _core.Session] | None = None  # makes a session of the transport to try, where another may be chosen
    error: float = math.nan
    was_interrupted: bool = False
    why: str = "by default, since there was no time for a look at what another would bring"  # the transport was chosen
    division: str = ""  # of the time between shooting and seeing, in words
    _drafted: float = field(default=0.0, init=False)  # seconds after the start
    _begun: float = field(default=0.0, init=False)  # on the clock of the work: the start,
    _end: float = field(default=math.inf, init=False)  # and the end

    # What a budget means

    def by_work(self, work: int, samples: int) -> None:
        """Shoot `work` rays in all, or cast as many bundles, then see with `samples` samples a pixel."""
        if work * self.at.pace.rays > 16 * DRAFT_RAYS:
            self._first_draft()
        replicas = self.at.replicas(work)
        for replica in range(replicas):
            self._replica(work * (replica + 1) // replicas - work * replica // replicas, lambda: self.at.done / work * 0.7)
            if self._stop():
                break
            self._draft_of_fields()
        self.at.session.reconstruct()
        self._see(samples)

    def by_time(self, seconds: float) -> None:
        """Shoot and see until `seconds` after the start."""
        self._begun = self.started
        self._divide(seconds)

    def by_quality(self, seconds: float) -> None:
        """Do what takes so many seconds on the clock that counts work."""
        self.at.clock = WorkClock()
        self._divide(seconds)

    def _divide(self, seconds: float) -> None:
        """Spend `seconds` of the clock on shooting and seeing. The share of each follows from what it brought in a first look."""
        end = self._end = self._begun + seconds
        if seconds >= SHORTEST_WITH_DRAFT:
            self._first_draft()
        if not self._shoot(end):
            self._shoot(end)
        self.at.session.reconstruct()
        self._see_until(end)

    def _shoot(self, end: float) -> bool:
        """Replicas, for their share of the time until `end`. Gives False if another transport was found better on the way, which then has
        to begin."""
        begin = self.at.clock.now()
        seconds = max(0.0, end - begin)
        stop = begin + seconds * SHOOT_SHARE
        self.division = f"{SHOOT_SHARE:.0%} for shooting and the rest for seeing, since there was no time for a look at the error of each"
        replicas, replica, start, each = 1, 0, 0.0, 0.0
        while replica < replicas and not (replica > 0 and self._stop()):
            slot = max(0.0, stop - self.at.clock.now()) / (replicas - replica)
            # Replicas count alike, so what has no time to solve as well as the others must not begin.
            if replica >= FEWEST_WITH_SPREAD and slot < each / 2:
                break
            if replica > 0:
                self.at.replica(max(slot, each / 2), self._stop_or_tell)
            else:
                # The start of the first replica tells what a start costs, and its first step how fast work is.
                self.at.begin(self.at.pilot_rays(seconds))
                start = self.at.shot
                self.at.first_step(seconds)
                replicas = self.at.replicas(int((stop - begin) * self.at.step_speed), int((stop - begin) / 4 / max(start, 1e-3)))
                self.at.steps_until(begin + (stop - begin) / replicas, self._stop_or_tell)
                self.at.session.end_replica()
            replica += 1
            self._draft_of_fields()
            each = (self.at.clock.now() - begin) / replica
            if replica == LOOK_AFTER and replicas > LOOK_AFTER and (needed := self._look(end)) is not None:
                if self._another_is_better(needed, start, each):
                    return False
                share = min(SHOOT_SHARES[1], max(SHOOT_SHARES[0], needed))
                stop = begin + seconds * share
                self.division = f"{share:.0%} for shooting and the rest for seeing, by a look at the error of each"
                replicas = replica + max(0, round((stop - self.at.clock.now()) / each))
        return True

    def by_error(self, target: float) -> None:
        """Double the work until the estimated error of the pictures is below `target`."""
        self._first_draft()
        work, samples = 2 * self.at.pace.per_replica * FEWEST_REPLICAS, SAMPLES_TO_ERROR
        while True:
            for _ in range(FEWEST_REPLICAS):
                self._replica(work // FEWEST_REPLICAS, lambda: min(0.99, (target / self.error) ** 2 if self.error > 0 else 0.0))
                if self._stop():
                    break
                self._draft_of_fields()
            self.at.session.reconstruct()
            self._see(samples)
            solution, eye = errors(self.at.session, self.at.cameras)
            self.error = math.hypot(solution, eye)
            if self.error <= target or self.was_interrupted:
                return
            # Each part shall come below its half of the squared error; at most eight times the work at once.
            share = target / math.sqrt(2) * 0.95
            work = int(self.at.done * min(8.0, max(0.0, (solution / share) ** 2 - 1)))
            work = max(work, FEWEST_REPLICAS * 4 * self.at.pace.least)
            samples = math.ceil(samples * min(8.0, max(1.0, (eye / share) ** 2)))

    # Steps

    def _replica(self, work: int, fraction: Callable[[], float]) -> None:
        """One replica of `work` in all."""
        before = self.at.done
        self.at.begin(int(work * self.at.pace.rays * SOLVE_SHARE))
        while True:
            left = work - (self.at.done - before)
            if left < max(self.at.pace.least, work * 0.01) and self.at.session.steps > 0:
                break
            begin = self.at.done
            self.at.step(max(left, self.at.pace.least) if left < 1.5 * self.at.largest_step else self.at.largest_step)
            self._tell("shoot", fraction())
            nothing_to_shoot = self.at.done == begin
            done = self.at.transport == "walk" and self.at.done - before >= work * 0.8
            if nothing_to_shoot or done or self._stop():
                break
        self.at.session.end_replica()

    def _see(self, samples: int) -> None:
        """`samples` samples a pixel for every camera; after an interruption as few as make a picture."""
        done = passes = 0
        while done < samples or passes < FEWEST_PASSES:
            if done >= INTERRUPTED_SAMPLES and self._stop():
                return
            size = max(1, min(self._next_pass(done), samples - done))
            self.at.see(size)
            done, passes = done + size, passes + 1
            self._tell("eye", 0.7 + 0.3 * min(1.0, done / samples))
            self._draft_of_films(passes)

    def _see_until(self, end: float) -> None:
        """As many samples as there is time for, in at least FEWEST_PASSES."""
        done = passes = 0
        cost = 0.0  # seconds a sample
        while True:
            size = self._next_pass(done)
            room = (end - self.at.clock.now()) / cost if passes else 1.0
            if passes >= FEWEST_PASSES and (self._stop() or room < size / 4):
                return
            size = max(1, min(size, int(room)))
            cost = self.at.timed_see(size) / size
            done, passes = done + size, passes + 1
            self._tell("eye", self._fraction())
            self._draft_of_films(passes)

    @staticmethod
    def _next_pass(done: int) -> int:
        """Samples of the next pass after `done` samples: as many again, and two at least: one that missed a small lamp is no measure."""
        return max(2, min(done, PASS_SAMPLES))

    def _another_is_better(self, needed: float, start: float, replica: float) -> bool:
        """Where rays need a large share of the time, so that another transport may be worth more, try it; go on with it if it is. `start`
        and `replica` are the seconds that a replica takes before it measures, and in all."""
        if self.other is None:
            return False
        seconds = trial_seconds(start, self._end - self._begun)
        if needed < SOLVE_HARD:
            self.why = (
                f"by default, since a look says that to solve takes {needed:.0%} of the time; from {SOLVE_HARD:.0%} on others are tried"
            )
        elif not seconds:
            self.why = "by default, since a trial of others would take too long"
        elif self.at.patches > MOST_PATCHES:
            self.why = f"by default, since others are tried up to {MOST_PATCHES:,} patches"
        elif self.at.session.scene.divided_sides:
            self.why = f"by default, since walls divide patches, through which {OTHER} let light"
        else:
            other, self.other = replace(self.at, session=self.other(), transport=OTHER), None
            better, self.why = is_better(other, self.at, seconds, lambda: self.at.replica(replica, self._stop_or_tell), self._stop_or_tell)
            if better:
                self.at = other
            return better
        return False

    def _first_draft(self) -> None:
        """A picture of few rays, soon after the start. What it shot is forgotten, so that the result is the same without it."""
        if not self.draft:
            return
        for _ in range(DRAFT_REPLICAS):
            self.at.session.begin_replica(DRAFT_RAYS)
            self.at.session.step(max(self.at.pace.least, int(DRAFT_RAYS / self.at.pace.rays)))
            self.at.session.end_replica()
        self._look_and_draft()
        self.at.session.forget()

    def _draft_of_fields(self) -> None:
        """A draft of the replicas so far, if one is due."""
        if self.draft and self._draft_is_due():
            self._look_and_draft()

    def _draft_of_films(self, passes: int) -> None:
        """A draft of the passes so far, if one is due."""
        if self.draft and passes >= FEWEST_PASSES and self._draft_is_due():
            self._hand_out_draft()

    def _look_and_draft(self) -> None:
        self.at.session.reconstruct()
        self.at.see(LOOK_SAMPLES)
        self._hand_out_draft()

    def _draft_is_due(self) -> bool:
        return time.monotonic() - self.started > 2 * self._drafted

    def _hand_out_draft(self) -> None:
        assert self.draft
        self.draft()
        self._drafted = time.monotonic() - self.started

    def _look(self, end: float) -> float | None:
        """The share of the time for shooting that makes the sum of both squared errors least, as a first look at the pictures tells; None
        where that would take too long.

        With errors that fall as 1/time, shooting and seeing should take times in proportion to the square roots of error^2 time.
        """
        if end - self.at.clock.now() < SHORTEST_LOOK:
            return None
        self.at.session.reconstruct()
        seeing = sum(self.at.timed_see(LOOK_SAMPLES) for _ in range(FEWEST_PASSES))
        if seeing > 0.1 * (end - self._begun):
            return None
        solution, eye = errors(self.at.session, self.at.cameras)
        self.error = math.hypot(solution, eye)
        shoot, see = solution * math.sqrt(self.at.shot), eye * math.sqrt(seeing)
        return shoot / (shoot + see) if shoot + see > 0 else SHOOT_SHARE

    def _fraction(self) -> float:
        """Of the time of the budget."""
        return min(1.0, (self.at.clock.now() - self._begun) / max(self._end - self._begun, 1e-9))

    def _stop(self) -> bool:
        self.was_interrupted = self.was_interrupted or self.interrupted()
        return self.was_interrupted

    def _stop_or_tell(self) -> bool:
        """The same between two steps, where it is told how far they are."""
        self._tell("shoot", self._fraction())
        return self._stop()

    def _tell(self, phase: Phase, fraction: float) -> None:
        if self.show is None:
            return
        elapsed = time.monotonic() - self.started
        fraction = min(1.0, fraction)
        remaining = elapsed / fraction - elapsed if fraction > 0 else math.nan
        self.show(Progress(phase, fraction, self.at.done, self.at.speed, self.error, elapsed, max(0.0, remaining), self.at.pace.unit))
