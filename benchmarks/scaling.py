"""How time and memory grow with patches, rays, cameras and lamps: a table and a fitted exponent for each.

Every point is a process of its own, with a generated scene: `python benchmarks/scaling.py [patches|rays|cameras|lamps|large]...
[--most N] [--processor]`. `--most` leaves out larger sizes, `--processor` gives processor time of all threads, which load on the machine
moves less. `large` writes a file of 5 M triangles (or N) and renders it by `lumel render`, which says before how much memory it expects.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from generated import Writer

SIZES = {
    "patches": (1_000, 10_000, 100_000, 1_000_000, 5_000_000),
    "rays": (100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000),
    "cameras": (1, 4, 16, 64, 256),
    "lamps": (1, 10, 100, 1_000, 10_000),
}
FIXED = {"patches": 20_000, "rays": 1_000_000, "cameras": 1, "lamps": 1}
PARTS = ("load", "solve", "shoot", "fields", "see")
LARGE, LARGE_RAYS = 5_000_000, 10_000_000  # triangles and rays of `large`
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


def write(triangles: int, folder: Path) -> Path:
    """Write about the same scene, with one lamp and one camera, to a file with a binary PLY beside it; gives the file."""
    vertices, corners = hills(triangles)
    faces = np.empty(len(corners), np.dtype([("count", "u1"), ("corners", "<i4", 3)]))
    faces["count"], faces["corners"] = 3, corners
    header = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertices)}\nproperty float x\nproperty float y\nproperty float z\n"
        f"element face {len(faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    (folder / "hills.ply").write_bytes(header.encode() + vertices.astype("<f4").tobytes() + faces.tobytes())
    w = Writer()
    w.matt("black", (0, 0, 0))
    white, gloss = w.matt("white", (0.7, 0.7, 0.7)), w.gloss("gloss", (0.5, 0.5, 0.5), 0.2, 0.4)
    w.lines.append(f'  <shape type="ply"><string name="filename" value="hills.ply"/><ref id="{gloss}"/></shape>')
    w.shape("rectangle", white, (0, ROOM_HEIGHT, 0), (1, 1, 1), (90, 0))
    w.lamp((0, 0.95 * ROOM_HEIGHT, 0), (0.2, 0.2), (20, 20, 20))
    w.camera((0, 1.2, 0.95), (0, 0, 0))
    file = folder / "hills.xml"
    file.write_text(w.text())
    return file


def measure(patches: int, rays: int, cameras: int, lamps: int) -> dict[str, float]:
    """Seconds of each part by the wall clock, and of processor time in `cpu PART`, and peak memory, of one replica and one eye pass."""
    from lumel import _core
    from lumel.core import camera_to_core, to_core
    from lumel.pace import RAYS_PER_STEP
    from lumel.render import DIRECT_SAMPLES

    made = scene(1000, cameras, lamps)
    times: dict[str, float] = {}
    wall, cpu = time.perf_counter(), time.process_time()

    def lap(name: str) -> None:
        nonlocal wall, cpu
        times[name], times[f"cpu {name}"] = time.perf_counter() - wall, time.process_time() - cpu
        wall, cpu = time.perf_counter(), time.process_time()

    core, _ = to_core(made, patches)
    cameras_of_core = [camera_to_core(camera) for camera in made.cameras]
    session = _core.Session(
        scene=core, cameras=cameras_of_core, transport="rays", areas="patches", estimator="weighted", defensive=-1.0, gather=0.0,
        weight_diffuse=None, first_shot=True, direct_samples=DIRECT_SAMPLES, seed=0, threads=len(os.sched_getaffinity(0)),
    )  # fmt: skip
    lap("load")
    session.begin_replica(min(rays, RAYS_PER_STEP) // 4)
    lap("solve")
    # Like a render, in steps that are not larger for more rays.
    for first in range(0, rays, RAYS_PER_STEP):
        session.step(min(RAYS_PER_STEP, rays - first))
    session.end_replica()
    lap("shoot")
    session.reconstruct()
    lap("fields")
    session.eye_pass(0, 4)
    lap("see")
    return {**times, "rss": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024}


def point(**sizes: int) -> dict[str, float]:
    """`measure` in a process of its own."""
    line = [sys.executable, __file__, "--point", json.dumps(sizes)]
    found: dict[str, float] = json.loads(subprocess.run(line, check=True, stdout=subprocess.PIPE, text=True).stdout)
    return found


def exponent(sizes: list[float], values: list[float]) -> float:
    """Slope between the logarithms of the last two points: how it grows where it is large."""
    return math.log(values[-1] / values[-2]) / math.log(sizes[-1] / sizes[-2])


def table(what: str, most: int, clock: str) -> None:
    """Print how each part grows with `what`; `clock` stands before the names of the parts in what `measure` gives."""
    sizes = [size for size in SIZES[what] if size <= most]
    keys = [clock + part for part in PARTS]
    print(f"\n| {what} | {' | '.join(f'{part}, s' for part in PARTS)} | memory, MB |\n|{'---|' * (len(PARTS) + 2)}")
    rows = []
    for size in sizes:
        row = point(**{**FIXED, what: size})
        print(f"| {size:,} | {' | '.join(f'{row[key]:.2f}' for key in keys)} | {row['rss'] / 2**20:,.0f} |", flush=True)
        rows.append(row)
    fits = [exponent([float(size) for size in sizes], [row[key] for row in rows]) for key in (*keys, "rss")]
    print(f"| exponent | {' | '.join(f'{fit:.2f}' for fit in fits)} |")


def large(triangles: int) -> None:
    """Render so many given triangles by the command line, which says before how much memory it expects."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        file = write(triangles, folder)
        begin = time.perf_counter()
        line = [sys.executable, "-m", "lumel", "render", file, "-o", folder / "hills.exr", "--rays", str(LARGE_RAYS), "--progress", "plain"]
        subprocess.run(line, check=True)
        took = time.perf_counter() - begin
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    processor = used.ru_utime + used.ru_stime
    print(
        f"\nlarge: {triangles:,} triangles and {LARGE_RAYS:,} rays took {took:.0f} s, {processor:.0f} s of processor time, "
        f"and {used.ru_maxrss / 2**20:.1f} GB"
    )


def main() -> None:
    """Print a table for each of the numbers that are wanted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("what", nargs="*", choices=[*SIZES, "large"], default=[*SIZES, "large"])
    parser.add_argument("--most", type=int, default=sys.maxsize)
    parser.add_argument("--processor", action="store_true")
    args = parser.parse_args()
    for what in args.what:
        if what == "large":
            large(min(LARGE, args.most))
        else:
            table(what, args.most, "cpu " if args.processor else "")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--point"]:
        print(json.dumps(measure(**json.loads(sys.argv[2]))))
    else:
        main()
