"""The order of work in a render: replicas of the solve first, then passes of the eye, within a budget of work, time or error."""

from __future__ import annotations

import math
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from . import _core
from .error_bars import errors
from .pace import BUNDLES, PLAIN, RAYS, Clock, Pace, WallClock, WorkClock
from .progress import Phase, Progress

REPLICAS = 16  # independent solves that error bars rest on
FEWEST_REPLICAS = 4
LARGEST_SOLVE = (1 << 21, 4)  # rays of the solve of a replica, or rays a patch if that is more
LARGEST_PILOT = 1 << 19  # rays of a first step, to know how fast work is
RAYS_PER_PATCH = 8  # of a replica: below this, fewer replicas are better
SOLVE_SHARE = 0.25  # of a replica's time, for its own solution by power (transports `rays` and `bundles`)
SHOOT_SHARE = 0.4  # of the time that is left after the scene is ready, while nothing is known of it
SHOOT_SHARES = (0.3, 0.6)  # that a look may choose: what is rare, it has not seen, and between these the error hardly changes
LOOK_AFTER = 3  # replicas, a first look at the pictures divides the time
LOOK_SAMPLES = 2  # a pixel and pass of that look
SHORTEST_LOOK = 1.0  # s that must be left for a look to pay
DRAFT_REPLICAS, DRAFT_RAYS = 2, 1 << 16  # of the first draft, and of each of its replicas
SHORTEST_WITH_DRAFT = 4.0  # s that a render must have to begin with a draft
TRIED = ("rays", "bundles")  # transports that a time is worth trying for
SHORTEST_WITH_TRIAL = 30.0  # s that a render must have to begin with a trial of them
TRIAL_SHARE, TRIAL_REPLICAS = 0.04, 3  # of the time for the trial of each
CLEARLY = 0.7  # of the error of `rays` times time: what is less pays
PASS_SAMPLES = 16  # of the largest pass of the eye, for the mean pixel; passes grow to it, since what each saw tells where to look next
INTERRUPTED_SAMPLES = 8  # a pixel at least, after an interruption
FEWEST_PASSES = 2  # the spread of the passes is part of the error bars
RAYS_PER_SAMPLE = 3.5  # of the eye: rays that could be shot in its time, see docs/performance.md
RAYS_PER_PATCH_LIT = 8  # the same of the first shot of a replica, for every patch


def has_time_for_trial(seconds: float | None) -> bool:
    """Is there a time, and is it long enough to try transports at the start?"""
    return seconds is not None and seconds >= SHORTEST_WITH_TRIAL


@dataclass
class Schedule:
    """Runs a session. `interrupted` is asked between steps; `show` is told where things are; `draft` is called when films hold a first
    picture, and when they hold a better one after twice the time; `started` is on time.monotonic()."""

    session: _core.Session
    cameras: int
    pixels: int  # of all cameras
    transport: str
    free: bool  # shall the transport be chosen in a trial, if a time is the budget?
    plain: bool  # are bundles iterated plainly?
    started: float
    show: Callable[[Progress], None] | None = None
    interrupted: Callable[[], bool] = lambda: False
    draft: Callable[[], None] | None = None
    refine: Callable[[], _core.Session] | None = None  # makes a session of adaptive patches, for the transports that know them
    error: float = math.nan
    was_interrupted: bool = False
    why: str = ""  # the transport was chosen
    _drafted: float = field(default=0.0, init=False)  # seconds after the start
    _clock: Clock = field(default_factory=WallClock, init=False)  # of the budget
    _begun: float = field(default=0.0, init=False)  # on that clock: the work
    _end: float = field(default=math.inf, init=False)  # and the time
    _shot: float = field(default=0.0, init=False)  # seconds of that clock spent shooting
    _shooting_s: float = field(default=0.0, init=False)  # the same by the wall
    _step_speed: float = field(default=0.0, init=False)  # work a second of the last step
    _solve_speed: float = field(default=0.0, init=False)  # rays a second of the last solve,
    _solved: int = field(default=0, init=False)  # and its rays

    # What a budget means

    def by_work(self, work: int, samples: int) -> None:
        """Shoot `work` rays in all, or cast as many bundles, then see with `samples` samples a pixel."""
        if work * self.pace.rays > 16 * DRAFT_RAYS:
            self._first_draft()
        replicas = self._replicas(work)
        for replica in range(replicas):
            self._replica(work * (replica + 1) // replicas - work * replica // replicas, lambda: self.work / work * 0.7)
            if self._stop():
                break
            self._draft_of_fields()
        self.session.reconstruct()
        self._see(samples)

    def by_time(self, seconds: float) -> None:
        """Shoot and see until `seconds` after the start."""
        self._begun = self.started
        self._divide(seconds)

    def by_quality(self, work: int, samples: int) -> None:
        """Do as much as it takes to shoot `work` rays, or cast as many bundles, and to see with `samples` samples a pixel."""
        self._clock = WorkClock()
        self._divide((work * self.pace.rays + self._rays_of_eye(samples)) / WorkClock.SPEED)

    def _divide(self, seconds: float) -> None:
        """Spend `seconds` of the clock on shooting and seeing. The share of each follows from what it brought in a first look."""
        end = self._end = self._begun + seconds
        if seconds >= SHORTEST_WITH_DRAFT:
            self._first_draft()
        if self.free:
            self._choose_transport(seconds * TRIAL_SHARE)
        begin = self._clock.now()
        stop = begin + max(0.0, end - begin) * SHOOT_SHARE
        replicas, replica = 1, 0
        while replica < replicas and not (replica > 0 and self._stop()):
            # The start of the first replica tells what a start costs, and its first step how fast work is.
            before = self._clock.now()
            slot = max(0.0, stop - before) / (replicas - replica)
            self._begin(self._pilot_rays(seconds) if replica == 0 else int(slot * SOLVE_SHARE * self._solve_speed))
            if replica == 0:
                started = self._clock.now() - before
                self._step(max(self.pace.least, int(self._pilot_rays(seconds) / self.pace.rays)))
                replicas = self._replicas(int((stop - begin) * self._step_speed), int((stop - begin) / 4 / max(started, 1e-3)))
                slot = (stop - begin) / replicas
            self._steps_until(before + slot)
            self.session.end_replica()
            replica += 1
            self._draft_of_fields()
            if replica == LOOK_AFTER and replicas > LOOK_AFTER:
                each = (self._clock.now() - begin) / replica
                stop = begin + (end - begin) * self._shoot_share(end)
                replicas = replica + max(0, round((stop - self._clock.now()) / each))
        self.session.reconstruct()
        self._see_until(end)

    def by_error(self, target: float) -> None:
        """Double the work until the estimated error of the pictures is below `target`."""
        self._first_draft()
        work, samples = 2 * self.pace.per_replica * FEWEST_REPLICAS, 2 * PASS_SAMPLES
        while True:
            for _ in range(FEWEST_REPLICAS):
                self._replica(work // FEWEST_REPLICAS, lambda: min(0.99, (target / self.error) ** 2 if self.error > 0 else 0.0))
                if self._stop():
                    break
                self._draft_of_fields()
            self.session.reconstruct()
            self._see(samples)
            solution, eye = errors(self.session, self.cameras)
            self.error = math.hypot(solution, eye)
            if self.error <= target or self.was_interrupted:
                return
            # Each part shall come below its half of the squared error; at most eight times the work at once.
            share = target / math.sqrt(2) * 0.95
            work = int(self.work * min(8.0, max(0.0, (solution / share) ** 2 - 1)))
            work = max(work, FEWEST_REPLICAS * 4 * self.pace.least)
            samples = math.ceil(samples * min(8.0, max(1.0, (eye / share) ** 2)))

    # What has been done

    @property
    def pace(self) -> Pace:
        """How work is dealt out."""
        return RAYS if self.transport != "bundles" else PLAIN if self.plain else BUNDLES

    @property
    def patches(self) -> int:
        """Of the scene."""
        return self.session.scene.patches

    @property
    def work(self) -> int:
        """Shooting rays, or directions, so far."""
        return self.session.directions if self.transport == "bundles" else self.session.rays

    @property
    def speed(self) -> float:
        """Work a second, over the time spent shooting."""
        return self.work / self._shooting_s if self._shooting_s > 0 else 0.0

    # Steps

    def _replica(self, work: int, fraction: Callable[[], float]) -> None:
        """One replica of `work` in all."""
        before = self.work
        self._begin(int(work * self.pace.rays * SOLVE_SHARE))
        while True:
            left = work - (self.work - before)
            if left < max(self.pace.least, work * 0.01) and self.session.steps > 0:
                break
            begin = self.work
            self._step(max(left, self.pace.least) if left < 1.5 * self._largest_step() else self._largest_step())
            self._tell("shoot", fraction())
            nothing_to_shoot = self.work == begin
            done = self.transport == "walk" and self.work - before >= work * 0.8
            if nothing_to_shoot or done or self._stop():
                break
        self.session.end_replica()

    def _steps_until(self, until: float) -> None:
        """Take as many steps, as large as may be, as fit before the time `until`; at least one in a replica."""
        first = self.session.steps == 0
        while True:
            room = (until - self._clock.now()) * self._step_speed
            # Replicas count alike, so none may measure less than it has solved.
            least = max(4 * self.pace.least, int(self._solved / self.pace.rays) if first else 0)
            if not first and (room < self.pace.per_step / 128 or self._stop()):
                return
            first = False
            parts = max(1, round(room / self._largest_step()))
            self._step(max(least, int(room / parts)))
            self._tell("shoot", self._fraction())

    def _begin(self, rays: int) -> None:
        """Start a replica, with a solve of about `rays` rays."""
        rays_before = self.session.rays

        def solve() -> float:
            self.session.begin_replica(min(rays, max(LARGEST_SOLVE[0], LARGEST_SOLVE[1] * self.patches)))
            return self.session.rays - rays_before + RAYS_PER_PATCH_LIT * self.patches

        seconds = self._shoot(solve)
        self._solved = self.session.rays - rays_before
        self._solve_speed = self._solved / seconds

    def _step(self, work: int) -> None:
        work_before = self.work

        def step() -> float:
            self.session.step(work)
            return work * self.pace.rays

        seconds = self._shoot(step)
        self._step_speed = (self.work - work_before) / seconds
        if self.transport == "rays":
            self._solve_speed = self._step_speed

    def _shoot(self, work: Callable[[], float]) -> float:
        """Do a part of shooting; see `_timed`."""
        wall = time.monotonic()
        seconds = self._timed(work)
        self._shot += seconds
        self._shooting_s += time.monotonic() - wall
        return seconds

    def _timed(self, work: Callable[[], float]) -> float:
        """Do some work, which says how many rays take as long; gives its seconds on the clock."""
        before = self._clock.now()
        self._clock.spend(work())
        return max(1e-6, self._clock.now() - before)

    def _see(self, samples: int) -> None:
        """`samples` samples a pixel for every camera; after an interruption as few as make a picture."""
        done = passes = 0
        while done < samples or passes < FEWEST_PASSES:
            if done >= INTERRUPTED_SAMPLES and self._stop():
                return
            size = max(1, min(self._next_pass(done), samples - done))
            self._pass(size)
            done, passes = done + size, passes + 1
            self._tell("eye", 0.7 + 0.3 * min(1.0, done / samples))
            self._draft_of_films(passes)

    def _see_until(self, end: float) -> None:
        """As many samples as there is time for, in at least FEWEST_PASSES."""
        done = passes = 0
        cost = 0.0  # seconds a sample
        while True:
            size = self._next_pass(done)
            room = (end - self._clock.now()) / cost if passes else 1.0
            if passes >= FEWEST_PASSES and (self._stop() or room < size / 4):
                return
            size = max(1, min(size, int(room)))
            cost = self._timed_pass(size) / size
            done, passes = done + size, passes + 1
            self._tell("eye", self._fraction())
            self._draft_of_films(passes)

    @staticmethod
    def _next_pass(done: int) -> int:
        """Samples of the next pass after `done` samples: as many again."""
        return max(1, min(done, PASS_SAMPLES))

    def _choose_transport(self, seconds: float) -> None:
        """Go on with the transport that brings the least error in the same time; what the trials shot is forgotten."""
        cost = {transport: self._try_transport(transport, seconds) for transport in TRIED}
        first, *others = TRIED
        best = min((t for t in others if cost[t] < CLEARLY * cost[first]), key=cost.__getitem__, default=first)
        compared = ", ".join(f"{cost[t] / max(cost[best], 1e-30):.2g} times that of {best} with {t}" for t in TRIED if t != best)
        self.why = f"in a trial the squared error at equal time was {compared}"
        self._use_transport(best)
        if self.refine and best != "bundles":
            self.session = self.refine()

    def _try_transport(self, transport: str, seconds: float) -> float:
        """Squared relative error of the solution that a transport reaches, times the seconds that this took."""
        self._use_transport(transport)
        for replica in range(TRIAL_REPLICAS):
            until = self._clock.now() + seconds / TRIAL_REPLICAS
            self._begin(self._pilot_rays(seconds))
            if replica == 0:
                self._step(max(self.pace.least, int(self._pilot_rays(seconds) / self.pace.rays)))
            self._steps_until(until)
            self.session.end_replica()
        self.session.reconstruct()
        for _ in range(FEWEST_PASSES):
            self._pass(1)
        solution, _ = errors(self.session, self.cameras)
        return solution**2 * self._shot

    def _use_transport(self, transport: str) -> None:
        self.session.change_transport(transport)
        self.transport, self._shooting_s, self._shot, self._step_speed, self._solve_speed = transport, 0.0, 0.0, 0.0, 0.0

    def _first_draft(self) -> None:
        """A picture of few rays, soon after the start. What it shot is forgotten, so that the result is the same without it."""
        if not self.draft:
            return
        for _ in range(DRAFT_REPLICAS):
            self.session.begin_replica(DRAFT_RAYS)
            self.session.step(max(self.pace.least, int(DRAFT_RAYS / self.pace.rays)))
            self.session.end_replica()
        self._look_and_draft()
        self.session.forget()

    def _draft_of_fields(self) -> None:
        """A draft of the replicas so far, if one is due."""
        if self.draft and self._draft_is_due():
            self._look_and_draft()

    def _draft_of_films(self, passes: int) -> None:
        """A draft of the passes so far, if one is due."""
        if self.draft and passes >= FEWEST_PASSES and self._draft_is_due():
            self._hand_out_draft()

    def _look_and_draft(self) -> None:
        self.session.reconstruct()
        self._pass(LOOK_SAMPLES)
        self._hand_out_draft()

    def _draft_is_due(self) -> bool:
        return time.monotonic() - self.started > 2 * self._drafted

    def _hand_out_draft(self) -> None:
        assert self.draft
        self.draft()
        self._drafted = time.monotonic() - self.started

    def _shoot_share(self, end: float) -> float:
        """The share of the time for shooting that makes the sum of both squared errors least, as a first look at the pictures tells.

        With errors that fall as 1/time, shooting and seeing should take times in proportion to the square roots of error^2 time.
        """
        if end - self._clock.now() < SHORTEST_LOOK:
            return SHOOT_SHARE
        self.session.reconstruct()
        seeing = sum(self._timed_pass(LOOK_SAMPLES) for _ in range(FEWEST_PASSES))
        if seeing > 0.1 * (end - self._begun):
            return SHOOT_SHARE
        solution, eye = errors(self.session, self.cameras)
        self.error = math.hypot(solution, eye)
        shoot, see = solution * math.sqrt(self._shot), eye * math.sqrt(seeing)
        return min(SHOOT_SHARES[1], max(SHOOT_SHARES[0], shoot / (shoot + see))) if shoot + see > 0 else SHOOT_SHARE

    def _pass(self, samples: int) -> float:
        """One pass for every camera; says how many rays take as long."""
        for camera in range(self.cameras):
            self.session.eye_pass(camera, samples)
        return self._rays_of_eye(samples)

    def _timed_pass(self, samples: int) -> float:
        """The same; gives the seconds that it took."""
        return self._timed(lambda: self._pass(samples))

    def _rays_of_eye(self, samples: int) -> float:
        """Rays that could be shot in the time of `samples` samples a pixel."""
        return RAYS_PER_SAMPLE * samples * self.pixels

    def _fraction(self) -> float:
        """Of the time of the budget."""
        return min(1.0, (self._clock.now() - self._begun) / (self._end - self._begun))

    # Sizes

    def _replicas(self, work: int, most: int = sys.maxsize) -> int:
        # The first shot of a replica costs time for every patch.
        least = max(self.pace.per_replica, int(RAYS_PER_PATCH * self.patches / self.pace.rays))
        wanted = max(min(REPLICAS, work // least), work // self.pace.most_per_replica)
        return max(2, min(most, max(FEWEST_REPLICAS, wanted)))

    def _pilot_rays(self, seconds: float) -> int:
        return int(min(LARGEST_PILOT, max(16_384, seconds * 50_000)))

    def _largest_step(self) -> int:
        return self.pace.per_step if self.transport == "bundles" else max(self.pace.per_step, 2 * self.patches)

    def _stop(self) -> bool:
        self.was_interrupted = self.was_interrupted or self.interrupted()
        return self.was_interrupted

    def _tell(self, phase: Phase, fraction: float) -> None:
        if self.show is None:
            return
        elapsed = time.monotonic() - self.started
        fraction = min(1.0, fraction)
        remaining = elapsed / fraction - elapsed if fraction > 0 else math.nan
        self.show(Progress(phase, fraction, self.work, self.speed, self.error, elapsed, max(0.0, remaining), self.pace.unit))
