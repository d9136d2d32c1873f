"""What the two numbers within a replica are worth that no render measures anew, as a Markdown table: the share of its time that goes to its
own solution, and the gathering rays of glossy areas.

python benchmarks/division.py [--seeds N] [SCENE ...]

Mean relMSE to the references at equal work, that of `--quality medium`. Needs the reference scenes.
"""

from __future__ import annotations

import argparse
from unittest import mock

import numpy as np
from scenes import NAMES, folder, machine

import lumel
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.settings import GATHER
from lumel.work import SOLVE_SHARE

TRIED = ((0.1, GATHER), (SOLVE_SHARE, GATHER), (0.5, GATHER), (SOLVE_SHARE, 4.0), (SOLVE_SHARE, 48.0))


def error(name: str, share: float, gather: float, seeds: int) -> float:
    """relMSE less the noise of the reference, mean over seeds."""
    scene, truth = lumel.load(folder() / f"{name}.xml"), read_picture(folder() / "reference" / f"{name}.exr").layers
    with mock.patch("lumel.work.SOLVE_SHARE", share):
        images = [lumel.render(scene, gather=gather, seed=seed).image() for seed in range(1, 1 + seeds)]
    return float(np.mean([compare(image, truth["rgb"], None, truth["stderr"]).relmse_without_noise for image in images]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=4)
    parser.add_argument("names", nargs="*", default=NAMES, metavar="SCENE", help=f"of {', '.join(NAMES)}; all of them by default")
    arguments = parser.parse_args()
    print(machine(), end="\n\n")
    print("| scene | " + " | ".join(f"share {share:g}, {gather:g} rays" for share, gather in TRIED) + " |")
    print("|---" * (1 + len(TRIED)) + "|")
    for name in arguments.names:
        found = (error(name, share, gather, arguments.seeds) for share, gather in TRIED)
        print(f"| `{name}` | " + " | ".join(f"{e:.5f}" for e in found) + " |", flush=True)


if __name__ == "__main__":
    main()
