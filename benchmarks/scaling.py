"""How time and memory grow with patches, rays, cameras and lamps: a table and a fitted exponent for each.

Every point is a process of its own, with a generated scene: `python benchmarks/scaling.py [patches|rays|cameras|lamps|large]...`. `large`
loads, solves and renders 5 M triangles, and says before how much memory it expects.
"""

from __future__ import annotations

import json
import math
import os
import resource
import subprocess
import sys
import time

import numpy as np

SIZES = {
    "patches": (1_000, 10_000, 100_000, 1_000_000, 5_000_000),
    "rays": (100_000, 1_000_000, 10_000_000),
    "cameras": (1, 4, 16, 64, 256),
    "lamps": (1, 10, 100, 1_000, 10_000),
}
FIXED = {"patches": 20_000, "rays": 1_000_000, "cameras": 1, "lamps": 1}
LARGE = 5_000_000  # triangles
ROOM_HEIGHT = 2.0  # m
BUMPS = 0.02  # m


def hills(triangles: int) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a square floor with gentle waves, of about as many triangles."""
    side = max(1, round(math.sqrt(triangles / 2)))
    x, z = np.meshgrid(np.linspace(-1, 1, side + 1), np.linspace(-1, 1, side + 1), indexing="ij")
    y = BUMPS * np.sin(9 * x) * np.cos(7 * z)
    index = np.arange((side + 1) ** 2, dtype=np.int64).reshape(side + 1, side + 1)
    a, b, c, d = index[:-1, :-1].ravel(), index[1:, :-1].ravel(), index[1:, 1:].ravel(), index[:-1, 1:].ravel()
    vertices = np.stack([x.ravel(), y.ravel(), z.ravel()], axis=1).astype(np.float32)
    return vertices, np.concatenate([np.stack([a, c, b], axis=1), np.stack([a, d, c], axis=1)]).astype(np.int32)


def scene(triangles: int, cameras: int, lamps: int):  # type: ignore[no-untyped-def]  # of lumel, which the parent does not import
    """A glossy floor under small square lamps, in a box, seen by eyes side by side."""
    from lumel import Camera, Material, Mesh, Scene

    def square(centre: tuple[float, float, float], half: float, up: bool) -> tuple[np.ndarray, np.ndarray]:
        corners = np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]], np.float32)
        faces = np.array([[0, 2, 1], [0, 3, 2]] if up else [[0, 1, 2], [0, 2, 3]], np.int32)
        return corners + np.array(centre, np.float32), faces

    meshes = [Mesh("floor", *hills(triangles), "gloss"), Mesh("ceiling", *square((0, ROOM_HEIGHT, 0), 1, up=False), "white")]
    row = math.ceil(math.sqrt(lamps))
    for i in range(lamps):
        x, z = (2 * (i % row + 0.5) / row - 1), (2 * (i // row + 0.5) / row - 1)
        lamp = square((x, 0.95 * ROOM_HEIGHT, z), 0.2 / row, up=False)
        meshes.append(Mesh(f"lamp {i}", *lamp, "white", emission=(20.0, 20.0, 20.0)))
    materials = {
        "gloss": Material("gloss", diffuse=(0.3, 0.3, 0.3), specular=(0.4, 0.4, 0.4), alpha=0.2),
        "white": Material("white", diffuse=(0.7, 0.7, 0.7)),
    }
    eyes = tuple(
        Camera.look_at(f"eye {i}", (-0.9 + 1.8 * (i + 0.5) / cameras, 1.2, 0.95), (0, 0, 0), width=160, height=120) for i in range(cameras)
    )
    return Scene(tuple(meshes), materials, cameras=eyes)


def measure(patches: int, rays: int, cameras: int, lamps: int, triangles: int = 1000) -> dict[str, float]:
    """Seconds of each part and peak memory, of one replica and one eye pass, in this process."""
    from lumel import _core
    from lumel.core import camera_to_core, to_core
    from lumel.render import DIRECT_SAMPLES, describe

    made = scene(triangles, cameras, lamps)
    threads = len(os.sched_getaffinity(0))
    times: dict[str, float] = {}
    last = time.perf_counter()

    def lap(name: str) -> None:
        nonlocal last
        now = time.perf_counter()
        times[name], last = now - last, now

    if triangles >= LARGE:
        expected = describe(made, patches=patches)["memory_bytes"]
        print(f"{triangles:,} triangles: about {expected / 2**30:.1f} GB of memory expected", file=sys.stderr)
        last = time.perf_counter()
    core, _ = to_core(made, patches)
    session = _core.Session(
        scene=core, cameras=[camera_to_core(camera) for camera in made.cameras], transport="rays", areas="patches", estimator="weighted",
        defensive=-1.0, gather=0.0, first_shot=True, direct_samples=DIRECT_SAMPLES, seed=0, threads=threads,
    )  # fmt: skip
    lap("load")
    session.begin_replica(rays // 4)
    lap("solve")
    session.step(rays)
    session.end_replica()
    lap("shoot")
    session.reconstruct()
    lap("fields")
    session.eye_pass(0, 4)
    lap("see")
    return {**times, "patches": core.patches, "rss": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024}


def point(**sizes: int) -> dict[str, float]:
    """`measure` in a process of its own."""
    line = [sys.executable, __file__, "--point", json.dumps(sizes)]
    found: dict[str, float] = json.loads(subprocess.run(line, check=True, stdout=subprocess.PIPE, text=True).stdout)
    return found


def exponent(sizes: list[float], values: list[float]) -> float:
    """Slope between the logarithms of the last two points: how it grows where it is large."""
    return math.log(values[-1] / values[-2]) / math.log(sizes[-1] / sizes[-2])


def main(wanted: list[str]) -> None:
    """Print a table for each of the numbers in `wanted`."""
    parts = ("load", "solve", "shoot", "fields", "see")
    for what in wanted:
        if what == "large":
            found = point(**{**FIXED, "patches": LARGE, "rays": 10_000_000, "triangles": LARGE})
            print("large:", ", ".join(f"{part} {found[part]:.1f} s" for part in parts), f"{found['rss'] / 2**30:.1f} GB")
            continue
        print(f"\n| {what} | {' | '.join(f'{part}, s' for part in parts)} | memory, MB |\n|{'---|' * (len(parts) + 2)}")
        rows = []
        for size in SIZES[what]:
            rows.append(point(**{**FIXED, what: size}))
            print(f"| {size:,} | {' | '.join(f'{rows[-1][part]:.2f}' for part in parts)} | {rows[-1]['rss'] / 2**20:,.0f} |", flush=True)
        sizes = [float(size) for size in SIZES[what]]
        fits = [exponent(sizes, [row[part] for row in rows]) for part in (*parts, "rss")]
        print(f"| exponent | {' | '.join(f'{fit:.2f}' for fit in fits)} |")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--point"]:
        print(json.dumps(measure(**json.loads(sys.argv[2]))))
    else:
        main(sys.argv[1:] or [*SIZES, "large"])
