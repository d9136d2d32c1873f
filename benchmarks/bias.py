"""The bias of ratios, over many seeds on a glossy floor amid smooth light that is given, as a Markdown table.

python benchmarks/bias.py [--seeds N] [--replicas N ...] [--alpha A] [--cache DIR]

Nothing is gathered. A replica brings HITS hits to an area; estimates rest on the sums of several. With T the truth, E[F] = T and E[G] = 1,
so that the bias E[C] - T of an estimate C is the mean of C - F + T (G - 1) too, where all noise of first order has gone. It is pooled over
areas and divided by the mean of T (luminance). The plain form, mean of C less T, is shown beside it: it has all the noise of C, and the
error of the table of albedos, which E[G] shows.
"""

from __future__ import annotations

import argparse
from pathlib import Path

import numpy as np
from measured import Array, Subject, Truth, resampled, truth
from scenes import machine

import lobes
from lumel.scene import LUMINANCE

HITS = 10  # mean hits of an area in a replica
ESTIMATORS = ("weighted", "regression", "auto")
PATCHES = 690


def rays_for(subject: Subject, hits: float) -> int:
    """Rays of a replica that bring so many hits to an area."""
    session, trial = subject.session(seed=0), 1 << 18
    subject.replica(session, 0, trial)
    return round(trial * hits / session.areas(0, "classical")["hits"].mean())


def biases(subject: Subject, against: Truth, rays: int, seed: int, replicas: list[int]) -> Array:
    """For each number of replicas and each estimator: bias in the form without first-order noise, and in the plain one; then G - 1."""
    session = subject.session(seed, threads=1)
    T = against.value @ LUMINANCE
    rows = []
    for count in range(1, max(replicas) + 1):
        subject.replica(session, 0, rays)
        if count not in replicas:
            continue
        row: list[float] = []
        for name in ESTIMATORS:
            found = session.areas(0, name)
            own = found["borrowed"] == 0
            C, F, G = found["value"] @ LUMINANCE, found["mean"] @ LUMINANCE * own, found["weight"] * own
            row += [float(np.sum(C - F + T * (G - 1)) / T.sum()), float(np.sum(C - T) / T.sum())]
        rows.append([*row, float(np.mean(G - 1))])
    return np.array(rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=2000)
    parser.add_argument("--replicas", type=int, nargs="+", default=[2, 5, 10, 20], help="in the sums of an estimate")
    parser.add_argument("--alpha", type=float, default=0.18, help="roughness of the floor")
    parser.add_argument("--cache", type=Path, default=Path("~/.cache/lumel").expanduser(), help="folder for truths")
    arguments = parser.parse_args()
    print(machine(), end="\n\n", flush=True)
    subject = Subject(lobes.glossy_floor(arguments.alpha), PATCHES, given=True)
    against = truth(subject, arguments.cache)
    replicas = sorted(arguments.replicas)
    rays = rays_for(subject, HITS)
    found = np.array([biases(subject, against, rays, seed, replicas) for seed in range(arguments.seeds)])  # seed, replicas, column
    mean, stderr = found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(arguments.seeds)

    def shown(row: int, column: int) -> str:
        return f"{mean[row, column]:+.3%} +- {stderr[row, column]:.3%}"

    print(f"alpha {arguments.alpha:g}, {len(against.index)} areas, {arguments.seeds} seeds, {rays} rays a replica\n")
    print("| hits an area | " + " | ".join(f"{name} | plainly" for name in ESTIMATORS) + " | G - 1 |")
    print("|---" * (2 + 2 * len(ESTIMATORS)) + "|")
    for row, count in enumerate(replicas):
        print(f"| {HITS * count} | " + " | ".join(shown(row, c) for c in range(found.shape[2])) + " |")
    print("\n| from M to 4 M samples | bias falls by | 95 % interval |\n|---|---|---|")
    draws = resampled(arguments.seeds)[:2000]
    for column, name in enumerate(ESTIMATORS):
        for row, count in enumerate(replicas):
            if 4 * count not in replicas:
                continue
            few, many = found[:, row, 2 * column], found[:, replicas.index(4 * count), 2 * column]
            low, high = np.quantile(few[draws].mean(axis=1) / many[draws].mean(axis=1), (0.025, 0.975))
            print(f"| {name}, from {HITS * count} hits | {few.mean() / many.mean():.2f} | {low:.2f} to {high:.2f} |")


if __name__ == "__main__":
    main()
