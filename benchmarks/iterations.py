"""Both forms of bundles, frozen state and the plain iteration of the paper, after equal times, as a Markdown table.

python benchmarks/iterations.py [--time SECONDS] [SCENE ...]

The growth is that of the variance in a step of the plain iteration: where it is 1 or more its noise has no bound, and the render warns.
References are those of the reference scenes; of a built-in scene a run of `rays` that takes four times as long.
"""

from __future__ import annotations

import argparse

from scenes import folder, machine

import lumel
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.scene import FloatArray
from lumel.settings import ITERATIONS

DEFAULT = ("lumel:cube", "bust", "cornell_glossy", "courtyard", "spotlit")


def read(name: str, time: float) -> tuple[lumel.Scene, FloatArray, FloatArray]:
    """A scene, its reference and the standard error of that."""
    if name.startswith("lumel:"):
        scene = lumel.load(name)
        result = lumel.render(scene, time=4 * time)
        return scene, result.image(), result.layer("stderr")
    layers = read_picture(folder() / "reference" / f"{name}.exr").layers
    return lumel.load(folder() / f"{name}.xml"), layers["rgb"], layers["stderr"]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--time", type=float, default=10, help="seconds for each picture")
    parser.add_argument("names", nargs="*", default=DEFAULT, metavar="SCENE", help=f"{', '.join(DEFAULT)} by default")
    arguments = parser.parse_args()
    print(machine(), end="\n\n")
    print("| scene | form | growth | warns | directions | relMSE - reference noise | of 8x8 means | mean ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for name in arguments.names:
        scene, reference, stderr = read(name, arguments.time)
        for iteration in ITERATIONS:
            result = lumel.render(scene, transport="bundles", iteration=iteration, estimator="weighted", time=arguments.time)
            found = compare(result.image(), reference, None, stderr)
            growth = f"{result.stats['variance_growth']:.2f}" if iteration == "plain" else ""
            warns = "yes" if any("has no bound" in note for note in result.notes) else ""
            errors = f"{found.relmse_without_noise:.4f} | {found.relmse_8x8_without_noise:.4f} | {found.mean_ratio:.4f}"
            print(f"| `{name}` | {iteration} | {growth} | {warns} | {result.stats['directions']} | {errors} |", flush=True)


if __name__ == "__main__":
    main()
