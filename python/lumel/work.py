"""The work of a render on the clock of its budget: shooting by steps and replicas, seeing by passes."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, field

from . import _core
from .pace import RAYS_PER_SAMPLE, Clock, Pace, WallClock, pace_of

SOLVE_SHARE = 0.25  # of a replica's time, for its own solution by power (transports `rays` and `bundles`)
REPLICAS = 16  # independent solves that error bars rest on
FEWEST_REPLICAS = 4
FEWEST_WITH_SPREAD = 2  # replicas that tell an error
LARGEST_SOLVE = (1 << 21, 4)  # rays of the solve of a replica, or rays a patch if that is more
LARGEST_PILOT = 1 << 19  # rays of a first step, to know how fast work is
RAYS_PER_PATCH = 8  # of a replica: below this, fewer replicas are better
RAYS_PER_PATCH_LIT = 8  # that could be shot in the time of the first shot of a replica, for every patch


@dataclass
class Work:
    """Shoots and sees with a session, and keeps what that took by `clock`."""

    session: _core.Session
    cameras: int
    pixels: int  # of all cameras
    transport: str
    plain: bool  # are bundles iterated plainly?
    window: int | None = None  # of bundles, pixels of an edge
    clock: Clock = field(default_factory=WallClock)  # of the budget
    shot: float = field(default=0.0, init=False)  # seconds of that clock spent shooting
    stepped: float = field(default=0.0, init=False)  # of these, in steps: what is measured
    shooting_s: float = field(default=0.0, init=False)  # spent shooting, by the wall
    step_speed: float = field(default=0.0, init=False)  # work a second of the last step
    solve_speed: float = field(default=0.0, init=False)  # rays a second of the last solve,
    solved: int = field(default=0, init=False)  # and its rays

    @property
    def pace(self) -> Pace:
        """How work is dealt out."""
        return pace_of(self.transport, self.session.scene, self.window, plain=self.plain)

    @property
    def patches(self) -> int:
        """Of the scene."""
        return self.session.scene.patches

    @property
    def done(self) -> int:
        """Shooting rays, or directions, so far."""
        return self.session.directions if self.transport == "bundles" else self.session.rays

    @property
    def speed(self) -> float:
        """Work a second of the wall, over the time spent shooting."""
        return self.done / self.shooting_s if self.shooting_s > 0 else 0.0

    # Shooting

    def forget(self) -> None:
        """Forget what was shot."""
        self.session.forget()
        self.shot = self.stepped = self.shooting_s = 0.0

    def begin(self, rays: int) -> None:
        """Start a replica, with a solve of about `rays` rays."""
        rays_before = self.session.rays

        def solve() -> float:
            self.session.begin_replica(min(rays, max(LARGEST_SOLVE[0], LARGEST_SOLVE[1] * self.patches)))
            return self.session.rays - rays_before + RAYS_PER_PATCH_LIT * self.patches

        seconds = self._shoot(solve)
        self.solved = self.session.rays - rays_before
        self.solve_speed = self.solved / seconds

    def step(self, work: int) -> None:
        """Shoot about `work` rays, or cast as many bundles."""
        before = self.done

        def step() -> float:
            self.session.step(work)
            return work * self.pace.rays

        seconds = self._shoot(step)
        self.stepped += seconds
        self.step_speed = (self.done - before) / seconds
        if self.transport == "rays":
            self.solve_speed = self.step_speed

    def first_step(self, seconds: float) -> None:
        """A small step, which tells how fast work is where there are so many seconds in all."""
        self.step(max(self.pace.least, int(self.pilot_rays(seconds) / self.pace.rays)))

    def replica(self, seconds: float, stop: Callable[[], bool]) -> None:
        """A replica of so many seconds, where the speed of work is known; `stop` is asked between steps."""
        until = self.clock.now() + seconds
        self.begin(int(seconds * SOLVE_SHARE * self.solve_speed))
        self.steps_until(until, stop)
        self.session.end_replica()

    def steps_until(self, until: float, stop: Callable[[], bool]) -> None:
        """Take as many steps, as large as may be, as fit before the time `until`; at least one in a replica. `stop` is asked between."""
        first = self.session.steps == 0
        while True:
            room = (until - self.clock.now()) * self.step_speed
            # Replicas count alike, so none may measure less than it has solved.
            least = max(4 * self.pace.least, int(self.solved / self.pace.rays) if first else 0)
            if not first and (room < self.pace.per_step / 128 or stop()):
                return
            first = False
            self.step(max(least, int(room / max(1, round(room / self.largest_step)))))

    def _shoot(self, work: Callable[[], float]) -> float:
        """Do a part of shooting; see `timed`."""
        wall = time.monotonic()
        seconds = self.timed(work)
        self.shot += seconds
        self.shooting_s += time.monotonic() - wall
        return seconds

    def timed(self, work: Callable[[], float]) -> float:
        """Do some work, which says how many rays take as long; gives its seconds on the clock."""
        before = self.clock.now()
        self.clock.spend(work())
        return max(1e-6, self.clock.now() - before)

    # Seeing

    def see(self, samples: int) -> float:
        """One pass of `samples` samples a pixel for every camera; says how many rays take as long."""
        for camera in range(self.cameras):
            self.session.eye_pass(camera, samples)
        return RAYS_PER_SAMPLE * samples * self.pixels

    def timed_see(self, samples: int) -> float:
        """The same; gives the seconds that it took."""
        return self.timed(lambda: self.see(samples))

    # Sizes

    def replicas(self, work: int, most: int = sys.maxsize) -> int:
        """How many replicas `work` in all is best divided into."""
        # The first shot of a replica costs time for every patch.
        least = max(self.pace.per_replica, int(RAYS_PER_PATCH * self.patches / self.pace.rays))
        wanted = max(min(REPLICAS, work // least), work // self.pace.most_per_replica)
        return max(FEWEST_WITH_SPREAD, min(most, max(FEWEST_REPLICAS, wanted)))

    def pilot_rays(self, seconds: float) -> int:
        """Rays of a first solve, where there are so many seconds in all."""
        return int(min(LARGEST_PILOT, max(16_384, seconds * 50_000)))

    @property
    def largest_step(self) -> int:
        """Work between two looks at the clock."""
        return self.pace.per_step if self.transport == "bundles" else max(self.pace.per_step, 2 * self.patches)
