"""How far pictures of the reference scenes are from their references after a given time, as a Markdown table.

python benchmarks/references.py [--time SECONDS] [--transport NAME] [--areas NAME] [--estimator NAME] [--gather N ...]
    [--uniform] [SCENE ...]

`--gather 0 4 16 64` tells what gathering is worth at equal time, and so what its default should be.
`--uniform` makes all patches about as large, to tell what adaptive ones are worth.
"""

from __future__ import annotations

import argparse
import time

from scenes import NAMES, folder, machine

import lumel
from lumel import _core
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.settings import AREAS, TRANSPORTS, Settings


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--time", type=float, default=20, help="seconds for each scene")
    parser.add_argument("--transport", default="rays", choices=TRANSPORTS)
    parser.add_argument("--areas", default="patches", choices=AREAS)
    parser.add_argument("--estimator", default="auto", choices=_core.estimators())
    parser.add_argument("--gather", type=float, nargs="+", default=[None], metavar="N", help="gathering rays, as of `lumel render`")
    parser.add_argument("--uniform", action="store_true", help="patches that are all about as large")
    parser.add_argument("names", nargs="*", default=NAMES, metavar="SCENE", help=f"of {', '.join(NAMES)}; all of them by default")
    arguments = parser.parse_args()
    scenes = folder()
    print(machine(), end="\n\n")
    print("| scene | gathering rays | time, s | directions, k, or rays, M | a second | relMSE less noise | of 8x8 means | mean ratio |")
    print("|---|---|---|---|---|---|---|---|")
    for name in arguments.names:
        reference = read_picture(scenes / "reference" / f"{name}.exr").layers
        for gather in arguments.gather:
            scene = lumel.load(scenes / f"{name}.xml")
            settings = Settings(
                time=arguments.time,
                transport=arguments.transport,
                areas=arguments.areas,
                estimator=arguments.estimator,
                gather=gather,
                adaptive=not arguments.uniform,
            )
            started = time.monotonic()
            result = lumel.render(scene, **vars(settings), started=started)
            seconds = time.monotonic() - started
            found = compare(result.image(), reference["rgb"], None, reference["stderr"])
            unit, scale = ("directions", 1e3) if arguments.transport == "bundles" else ("rays", 1e6)
            work, speed = (float(str(result.stats[key])) / scale for key in (unit, f"{unit}_per_s"))
            errors = f"{found.relmse_without_noise:.5f} | {found.relmse_8x8_without_noise:.5f} | {found.mean_ratio:.4f}"
            print(f"| `{name}` | {settings.gather_rays():g} | {seconds:.1f} | {work:.2f} | {speed:.2f} | {errors} |", flush=True)


if __name__ == "__main__":
    main()
