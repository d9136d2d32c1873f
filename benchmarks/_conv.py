"""Whether pictures of high quality have come to their references: errors, the mean, and every tile of 16x16 pixels.

python benchmarks/converged.py [--time SECONDS] [SCENE ...]

A tile is biased where Welch's t of its mean against the reference's exceeds what chance explains in one of all tiles (Bonferroni at 1e-2),
and where the difference is above 3 %. Standard errors are those of the reference and of the picture. Exits with 1 where a bound is missed.
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from statistics import NormalDist

import numpy as np
from scenes import NAMES, folder, machine

import lumel
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.scene import LUMINANCE, FloatArray

TILE = 16  # pixels
CHANCE = 1e-2
BIAS = 0.03
ERROR, ERROR_8X8, NOISY = 6e-4, 2e-4, 3e-4  # relMSE, of 8x8 means where the reference's own noise is above the last
MEAN = 0.005


def biased_tiles(
    image: FloatArray, stderr: FloatArray, reference: FloatArray, reference_stderr: FloatArray
) -> list[tuple[int, int, float, float]]:
    """Row and column (pixels), relative difference and t of the tiles whose luminance is significantly off by more than BIAS."""
    height, width = (n // TILE * TILE for n in image.shape[:2])

    def tiles(values: FloatArray) -> FloatArray:
        """Sums over tiles."""
        return values[:height, :width].reshape(height // TILE, TILE, width // TILE, TILE).sum(axis=(1, 3))

    difference, total = tiles((image - reference) @ LUMINANCE), tiles(reference @ LUMINANCE)
    # The error of the solution is shared by the pixels of a tile: it does not average out, noise of the eye does; take all as shared.
    own = tiles(stderr @ LUMINANCE)
    error = np.sqrt(own**2 + tiles((reference_stderr @ LUMINANCE) ** 2))
    t = np.divide(difference, error, out=np.zeros_like(difference), where=error > 0)
    relative = np.divide(difference, total, out=np.zeros_like(difference), where=total > 0)
    most = NormalDist().inv_cdf(1 - CHANCE / 2 / t.size)
    found = np.argwhere((np.abs(t) > most) & (np.abs(relative) > BIAS))
    return [(int(y) * TILE, int(x) * TILE, float(relative[y, x]), float(t[y, x])) for y, x in found]


def main() -> int:
    """Print a table and the tiles that are off; gives 1 where a bound is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--time", type=float, help="seconds for each scene instead of the work of --quality high")
    parser.add_argument("names", nargs="*", default=NAMES, metavar="SCENE", help=f"of {', '.join(NAMES)}; all of them by default")
    arguments = parser.parse_args()
    print(machine(), end="\n\n")
    print("| scene | time, s | rays, M | relMSE - reference noise | of 8x8 means | mean ratio | tiles off | |")
    print("|---|---|---|---|---|---|---|---|")
    missed, lists = 0, []
    for name in arguments.names:
        scene = lumel.load(folder() / f"{name}.xml")
        begin = time.monotonic()
        result = lumel.render(scene, quality="high", time=arguments.time, started=begin, patches=(int(__import__("os").environ.get("EXTRA","20000"))+sum(len(m.triangles) for m in scene.meshes)))
        seconds = time.monotonic() - begin
        reference = read_picture(folder() / "reference" / f"{name}.exr").layers
        found = compare(result.image(), reference["rgb"], None, reference["stderr"])
        off = biased_tiles(
            *(layer.astype(np.float64) for layer in (result.image(), result.layer("stderr"), reference["rgb"], reference["stderr"]))
        )
        error, coarse = found.relmse_without_noise or math.nan, found.relmse_8x8_without_noise or math.nan
        reached = coarse <= ERROR_8X8 if (found.reference_noise or 0) > NOISY else error <= ERROR
        kept = reached and abs(found.mean_ratio - 1) <= MEAN and not off
        missed += not kept
        work = f"{seconds:.0f} | {float(str(result.stats['rays'])) / 1e6:.0f}"
        verdict = "" if kept else "MISSED"
        print(f"| `{name}` | {work} | {error:.5f} | {coarse:.5f} | {found.mean_ratio:.4f} | {len(off)} | {verdict} |", flush=True)
        lists += [f"`{name}` rows from {y}, columns from {x}: {100 * relative:+.1f} %, t = {t:.1f}" for y, x, relative, t in off]
    print("", *lists, sep="\n")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
