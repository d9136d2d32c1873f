"""What weighting is worth at equal rays, without gathering: mean square errors over the glossy patches in view, as Markdown tables.

python benchmarks/equal_rays.py [SCENE ...] [--seeds N] [--rays N ...] [--solve N ...] [--faint] [--cache DIR]

Every run is one replica of steps of a million rays, shot from a solve of --solve rays (0: a quarter of its rays). `classical` needs no
defensive rays and shoots none (`own rays`); the other columns share one set of samples, with them. Errors are divided by the square of
the mean of the truth, whose own noise is subtracted. Intervals: bootstrap over seeds, 95 %. `hits` is the median over patches; `n` the
median of the effective number of hits, (sum g)^2 / sum g^2. The second table tells where the error is: the share that the worst patches
of each run hold, the ratio among the others, and the ratios in quarters of the patches, from those with the fewest hits to those with
the most.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from measured import Array, Subject, Truth, resampled, truth
from scenes import machine

from lobes import FAINT

ESTIMATORS = ("classical", "weighted", "auto")
STEP = 1_000_000  # rays
QUARTERS = 4
WORST = 0.01  # of the patches


def faint(subject: Subject) -> Subject:
    """The same scene with gloss that sends next to nothing on: errors scale, and no lobe is a bright source."""
    scene = subject.scene
    dim = {name: replace(m, specular=tuple(FAINT * s for s in m.specular)) for name, m in scene.materials.items()}
    return replace(subject, scene=replace(scene, materials=dim))


def run(subject: Subject, against: Truth, rays: int, solve: int, seed: int) -> dict[str, Array]:
    """Squared errors of all areas by estimator, their hits, and their effective number of hits."""
    found = {}
    for name, defensive in (("own rays", 0.0), ("shared", -1.0)):
        session = subject.session(seed, defensive=defensive)
        subject.replica(session, solve or rays // 4, rays, steps=max(1, rays // STEP))
        read = {e: session.areas(0, e) for e in (ESTIMATORS if name == "shared" else ("classical",))}
        found |= {e if name == "shared" else name: against.error(areas) for e, areas in read.items()}
    areas = read["classical"]
    own = (areas["borrowed"] == 0) & (areas["moment.gg"] > 0)
    effective = np.divide(areas["weight"] ** 2, areas["moment.gg"], out=np.zeros(len(own)), where=own)
    return {**found, "hits": np.where(own, areas["hits"], 0), "effective": effective}


def worst(error: Array) -> tuple[Array, Array]:
    """By seed: mean error without that of the worst patches, and their share of it all. `error` is by seed and area."""
    ordered = np.sort(error, axis=1)
    rest = ordered[:, : round(error.shape[1] * (1 - WORST))].sum(axis=1)
    return rest / error.shape[1], 1 - rest / ordered.sum(axis=1)


def gain(classical: Array, other: Array) -> str:
    """How many times the mean square error of classical is larger, with its interval; arrays by seed."""
    draws = resampled(len(classical))
    low, high = np.quantile(classical[draws].mean(axis=1) / other[draws].mean(axis=1), (0.025, 0.975))
    return f"{classical.mean() / other.mean():.1f} ({low:.1f} to {high:.1f})"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=6)
    parser.add_argument("--rays", type=int, nargs="+", default=[100_000, 1_000_000, 10_000_000])
    parser.add_argument("--solve", type=int, nargs="+", default=[0, 4_000_000], help="rays of the solve; 0: a quarter of the others")
    parser.add_argument("--faint", action="store_true", help=f"multiply specular reflectances by {FAINT:g}: no gloss lights gloss")
    parser.add_argument("--cache", type=Path, default=Path("~/.cache/lumel").expanduser(), help="folder for truths")
    parser.add_argument("names", nargs="*", default=["bust", "cornell_glossy"], metavar="SCENE")
    arguments = parser.parse_args()
    print(machine(), end="\n\n", flush=True)
    columns = ("own rays", *ESTIMATORS)
    where: list[str] = []
    print("| scene | rays, M | solve, M | hits | n | own rays | classical | weighted | auto | own rays / weighted | own rays / auto |")
    print("|---" * 11 + "|")
    for name in arguments.names:
        subject = faint(Subject.named(name, arguments.cache)) if arguments.faint else Subject.named(name, arguments.cache)
        against = truth(subject, arguments.cache)
        for solve in arguments.solve:
            for rays in arguments.rays:
                runs = [run(subject, against, rays, solve, seed) for seed in range(arguments.seeds)]
                error = {e: np.array([r[e] - against.noise() for r in runs]) for e in columns}  # seed, area
                mse = {e: error[e].mean(axis=1) / against.value.mean() ** 2 for e in columns}
                hits = np.mean([r["hits"] for r in runs], axis=0)
                effective = np.median(np.mean([r["effective"] for r in runs], axis=0))
                solved = "given" if subject.given else f"{(solve or rays // 4) / 1e6:g}"
                head = f"| `{name}` | {rays / 1e6:g} | {solved} |"
                cells = [f"{mse[e].mean():.3g}" for e in columns]
                cells += [gain(mse["own rays"], mse[e]) for e in ("weighted", "auto")]
                print(f"{head} {np.median(hits):.0f} | {effective:.1f} | " + " | ".join(cells) + " |", flush=True)
                (others, share), (others_w, share_w) = (worst(error[e]) for e in ("own rays", "weighted"))
                tail = f"{share.mean():.0%} | {share_w.mean():.0%} | {gain(others, others_w)}"
                parts = np.array_split(np.argsort(hits), QUARTERS)
                shown = [f"{error['own rays'][:, p].mean() / error['weighted'][:, p].mean():.1f}" for p in parts]
                where.append(f"{head} {tail} | " + " | ".join(shown) + " |")
    print(
        f"\n| scene | rays, M | solve, M | worst {WORST:.0%}: own rays | weighted | ratio among the others | fewest hits | | | most hits |"
    )
    print("|---" * 10 + "|")
    print("\n".join(where))


if __name__ == "__main__":
    main()
