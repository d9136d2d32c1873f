"""Areas of interest measured by hand: the scenes, sessions that stop before the picture, truths, and bootstrap intervals."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from scenes import scene_file

import lobes
import lumel
from lumel import _core
from lumel.render import scene_hash
from lumel.report import areas
from lumel.scene import Scene

Array = npt.NDArray[np.float64]

GIVEN: dict[str, Callable[[], Scene]] = {"smooth": lobes.smooth, "spot": lobes.spot}  # their light is given: walls that only emit
GIVEN_PATCHES = 16_500
RESAMPLES = 10_000


@dataclass
class Subject(areas.Subject):
    """A scene whose glossy patches in view of its first camera are measured, with transport `rays`."""

    given: bool = False  # the light of surfaces is what they emit: nothing to solve, one transfer to measure

    @staticmethod
    def named(name: str, out: Path) -> Subject:
        """`smooth`, `spot`, a reference scene, a generated one, which is written to `out`, or a file."""
        return Subject(GIVEN[name](), GIVEN_PATCHES, given=True) if name in GIVEN else Subject(lumel.load(scene_file(name, out)))

    def session(self, seed: int, **settings: Any) -> _core.Session:
        """As for any subject; where the light is given, it is that of the lamps."""
        return super().session(seed, **{"first_shot": not self.given, **settings})

    def replica(self, session: _core.Session, solve: int, work: int, steps: int = 1) -> None:
        """Solve with `solve` rays, freeze that, and measure `work` rays shot from it. What gloss sends to gloss takes a solve, or steps."""
        super().replica(session, 0 if self.given else solve, work, 1 if self.given else steps)

    def materials(self, areas: npt.NDArray[np.intp]) -> npt.NDArray[np.str_]:
        """Name of the material of each area."""
        of_patch = self.core.patch_geometry()[:, 7].astype(np.intp)
        return np.array(list(self.scene.materials))[of_patch[areas % self.core.patches]]


@dataclass
class Truth:
    index: npt.NDArray[np.intp]  # of the areas
    value: Array  # (areas, 3), W/(m2 sr)
    variance: Array  # of it

    def error(self, found: dict[str, Array]) -> Array:
        """Squared error of every area, mean over the channels; that of the truth itself is still in it."""
        if not np.array_equal(found["index"], self.index):
            raise SystemExit("the areas are not those of the truth: clear the cache")
        return np.mean((found["value"] - self.value) ** 2, axis=1)

    def noise(self) -> Array:
        """What the noise of the truth adds to `error`."""
        return self.variance.mean(axis=1)


REPLICAS, GATHERED = 8, 256


def truth(subject: Subject, cache: Path, rays: int = 1 << 21) -> Truth:
    """Many gathering rays for each area: GATHERED for every 2^20 shooting rays of REPLICAS replicas. Kept in the folder `cache`: empty it
    when the core changes what light is."""
    key = hashlib.sha256(f"{scene_hash(subject.scene)} {subject.patches} {subject.given} {rays} {REPLICAS} {GATHERED}".encode())
    path = cache / f"{key.hexdigest()[:20]}.npz"
    if not path.exists():
        session = subject.session(seed=987_654_321, gather=GATHERED)
        for _ in range(REPLICAS):
            subject.replica(session, rays // 2, rays, steps=max(1, rays >> 20))
        found = {name: session.areas(0, name) for name in ("classical", "weighted")}
        classical, weighted = (found[name]["value"].mean() for name in found)
        sigma = np.sqrt(found["classical"]["variance"].sum()) / found["classical"]["value"].size
        print(f"truth: classical / weighted = {classical / weighted:.5f} +- {sigma / weighted:.5f}", flush=True)
        best = min(found.values(), key=lambda f: float(f["variance"].sum()))
        cache.mkdir(parents=True, exist_ok=True)
        np.savez(path, index=best["index"].astype(np.intp), value=best["value"], variance=best["variance"])
    with np.load(path) as kept:
        return Truth(kept["index"].astype(np.intp), kept["value"], kept["variance"])


def resampled(runs: int, seed: int = 1) -> npt.NDArray[np.intp]:
    """Bootstrap: (RESAMPLES, runs) numbers of runs, drawn with replacement."""
    return np.random.default_rng(seed).integers(0, runs, (RESAMPLES, runs))
