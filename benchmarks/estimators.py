"""Every estimator with and without gathering, on scenes that pull them apart: errors over the glossy patches in view, as a Markdown table.

python benchmarks/estimators.py [--seeds N] [--rays N] [--cache DIR] [SCENE ...]

All estimators of a row are fed the same samples: one replica of --rays rays shot from a solve of a quarter as many. Errors are RMSE over
patches, channels and seeds (the noise of the truth subtracted), divided by the mean of the truth. Patches without a hit count with their
fallback. The last columns are RMSE(auto) over that of the best of gather alone, classical and weighted in its row, and the upper end of
its one-sided 95 % bootstrap interval over seeds. `own rays` is classical without gathering and without the defensive rays that only
ratios need.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from measured import GIVEN, Array, Subject, Truth, resampled, truth
from scenes import NAMES, machine

COUNTS = (0, 1, 4, 16)  # gathering rays an area
ESTIMATORS = ("classical", "weighted", "regression", "auto")
COMPARED = ("gather alone", "classical", "weighted")
FULL = 1 << 20  # shooting rays that the core counts gathering rays by
ALONE = 64  # shooting rays that make a step; their density is next to nothing
ALLOWED = {0: 1.3, 1: 1.15, 4: 1.15, 16: 1.15}


def errors(subject: Subject, against: Truth, count: int, rays: int, seed: int) -> dict[str, Array]:
    """Squared errors of all areas, by estimator."""
    session = subject.session(seed, gather=count * FULL / rays)
    subject.replica(session, rays // 4, rays)
    found = {name: against.error(session.areas(0, name)) for name in ESTIMATORS}
    if count > 0:
        other, name, shot = subject.session(seed, gather=count * FULL / ALONE), "gather alone", ALONE
    else:
        other, name, shot = subject.session(seed, defensive=0.0), "own rays", rays
    subject.replica(other, rays // 4, shot)
    return {**found, name: against.error(other.areas(0, "classical"))}


def ratio_to_best(mse: dict[str, Array], others: tuple[str, ...]) -> tuple[float, float]:
    """RMSE of auto over the least of the others, and the upper end of its one-sided 95 % bootstrap interval."""

    def ratio(runs: Array) -> Array:
        mean = {name: mse[name][runs].mean(axis=-1) for name in (*others, "auto")}
        return np.sqrt(mean["auto"] / np.min([mean[name] for name in others], axis=0))

    seeds = len(mse["auto"])
    return float(ratio(np.arange(seeds))), float(np.quantile(ratio(resampled(seeds)), 0.95))


def report(name: str, group: str, count: int, areas: int, mse: dict[str, Array], mean: float) -> None:
    """One row of the table from squared errors by seed."""
    shown = ("gather alone", "own rays", *ESTIMATORS)
    cells = [f"{np.sqrt(max(mse[e].mean(), 0)) / mean:.3g}" if e in mse else "-" for e in shown]
    others = tuple(e for e in COMPARED if e in mse)
    ratio, bound = ratio_to_best(mse, others)
    verdict = "" if bound <= ALLOWED[count] else " (over)"
    row = [f"`{name}`", group, str(areas), str(count), *cells, f"{ratio:.2f}", f"{bound:.2f}{verdict}"]
    print("| " + " | ".join(row) + " |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--rays", type=int, default=1_000_000, help="shooting rays of every estimate")
    parser.add_argument("--cache", type=Path, default=Path("~/.cache/lumel").expanduser(), help="folder for truths")
    parser.add_argument("names", nargs="*", default=[*GIVEN, *NAMES], metavar="SCENE")
    arguments = parser.parse_args()
    print(machine(), end="\n\n", flush=True)
    for name in arguments.names:
        subject = Subject.named(name, arguments.cache)
        against = truth(subject, arguments.cache)
        materials = subject.materials(against.index)
        groups = {"all": np.ones(len(materials), bool)} | {m: materials == m for m in np.unique(materials)}
        if len(groups) == 2:
            del groups[materials[0]]
        for count in COUNTS:
            runs = [errors(subject, against, count, arguments.rays, seed) for seed in range(arguments.seeds)]
            for group, chosen in groups.items():
                noise = against.noise()[chosen].mean()
                mse = {e: np.array([run[e][chosen].mean() - noise for run in runs]) for e in runs[0]}
                report(name, group, count, int(chosen.sum()), mse, float(against.value[chosen].mean()))


if __name__ == "__main__":
    main()
