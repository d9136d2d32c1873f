"""The order of work in a render: replicas of the solve first, then passes of the eye, within a budget of rays, time or error."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from . import _core
from .progress import Phase, Progress

REPLICAS = 16  # independent solves that error bars rest on
FEWEST_REPLICAS = 4
RAYS_PER_REPLICA = 100_000  # below this, fewer replicas are better
RAYS_PER_STEP = 1 << 20  # shot between two looks at the clock
SOLVE_SHARE = 0.25  # of a replica's rays, for its own solution by power (transport `rays`)
SHOOT_SHARE = 0.6  # of the time that is left after the scene is ready
PASS_SAMPLES = 8  # eye samples a pixel between two looks at the clock
FEWEST_PASSES = 2  # the spread of the passes is part of the error bars


@dataclass
class Schedule:
    """Runs a session. `interrupted` is asked between steps; `show` is told where things are; `started` is on time.monotonic()."""

    session: _core.Session
    cameras: int
    patches: int
    transport: str
    started: float
    show: Callable[[Progress], None] | None = None
    interrupted: Callable[[], bool] = lambda: False
    error: float = math.nan
    was_interrupted: bool = False
    _shooting_s: float = field(default=0.0, init=False)

    # What a budget means

    def by_rays(self, rays: int, samples: int) -> None:
        """Shoot `rays` rays in all, then see with `samples` samples a pixel."""
        replicas = self._replicas(rays)
        for replica in range(replicas):
            self._replica(rays * (replica + 1) // replicas - rays * replica // replicas, lambda: self.rays / rays * 0.7)
            if self._stop():
                break
        self.session.reconstruct()
        self._see(samples)

    def by_time(self, seconds: float) -> None:
        """Shoot and see until `seconds` after the start."""
        end = self.started + seconds
        begin = time.monotonic()
        stop_shooting = begin + max(0.0, end - begin) * SHOOT_SHARE
        rays = self._pilot_rays(seconds)
        replicas, replica = FEWEST_REPLICAS, 0
        while replica < replicas and not (replica > 0 and self._stop()):
            last = begin + (stop_shooting - begin) * (replica + 1) / replicas
            self._timed_replica(rays, last, end)
            replica += 1
            # The first replica tells the speed, and with it how many replicas there shall be and how large each is.
            left = stop_shooting - time.monotonic()
            affordable = self._speed() * max(0.0, left)
            if replica == 1:
                replicas = 1 + (self._replicas(int(affordable)) if affordable > RAYS_PER_REPLICA / 4 else 0)
                begin = time.monotonic() - (stop_shooting - time.monotonic()) / max(1, replicas - 1)
            if replica < replicas:
                rays = max(1024, int(affordable / (replicas - replica)))
            if left <= 0:
                break
        self.session.reconstruct()
        self._see_until(end)

    def by_error(self, target: float) -> None:
        """Double the work until the estimated error of the pictures is below `target`."""
        rays, samples = 2 * RAYS_PER_REPLICA * FEWEST_REPLICAS, 2 * PASS_SAMPLES
        while True:
            for _ in range(FEWEST_REPLICAS):
                self._replica(rays // FEWEST_REPLICAS, lambda: min(0.99, (target / self.error) ** 2 if self.error > 0 else 0.0))
                if self._stop():
                    break
            self.session.reconstruct()
            self._see(samples)
            solution, eye = self.errors()
            self.error = math.hypot(solution, eye)
            if self.error <= target or self.was_interrupted:
                return
            # Each part shall come below its half of the squared error; at most eight times the work at once.
            share = target / math.sqrt(2) * 0.95
            rays = int(self.rays * min(8.0, max(0.0, (solution / share) ** 2 - 1)))
            rays = max(rays, FEWEST_REPLICAS * 1024)
            samples = math.ceil(samples * min(8.0, max(1.0, (eye / share) ** 2)))

    # What has been done

    @property
    def rays(self) -> int:
        """Shooting rays so far."""
        return int(self.session.stats["rays"])

    @property
    def rays_per_s(self) -> float:
        """Shooting rays a second, over the time spent shooting."""
        return self._speed()

    def errors(self) -> tuple[float, float]:
        """Relative error sqrt(mean(stderr^2 / (I^2 + e))), e = 0.01 mean(I)^2, over all cameras: of the solution, and of the eye's samples."""
        parts = []
        for camera in range(self.cameras):
            layers = self.session.layers(camera)
            image = sum(layers[name].astype(np.float64) for name in ("emission", "direct", "indirect.diffuse", "indirect.specular"))
            scale = image**2 + 0.01 * np.mean(image) ** 2
            if not np.any(scale > 0):
                return 0.0, 0.0
            solution = layers["stderr.solution"].astype(np.float64) ** 2
            total = layers["stderr"].astype(np.float64) ** 2
            parts.append((np.mean(solution / scale), np.mean(np.maximum(total - solution, 0) / scale)))
        solved, seen = np.mean(parts, axis=0)
        return math.sqrt(solved), math.sqrt(seen)

    # Steps

    def _replica(self, rays: int, fraction: Callable[[], float]) -> None:
        """One replica of `rays` rays in all."""
        before = self.rays
        self._begin(rays)
        while True:
            left = rays - (self.rays - before)
            if left < rays * 0.01 and self.rays > before:
                break
            self._step(max(left, 256) if left < 1.5 * self._largest_step() else self._largest_step())
            self._tell("shoot", fraction())
            if self.transport == "walk" and self.rays - before >= rays * 0.8:
                break
            if self._stop():
                break
        self.session.end_replica()

    def _timed_replica(self, rays: int, until: float, end: float) -> None:
        """One replica of about `rays` rays that takes steps until the time `until`, at least one."""
        self._begin(rays)
        step = min(self._largest_step(), max(1024, int(rays * (1 - SOLVE_SHARE))))
        while True:
            before = time.monotonic()
            self._step(step)
            now = time.monotonic()
            self._tell("shoot", (now - self.started) / (end - self.started))
            if now + 0.6 * (now - before) > until or self._stop():
                break
        self.session.end_replica()

    def _begin(self, rays: int) -> None:
        before = time.monotonic()
        self.session.begin_replica(int(rays * SOLVE_SHARE))
        self._shooting_s += time.monotonic() - before

    def _step(self, rays: int) -> None:
        before = time.monotonic()
        self.session.step(rays)
        self._shooting_s += time.monotonic() - before

    def _see(self, samples: int) -> None:
        """`samples` samples a pixel for every camera."""
        passes = max(FEWEST_PASSES, round(samples / PASS_SAMPLES))
        if self.was_interrupted:
            passes = FEWEST_PASSES
        for done in range(passes):
            for camera in range(self.cameras):
                self.session.eye_pass(camera, max(1, samples // passes))
            self._tell("eye", 0.7 + 0.3 * (done + 1) / passes)
            if done + 1 >= FEWEST_PASSES and self._stop():
                break

    def _see_until(self, end: float) -> None:
        """As many passes as there is time for, at least FEWEST_PASSES; the first ones tell what a sample costs."""
        cost, samples, done = math.inf, 1, 0
        while True:
            before = time.monotonic()
            for camera in range(self.cameras):
                self.session.eye_pass(camera, samples)
            now = time.monotonic()
            done += 1
            cost = (now - before) / samples
            self._tell("eye", min(1.0, (now - self.started) / (end - self.started)))
            if done >= FEWEST_PASSES and (self._stop() or now + 0.7 * cost * samples > end):
                break
            if done == 1:
                # Passes count alike, so all have the samples that the time allows for.
                samples = max(1, min(PASS_SAMPLES, int((end - now) / cost / FEWEST_PASSES)))
                if samples > 1:
                    self.session.reconstruct()
                    done = 0

    # Sizes

    def _replicas(self, rays: int) -> int:
        return max(FEWEST_REPLICAS, min(REPLICAS, rays // RAYS_PER_REPLICA))

    def _pilot_rays(self, seconds: float) -> int:
        return int(min(RAYS_PER_STEP / 4, max(16_384, seconds * 20_000)))

    def _largest_step(self) -> int:
        return max(RAYS_PER_STEP, 2 * self.patches)

    def _speed(self) -> float:
        return self.rays / self._shooting_s if self._shooting_s > 0 else 0.0

    def _stop(self) -> bool:
        self.was_interrupted = self.was_interrupted or self.interrupted()
        return self.was_interrupted

    def _tell(self, phase: Phase, fraction: float) -> None:
        if self.show is None:
            return
        elapsed = time.monotonic() - self.started
        remaining = elapsed / fraction - elapsed if fraction > 0 else math.nan
        self.show(Progress(phase, fraction, self.rays, self._speed(), self.error, elapsed, max(0.0, remaining)))
