"""Figure 6 of the paper: a glossy scene by ray bundles, without and with weighting, at equal directions; pictures, errors and times.

python benchmarks/figure6.py [--directions N] [--size N] [-o DIR] [SCENE.xml | BUILT-IN]

The paper shows 800x800 pixels after 28 s on one 1.4 GHz core, first shot included. Nothing is gathered, light is measured in pixels, one
thread works. The error is that of the indirect specular light on pixels that have any, against a run with another seed and as many
times the directions as `--reference` says. Writes `classical.png`, `weighted.png` and both side by side, `pair.png`.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path

import numpy as np
from PIL import Image
from scenes import folder, machine

import lumel
from lumel import gloss


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--directions", type=int, default=800)
    parser.add_argument("--reference", type=int, default=4, help="times the directions")
    parser.add_argument("--size", type=int, default=800, help="pixels of an edge")
    parser.add_argument("-o", "--output", type=Path, default=Path("out/figure6"))
    parser.add_argument("scene", nargs="?", default=str(folder() / "bust.xml"))
    arguments = parser.parse_args()
    scene = lumel.load(arguments.scene)
    arguments.output.mkdir(parents=True, exist_ok=True)

    def render(estimator: str, directions: int, **settings: object) -> tuple[lumel.Result, float]:
        started = time.process_time()
        result = lumel.render(
            scene, transport="bundles", areas="pixels", estimator=estimator, gather=0, size=(arguments.size,) * 2, quality="draft",
            directions=directions, **settings,
        )  # fmt: skip
        return result, time.process_time() - started

    reference = render("weighted", arguments.directions * arguments.reference, seed=1)[0].layer(gloss.LAYER)
    print(machine(), end="\n\n")
    print(
        f"| {arguments.directions} directions, {arguments.size}x{arguments.size} | processor time on one thread, s | relMSE of the gloss |"
    )
    print("|---|---|---|")
    pictures = []
    for estimator in ("classical", "weighted"):
        result, seconds = render(estimator, arguments.directions, threads=1)
        result.write(arguments.output / f"{estimator}.png")
        pictures.append(np.asarray(Image.open(arguments.output / f"{estimator}.png")))
        error = gloss.relmse(result.layer(gloss.LAYER), reference)
        print(f"| {estimator} | {seconds:.1f} | {error:.4g} |", flush=True)
    Image.fromarray(np.hstack(pictures)).save(arguments.output / "pair.png")


if __name__ == "__main__":
    main()
