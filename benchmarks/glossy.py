"""What weighting is worth: mean square errors of both estimators in indirect specular light over the glossy pixels, at equal time.

python benchmarks/glossy.py [--time SECONDS] [--reference TIMES] [SCENE]

The truth is a run with another seed and TIMES as many rays as the longer of the two.
"""

from __future__ import annotations

import argparse

import numpy as np
from scenes import folder, machine

import lumel
from lumel import gloss


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--time", type=float, default=20, help="seconds for each estimator")
    parser.add_argument("--reference", type=float, default=8, help="rays of the reference, in those of the longer run")
    parser.add_argument("--truth", default="weighted", choices=("classical", "weighted"), help="estimator of the reference")
    parser.add_argument("--patches", type=int, help="about how many patches")
    parser.add_argument("name", nargs="?", default="bust", metavar="SCENE", help="a reference scene or a built-in one")
    arguments = parser.parse_args()
    name = arguments.name
    scene = lumel.load(name if name.startswith("lumel:") else folder() / f"{name}.xml")
    print(machine(), end="\n\n")
    runs = {e: lumel.render(scene, estimator=e, time=arguments.time, patches=arguments.patches) for e in ("classical", "weighted")}
    rays = {e: int(str(run.stats["rays"])) for e, run in runs.items()}
    most = int(arguments.reference * max(rays.values()))
    truth = lumel.render(scene, estimator=arguments.truth, rays=most, seed=1, patches=arguments.patches)

    # A glossy pixel is one that has such light in the truth.
    R = truth.layer(gloss.LAYER).astype(np.float64)
    glossy = R.max(axis=-1) > 0
    R = R[glossy]
    error = {e: float(np.mean((run.layer(gloss.LAYER)[glossy] - R) ** 2)) for e, run in runs.items()}
    print(f"`{name}`, {arguments.time:g} s each, against {most / 1e6:.0f} M rays, {glossy.mean():.0%} of the pixels are glossy\n")
    print("| estimator | rays, M | mean square error | relMSE | mean ratio |")
    print("|---|---|---|---|---|")
    for e, run in runs.items():
        relative = gloss.relmse(run.layer(gloss.LAYER), truth.layer(gloss.LAYER))
        ratio = run.layer(gloss.LAYER)[glossy].mean() / R.mean()
        print(f"| {e} | {rays[e] / 1e6:.1f} | {error[e]:.3g} | {relative:.3g} | {ratio:.4f} |")
    print(f"\nclassical / weighted: {error['classical'] / error['weighted']:.2f}")


if __name__ == "__main__":
    main()
