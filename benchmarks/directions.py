"""How far the nominal cost of a direction of bundles, in rays, is from that by processor time, as a Markdown table.

python benchmarks/directions.py [--matt] [SCENE ...]

Steps of bundles and of rays take turns in one thread, so a busy machine hardly shows. Windows are None (chosen by the size of patches), 512
and 1024. SCENE is a reference scene, a generated one, or a file; `--matt` takes the gloss away.
"""

from __future__ import annotations

import argparse
import statistics
import time
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from scenes import NAMES, machine, matt, scene_file

import lumel
from lumel import _core
from lumel.pace import rays_of_direction
from lumel.report.areas import Subject
from lumel.settings import GATHER, MOST_GATHERING

WINDOWS = (None, 512, 1024)
SOLVE, RAYS, DIRECTIONS, ROUNDS = 1 << 18, 1 << 21, 64, 3


def seconds(work: Callable[[], None]) -> float:
    """Processor time."""
    before = time.process_time()
    work()
    return time.process_time() - before


def measured(session: _core.Session) -> tuple[float, float]:
    """Seconds of a direction, and of a ray: medians."""
    took: dict[str, list[float]] = {"bundles": [], "rays": []}
    for _ in range(ROUNDS):
        for transport, work in (("bundles", DIRECTIONS), ("rays", RAYS)):
            session.change_transport(transport)
            session.begin_replica(SOLVE)
            session.step(work)
            took[transport].append(seconds(lambda work=work: session.step(work)) / work)
    return statistics.median(took["bundles"]), statistics.median(took["rays"])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", default=NAMES, metavar="SCENE")
    parser.add_argument("--matt", action="store_true")
    arguments = parser.parse_args()
    kind = " matt" if arguments.matt else ""
    print(machine(), end="\n\n")
    print("| scene | triangles | patches | window | ms a direction | ns a ray | rays a direction | nominal | off by |")
    print("|---|---|---|---|---|---|---|---|---|")
    with TemporaryDirectory() as out:
        for name in arguments.names:
            scene = lumel.load(scene_file(name, Path(out)))
            subject = Subject(matt(scene) if arguments.matt else scene, threads=1)
            core = subject.core
            for window in WINDOWS:
                session = subject.session(1, window=window or 0, gather=GATHER, most_gathering=MOST_GATHERING)
                direction, ray = measured(session)
                nominal = rays_of_direction(core, window)
                size = f"{core.triangles:,} | {core.patches:,} | {window or 'default'}"
                times = f"{direction * 1e3:.2f} | {ray * 1e9:.0f} | {direction / ray:,.0f}"
                print(
                    f"| `{Path(name).stem}`{kind} | {size} | {times} | {nominal:,.0f} | {nominal * ray / direction - 1:+.0%} |", flush=True
                )


if __name__ == "__main__":
    main()
