"""What weighting is worth by the roughness of the gloss."""

from __future__ import annotations

import time
from dataclasses import replace

import numpy as np

from . import plots
from .areas import Doubles, Subject, Truth, truth_within
from .budget import until
from .figure import Curve, Figure, Table, gain, span
from .iterations import READ
from .lab import BOX, Lab

WORKS = {"roughness": 36.0}
ALPHAS = (0.05, 0.1, 0.2, 0.35, 0.6, 1.0)
ESTIMATORS = ("classical", "weighted", "auto")
RUNS = 3  # with seeds of their own
TRUTH_SHARE = 0.3  # of the time of a roughness
STEP_SOLVE, STEP = 1 << 16, 1 << 16  # rays of a replica


def make(lab: Lab) -> Figure:
    """Errors and gain at equal time, by the roughness that all gloss of the scene is given."""
    each = lab.budget.take("roughness") / len(ALPHAS)
    found: dict[float, dict[str, tuple[float, float]]] = {}
    for alpha in ALPHAS:
        lab.begin(f"gloss of roughness {alpha:g}")
        found[alpha] = errors(lab, with_roughness(lab.subject(BOX), alpha), each)
    gains = {n: [gain(found[a]["classical"][0] ** 2, found[a][n][0] ** 2) for a in ALPHAS] for n in ESTIMATORS[1:]}
    rows = [
        (a, *(found[a][n][0] for n in ESTIMATORS), *(gains[n][i] for n in gains), found[a]["classical"][1], found[a]["weighted"][1])
        for i, a in enumerate(ALPHAS)
    ]
    head = ("alpha", *(f"RMSE {n}" for n in ESTIMATORS), *(f"gain of {n}" for n in gains), "time of classical, s", "time of weighted, s")
    return Figure(
        title="Gain by roughness",
        scene=lab.scene(BOX).source,
        shows=f"""The scene with all its gloss at one roughness (GGX alpha: 0.05 is nearly a mirror, 1 nearly matt), by ray shooting
        with nothing gathered, at equal time: {RUNS} runs of {rows[0][-1]:.2g} s each. Left: relative RMSE over the glossy patches in
        view; right: how many times larger the mean square error of `classical` is.""",
        claim="""The paper wants to mend shooting on specular surfaces in view. The narrower the lobe, the more f/p varies from sample
        to sample, and the more there is to gain from dividing by g/p, provided that the lobe is hit at all.""",
        found=[f"The gain of `{name}` is {span(gains[name])}." for name in gains],
        curves=[Curve("roughness", "error and gain by roughness", _draw(found, gains))],
        tables=[Table("roughness", "By roughness", head, rows)],
    )


def with_roughness(subject: Subject, alpha: float) -> Subject:
    """The same scene with all gloss at roughness `alpha`."""
    materials = {n: replace(m, alpha=alpha) if max(m.specular) > 0 else m for n, m in subject.scene.materials.items()}
    return replace(subject, scene=replace(subject.scene, materials=materials))


def errors(lab: Lab, subject: Subject, seconds: float) -> dict[str, tuple[float, float]]:
    """Relative RMSE of every estimator, and the seconds that a run of it took."""
    lab.tell()
    truth = truth_within(subject, until(seconds * TRUTH_SHARE))
    each = seconds * (1 - TRUTH_SHARE) / (RUNS * len(READ))
    squared: dict[str, list[float]] = {name: [] for name in ESTIMATORS}
    taken = dict.fromkeys(ESTIMATORS, 0.0)
    for seed in range(RUNS):
        for name, read in READ.items():
            lab.tell()
            session, began, more = subject.session(seed, estimator=name), time.monotonic(), until(each)
            subject.replica(session, STEP_SOLVE, STEP)
            while more():
                subject.replica(session, STEP_SOLVE, STEP)
            spent = time.monotonic() - began
            for estimator in read:
                taken[estimator] += spent / RUNS
                squared[estimator].append(_mean_square(truth, session.areas(0, estimator)["value"]))
    return {name: (float(np.sqrt(max(0.0, float(np.mean(found))))), taken[name]) for name, found in squared.items()}


def _mean_square(truth: Truth, value: Doubles) -> float:
    return float(truth.error(value).mean() / truth.mean**2)


def _draw(found: dict[float, dict[str, tuple[float, float]]], gains: dict[str, list[float]]) -> str:
    x = list(found)
    error = {name: [found[a][name][0] for a in x] for name in ESTIMATORS}
    return plots.error_and_gain(
        "roughness", ("error at equal time", "gain over classical"), x, error, gains, xlabel="roughness alpha", ticks=x
    )
