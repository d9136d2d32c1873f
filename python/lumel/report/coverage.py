"""How often the error bars hold the truth."""

from __future__ import annotations

import math

import numpy as np

from ..quadrature.student import t_quantile
from ..settings import GATHER
from . import plots
from .areas import Doubles, Truth
from .budget import until
from .figure import Curve, Figure, Table
from .lab import BOX, Lab

WORKS = {"truth": 5.0, "coverage": 24.0}
LEVELS = (0.5, 0.68, 0.8, 0.9, 0.95, 0.99)
QUOTED = LEVELS.index(0.95)
REPLICAS = 16  # that an error bar rests on, as in a render
RAYS, SOLVE = 1 << 17, 1 << 16  # of a replica
FEWEST_RUNS, MOST_RUNS = 2, 40
ESTIMATORS = ("classical", "weighted", "regression", "auto")
GATHERED = {"gathered": float(GATHER), "nothing gathered": 0.0}


def make(lab: Lab) -> Figure:
    """Shares of the areas whose interval holds the truth, over the level that the interval claims."""
    truth = lab.truth(BOX)
    each = lab.budget.take("coverage") / len(GATHERED)
    held: dict[str, dict[str, Doubles]] = {}  # runs, levels
    for kind, gather in GATHERED.items():
        lab.begin(f"error bars, {kind}")
        held[kind] = _runs(lab, truth, gather, each)
    mean = {kind: {name: found.mean(axis=0) for name, found in by.items()} for kind, by in held.items()}
    error = {kind: {name: found.std(axis=0, ddof=1) / math.sqrt(len(found)) for name, found in by.items()} for kind, by in held.items()}
    rows = [
        (kind, name, level, float(mean[kind][name][i]), float(error[kind][name][i]))
        for kind in held
        for name in ESTIMATORS
        for i, level in enumerate(LEVELS)
    ]
    runs = " and ".join(f"{len(by['auto'])} runs ({kind})" for kind, by in held.items())
    return Figure(
        title="Coverage of the error bars",
        scene=lab.scene(BOX).source,
        shows=f"""Share of the {len(truth.index)} glossy patches in view whose interval holds the truth, over the level that it claims:
        Student's t of {REPLICAS} replicas, ray shooting, {runs}. Left as `lumel render` works, right shooting alone. The noise of the
        truth is added to the intervals. A point on the diagonal is an honest error bar; one below it promises too much.""",
        claim="""Not in the paper. Replicas are independent, so that their spread tells the error where hits are many. With few hits all
        replicas may have missed the brightest part of a lobe, and no spread can tell.""",
        found=[
            f"Intervals of 95 %, {kind}: "
            + ", ".join(f"{mean[kind][n][QUOTED]:.1%} ± {error[kind][n][QUOTED]:.1%} `{n}`" for n in ESTIMATORS)
            for kind in held
        ],
        curves=[Curve("coverage", "share of intervals that hold the truth, by claimed level", _draw(mean, error))],
        tables=[Table("coverage", "Coverage", ("samples", "estimator", "level", "share that holds the truth", "standard error"), rows)],
    )


def _runs(lab: Lab, truth: Truth, gather: float, seconds: float) -> dict[str, Doubles]:
    """Shares by estimator: (runs, levels), in as many runs as there is time for."""
    subject, more = lab.subject(BOX), until(seconds)
    shares: dict[str, list[list[float]]] = {name: [] for name in ESTIMATORS}
    for seed in range(MOST_RUNS):
        if seed >= FEWEST_RUNS and not more():
            break
        session = subject.session(seed, gather=gather * (1 << 20) / (REPLICAS * RAYS))
        for _ in range(REPLICAS):
            subject.replica(session, SOLVE, RAYS)
        for name in ESTIMATORS:
            found = session.areas(0, name)
            shares[name].append(covered(found["value"], found["variance"], truth))
        lab.tell()
    return {name: np.array(by) for name, by in shares.items()}


def covered(value: Doubles, variance: Doubles, truth: Truth) -> list[float]:
    """For each of LEVELS the share of the values (n, 3) that are as near to the truth as their interval says; those without one are
    left out."""
    there = variance > 0
    distance = np.abs(value - truth.value)[there] / np.sqrt(variance + truth.variance)[there]
    return [float(np.mean(distance <= t_quantile(level, REPLICAS - 1))) for level in LEVELS]


def _draw(mean: dict[str, dict[str, Doubles]], error: dict[str, dict[str, Doubles]]) -> str:
    x = np.array(LEVELS) * 100
    with plots.panels(list(mean), share_y=True) as (figure, axes):
        for panel, kind in zip(axes, mean, strict=True):
            panel.plot([40, 100], [40, 100], "--", color=plots.INK, linewidth=1, alpha=0.6)
            for name in ESTIMATORS:
                plots.line(panel, x, 100 * mean[kind][name], name, error=100 * error[kind][name])
            panel.set(xlabel="level claimed, %", xlim=(45, 101), ylim=(30, 101))
        axes[0].set_ylabel("intervals that hold the truth, %")
        axes[0].legend()
        return plots.to_svg(figure, "coverage")
