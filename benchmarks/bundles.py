"""How fast bundles of rays are, and how they compare with rays one by one: `python benchmarks/bundles.py [--scene NAME] [--window N]`.

A transfer is a pair of patches that see each other along a line of the window; each carries light both ways and counts once. Rounds of
bundles and of closest hits take turns, so that both meet the same load. Rates are given by the wall clock and by processor time, times the
threads: on a quiet machine both are the same. The closest hits are of rays from anywhere to anywhere, traced one by one. The fastest hits
that Embree makes here, of the rays that shooting traces, sorted by patch and eight at a time, are given as well, by the wall clock. It
needs the reference scenes; exits with 1 where a goal is missed in processor time.
"""

from __future__ import annotations

import argparse
import os
import resource
import statistics
import sys
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

import numpy as np
from scenes import NAMES, folder, machine

import lumel
from lumel import _core, bench
from lumel.core import to_core

PAIRS_PER_THREAD = 75e6  # a second
RATIO = 20.0  # transfers to closest hits
RAYS = 100_000  # of a round and thread
COPIED = 1 << 27  # bytes


@dataclass(frozen=True)
class Took:
    """Seconds by the wall clock, and of processor time divided by the threads."""

    wall: float
    cpu: float


def clock(work: Callable[[], object], threads: int) -> Took:
    """Do `work` and measure it."""
    wall, cpu = time.perf_counter(), time.process_time()
    work()
    return Took(time.perf_counter() - wall, (time.process_time() - cpu) / threads)


def bandwidth(threads: int) -> float:
    """Bytes a second of wall time that all threads together read and write when they copy large arrays: the best of some tries."""
    arrays = [(np.ones(COPIED // 8), np.zeros(COPIED // 8)) for _ in range(threads)]
    with ThreadPoolExecutor(threads) as pool:
        best = min(clock(lambda: list(pool.map(lambda pair: np.copyto(pair[1], pair[0]), arrays)), threads).wall for _ in range(5))
    return 2 * threads * COPIED / best


def main() -> int:
    """Print what was measured; gives 1 where a goal was missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--scene", default="bust", choices=NAMES)
    parser.add_argument("--patches", type=int, default=20_000, help="about how many; at least one a triangle")
    parser.add_argument("--window", type=int, default=1024, help="pixels along an edge")
    parser.add_argument("--directions", type=int, default=40, help="of a round")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)))
    args = parser.parse_args()
    print(f"{args.scene}, window {args.window}, on {args.threads} threads; {machine()}")

    loaded = lumel.load(str(folder() / f"{args.scene}.xml"))
    scene, _ = to_core(loaded, args.patches)
    raster, accel = _core.Raster(scene, args.threads), _core.Accel(scene)
    raster.sweep(args.window, args.threads, 0)
    rays = RAYS * args.threads
    sweeps: list[Took] = []
    shots: list[Took] = []
    counts: dict[str, float] = {}
    for seed in range(args.rounds):

        def sweep(seed: int = seed) -> None:
            for name, value in raster.sweep(args.window, args.directions, seed).items():
                counts[name] = counts.get(name, 0) + value / args.rounds

        sweeps.append(clock(sweep, args.threads))
        shots.append(clock(lambda seed=seed: accel.closest_hits(rays, seed, args.threads), args.threads))
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024

    # All that a thread holds is read and written once a sweep at least; what is read again and again stays in its cache.
    moved = 2 * raster.bytes / args.threads * args.directions / counts["fragments"]
    memory = bandwidth(args.threads)
    wall, cpu = (statistics.median(times) for times in ([t.wall for t in sweeps], [t.cpu for t in sweeps]))
    ratio = statistics.median(counts["pairs"] / s.cpu / (rays / h.cpu) for s, h in zip(sweeps, shots, strict=True))
    wall_ratio = statistics.median(counts["pairs"] / s.wall / (rays / h.wall) for s, h in zip(sweeps, shots, strict=True))

    def line(what: str, count: float, wall: float, cpu: float, unit: str = "M/s") -> None:
        scale = 1e6 if unit == "M/s" else 1
        print(f"{what:24} {count / wall / scale:9.2f} {unit} by the wall clock {count / cpu / scale:9.2f} {unit} of processor time")

    print(f"{scene.triangles} triangles, {scene.patches} patches")
    line("transfers", counts["pairs"], wall, cpu)
    line("fragments", counts["fragments"], wall, cpu)
    line("directions", args.directions, wall, cpu, "1/s")
    line("closest hits", rays, statistics.median(t.wall for t in shots), statistics.median(t.cpu for t in shots))
    print(f"transfers / closest hits {wall_ratio:9.1f}                       {ratio:9.1f}")
    fastest = bench.run(loaded, args.patches, 1, args.threads)["embree_rays_per_s"]
    print(f"hits, eight at a time    {fastest / 1e6:9.2f} M/s, transfers / hits {counts['pairs'] / wall / fastest:.1f}")
    print(f"fragments a line         {counts['fragments'] / counts['lines']:9.2f}")
    print(f"parity violations        {1e6 * counts['parity_violations'] / counts['lines']:9.3f} of a million lines")
    share = moved * counts["fragments"] / wall / memory
    print(f"bytes a fragment         {moved:9.2f}, in all {share:.1%} of the {memory / 1e9:.1f} GB/s of a copy")
    print(f"memory                   {raster.bytes / 1e6:9.1f} MB beside the scene, {peak:.0f} MB the whole process at most")
    return int(counts["pairs"] / cpu < PAIRS_PER_THREAD * args.threads or ratio < RATIO)


if __name__ == "__main__":
    sys.exit(main())
