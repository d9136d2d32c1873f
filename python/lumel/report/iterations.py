"""One run after the other over iterations, read again and again on the way: what figures 4 and 5 and the gain by hits are made of.

An iteration is a replica: its own solve, and RAYS rays or DIRECTIONS directions shot from it. Nothing is gathered. `classical` has a
session of its own, without the defensive rays that only ratios need; `weighted` and `auto` read one and the same session.
"""

from __future__ import annotations

import time
from dataclasses import dataclass

import numpy as np

from .areas import Doubles
from .budget import until
from .lab import BOX, Lab

MOST, FEWEST = 32, 4  # iterations
MOST_RUNS = 16
FIRST_RUN = 0.3  # share of the time, at most: it says how many iterations all runs have
SOLVE, RAYS, DIRECTIONS = 1 << 18, 1 << 18, 32  # of an iteration
TRANSPORTS = ("rays", "bundles")
READ = {"classical": ("classical",), "weighted": ("weighted", "auto")}  # estimators by session
ESTIMATORS = ("classical", "weighted", "auto")
WORKS = {"truth": 5.0, "iterations": 50.0}


@dataclass(frozen=True)
class Iterations:
    """`at` (k,) iterations; `value` by transport and estimator (runs, k, areas, 3), W/(m2 sr), and `hits` likewise (runs, k, areas);
    `seconds` of an iteration by transport and session."""

    at: list[int]
    value: dict[tuple[str, str], Doubles]
    hits: dict[tuple[str, str], Doubles]
    seconds: dict[tuple[str, str], float]

    @property
    def runs(self) -> int:
        """Independent runs."""
        return len(next(iter(self.value.values())))

    @property
    def said(self) -> str:
        """`one run`, `means of 3 runs with standard errors`."""
        return "one run" if self.runs == 1 else f"means of {self.runs} runs with standard errors"


def of_box(lab: Lab) -> Iterations:
    """Runs with one seed after the other, as long as there is time. Takes the time of the work `iterations`."""

    def make() -> Iterations:
        lab.truth(BOX)
        lab.begin("areas of interest over iterations")
        seconds = lab.budget.take("iterations")
        began, more = time.monotonic(), until(seconds)
        runs = [_run(lab, 0, MOST, FIRST_RUN * seconds)]
        took, last = time.monotonic() - began, runs[0].at[-1]
        for seed in range(1, MOST_RUNS):
            if time.monotonic() - began + 0.8 * took > seconds or not more():
                break
            runs.append(_run(lab, seed, last, np.inf))
        return _joined(runs)

    return lab.once("iterations", make)


def looks(last: int) -> list[int]:
    """Iterations to look at: every one at first, then evenly on a logarithmic axis."""
    return sorted({int(i) for i in np.round(np.geomspace(1, last, 1 + round(5 * np.log2(max(last, 2)))))})


def _run(lab: Lab, seed: int, last: int, seconds: float) -> Iterations:
    """All sessions in turns, to iteration `last` or until `seconds` are over."""
    subject, more = lab.subject(BOX), until(seconds)
    sessions = {(t, e): subject.session(seed, transport=t, estimator=e) for t in TRANSPORTS for e in READ}
    value: dict[tuple[str, str], list[Doubles]] = {(t, e): [] for t in TRANSPORTS for e in ESTIMATORS}
    hits: dict[tuple[str, str], list[Doubles]] = {key: [] for key in value}
    spent = dict.fromkeys(sessions, 0.0)
    at: list[int] = []
    for iteration in range(1, last + 1):
        for key, session in sessions.items():
            before = time.monotonic()
            subject.replica(session, SOLVE, RAYS if key[0] == "rays" else DIRECTIONS)
            spent[key] += time.monotonic() - before
        lab.tell()
        over = iteration >= FEWEST and not more()
        if iteration in looks(MOST) or iteration == last or over:
            at.append(iteration)
            for (transport, name), session in sessions.items():
                for estimator in READ[name]:
                    found = session.areas(0, estimator)
                    value[transport, estimator].append(found["value"])
                    hits[transport, estimator].append(np.where(found["borrowed"] == 0, found["hits"], 0))
        if over:
            break
    stacked = {key: np.array(v) for key, v in value.items()}
    return Iterations(at, stacked, {key: np.array(h) for key, h in hits.items()}, {key: s / at[-1] for key, s in spent.items()})


def _joined(runs: list[Iterations]) -> Iterations:
    first = runs[0]
    return Iterations(
        first.at,
        {key: np.array([run.value[key] for run in runs]) for key in first.value},
        {key: np.array([run.hits[key] for run in runs]) for key in first.hits},
        {key: float(np.mean([run.seconds[key] for run in runs])) for key in first.seconds},
    )
