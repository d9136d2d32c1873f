"""Areas of interest measured one by one: sessions that stop before the picture, and the truth to hold them against."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from .. import _core
from ..core import camera_to_core, to_core
from ..render import DIRECT_SAMPLES
from ..scene import Scene

Doubles = npt.NDArray[np.float64]
Indices = npt.NDArray[np.intp]


@dataclass
class Subject:
    """A scene whose glossy patches in view of its first camera are measured; `patches` as for `lumel.render`, `threads` 0 for all."""

    scene: Scene
    patches: int | None = None
    threads: int = 0

    @cached_property
    def core(self) -> _core.Scene:
        """The tessellated scene. Raises SceneError."""
        return to_core(self.scene, self.patches)[0]

    def session(self, seed: int, **settings: Any) -> _core.Session:
        """A session of transport `rays` and estimator `auto` that gathers nothing, but for `settings`: those of `_core.Session`."""
        defaults: dict[str, Any] = {
            "transport": "rays", "areas": "patches", "estimator": "auto", "defensive": -1.0, "gather": 0.0, "weight_diffuse": None,
            "first_shot": True, "direct_samples": DIRECT_SAMPLES, "threads": self.threads or len(os.sched_getaffinity(0)),
        }  # fmt: skip
        return _core.Session(scene=self.core, cameras=[camera_to_core(self.scene.cameras[0])], seed=seed, **defaults | settings)

    def replica(self, session: _core.Session, solve: int, work: int, steps: int = 1) -> None:
        """Solve with `solve` rays, freeze that, and measure `work` rays or directions shot from it, in so many steps."""
        session.begin_replica(solve)
        for step in range(steps):
            session.step(work * (step + 1) // steps - work * step // steps)
        session.end_replica()


@dataclass(frozen=True)
class Truth:
    """`index` (n,) of the areas, `value` and `variance` of that value (n, 3), W/(m2 sr)."""

    index: Indices
    value: Doubles
    variance: Doubles

    @staticmethod
    def measured(session: _core.Session) -> Truth:
        """What a session knows: by `classical` or `weighted`, whichever has less noise."""
        found = [session.areas(0, name) for name in ("classical", "weighted")]
        best = min(found, key=lambda f: float(f["variance"].sum()))
        return Truth(best["index"].astype(np.intp), best["value"], best["variance"])

    @property
    def mean(self) -> float:
        """Mean over areas and channels, W/(m2 sr)."""
        return float(self.value.mean())

    def error(self, value: Doubles) -> Doubles:
        """Squared errors of `value` (..., n, 3), less what the noise of the truth adds: (..., n), mean over the channels."""
        return np.asarray(np.mean((value - self.value) ** 2 - self.variance, axis=-1))


GATHERED = 64.0  # gathering rays an area and 2^20 shooting rays, of a truth
RAYS = 1 << 18  # of each of its replicas, after a solve of half as many
FEWEST_REPLICAS = 4
TRUTH_SEED = 987_654_321


def truth_within(subject: Subject, more: Callable[[], bool]) -> Truth:
    """Many gathering rays for each area of `subject`: replicas while there is time for `more`, FEWEST_REPLICAS at least."""
    session = subject.session(TRUTH_SEED, gather=GATHERED)
    done = 0
    while done < FEWEST_REPLICAS or more():
        subject.replica(session, RAYS // 2, RAYS)
        done += 1
    return Truth.measured(session)
