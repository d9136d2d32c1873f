"""lumel against Mitsuba 3 on the same scene files, size and threads: error over time, and how much sooner an error is reached.

python benchmarks/peers.py [--mitsuba-python PATH] [--most SECONDS] [--cameras N] [SCENE ...]

Every renderer runs in its own process, one after the other. Times start when the files are read: lumel's tessellation, acceleration
structure and tables are counted, Mitsuba's loading and compilation of kernels are not. Errors are relMSE against the reference of the
first camera less the noise of the reference itself; with N cameras the times are those of all of them. LuxCore, if `--peers` has it and
`--luxcore-python` has pyluxcore, renders one camera, and is compared with two long renders of its own: its gloss is only alike. Scenes
are the names of reference scenes, of generated ones (see `generated.py`; their references are made by Mitsuba's path tracer, once), or
files.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from curves import draw
from scenes import NAMES, folder, machine, scene_file

import lumel
from lumel.images import read_picture
from lumel.images.compare import compare
from lumel.scene import FloatArray

HERE = Path(__file__).resolve().parent
OTHER_SEED = 1 << 24  # of references
TARGETS = (5e-3, 1e-3)  # relMSE
PEERS = (("path", "llvm_ad_rgb"), ("ptracer", "llvm_ad_rgb"), ("path", "scalar_rgb"))
LLVM = Path("/usr/lib/x86_64-linux-gnu/libLLVM-19.so")  # of Debian's libllvm19
Curve = list[tuple[float, float]]  # seconds, relMSE


def main() -> None:
    """Measure, print a Markdown table, draw the curves."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--mitsuba-python", default=os.environ.get("MITSUBA_PYTHON", sys.executable), help="interpreter that has Mitsuba")
    parser.add_argument("--luxcore-python", default=os.environ.get("LUXCORE_PYTHON", sys.executable), help="interpreter that has pyluxcore")
    parser.add_argument("--peers", default="path", help="of path, ptracer, scalar, luxcore, separated by commas (default: %(default)s)")
    parser.add_argument("--most", type=float, default=16, help="seconds of the longest render (default: %(default)g)")
    parser.add_argument("--least", type=float, default=0.25, help="seconds of the shortest render (default: %(default)g)")
    parser.add_argument("--cameras", type=int, default=1, help="views to render, the first is the scene's own (default: %(default)s)")
    parser.add_argument("--threads", type=int, default=len(os.sched_getaffinity(0)), help="of each renderer (default: all)")
    parser.add_argument(
        "--reference", type=float, default=120, help="seconds for the reference of a scene that has none (default: %(default)g)"
    )
    parser.add_argument("--option", action="append", default=[], metavar="NAME=VALUE", help="an option of lumel.render; may be repeated")
    parser.add_argument("-o", "--out", type=Path, default=Path("out/peers"), help="folder of the curves (default: %(default)s)")
    parser.add_argument("names", nargs="*", default=NAMES, metavar="SCENE")
    arguments = parser.parse_args()
    wanted = [p for p in PEERS if ("scalar" if p[1].startswith("scalar") else p[0]) in arguments.peers.split(",")]
    require("mitsuba", arguments.mitsuba_python, "--mitsuba-python")
    if "luxcore" in arguments.peers.split(","):
        require("pyluxcore", arguments.luxcore_python, "--luxcore-python")
    arguments.out.mkdir(parents=True, exist_ok=True)
    print(machine(), end="\n\n")
    print("| scene | renderer | compile, s | " + " | ".join(f"s to {t:g}" for t in TARGETS) + " | last: s | relMSE | of 8x8 means |")
    print("|---|---|---" + "|---" * len(TARGETS) + "|---|---|---|")
    for name in arguments.names:
        measure(name, wanted, arguments)


def measure(name: str, peers: Sequence[tuple[str, str]], arguments: argparse.Namespace) -> None:
    """All renderers on one scene: a line of the table each, the ratios, and a picture of the curves."""
    scene = scene_file(name, arguments.out)
    truth = reference_of(name, scene, arguments)
    steps = np.geomspace(arguments.least, arguments.most, 1 + max(1, round(2 * np.log2(arguments.most / arguments.least))))
    task: dict[str, Any] = {"scene": str(scene), "threads": arguments.threads, "times": steps.tolist(), "seed": 0}
    task["cameras"] = views(scene, arguments.cameras)
    options = {
        key: json.loads(value) if value[:1] in "0123456789tf" else value for key, value in (o.split("=", 1) for o in arguments.option)
    }
    found: dict[str, Curve] = {}
    reached: dict[str, list[float]] = {}
    with tempfile.TemporaryDirectory() as folder:
        runs = [("lumel", [sys.executable, HERE / "peer_lumel.py"], {"options": options})]
        for kind, variant in peers:
            command = [arguments.mitsuba_python, HERE / "peer_mitsuba.py"]
            runs.append((f"Mitsuba {kind} {variant.split('_')[0]}", command, {"integrator": kind, "variant": variant}))
        truths = dict.fromkeys((label for label, _, _ in runs), truth)
        if "luxcore" in arguments.peers.split(","):
            handed = export(scene, arguments.out)
            runs.append(("LuxCore", [arguments.luxcore_python, HERE / "peer_luxcore.py"], {"scene": str(handed)}))
            truths["LuxCore"] = luxcore_reference(handed, arguments)
        for label, command, more in runs:
            curve, compile_s, coarse = [], "", 0.0
            for said in run([str(part) for part in command], {**task, **more, "out": folder}):
                if "compile" in said:
                    compile_s = f"{said['compile']:.2f}"
                    continue
                with np.load(said["file"]) as data:
                    errors = compare(data["mean"][0], truths[label]["rgb"], None, truths[label]["stderr"])
                curve.append((said["time"], float(errors.relmse_without_noise or 0)))
                coarse = float(errors.relmse_8x8_without_noise or 0)
            times = [time_to(curve, target) for target in TARGETS]
            said_times = " | ".join(f"{t:.2f}" if t < np.inf else "-" for t in times)
            if label != "lumel":
                said_times = " | ".join(
                    f"{t:.2f}" if t < np.inf else f"~{expected(curve, g):.0f}" for t, g in zip(times, TARGETS, strict=True)
                )
                times = [t if t < np.inf else expected(curve, g) for t, g in zip(times, TARGETS, strict=True)]
            found[label], reached[label] = curve, times
            print(
                f"| `{name}` | {label} | {compile_s} | {said_times} | {curve[-1][0]:.1f} | {curve[-1][1]:.2g} | {coarse:.2g} |", flush=True
            )
    for label in list(reached)[1:]:
        ratios = (f"{b / a:.1f}" if a < np.inf else "-" for a, b in zip(reached["lumel"], reached[label], strict=True))
        print(f"| `{name}` | {label} / lumel | | {' | '.join(ratios)} | | | |", flush=True)
    draw(
        found,
        f"{name}, {arguments.cameras} camera(s), {arguments.threads} threads",
        TARGETS,
        arguments.out / f"{name}-{arguments.cameras}.png",
    )


def run(command: list[str], task: dict[str, Any]) -> list[dict[str, Any]]:
    """What a peer printed, line by line, once it has ended: to look at its pictures while it renders the next one would slow that down.
    Raises SystemExit where it fails; its last words are on stderr."""
    environment = {**os.environ, **({"DRJIT_LIBLLVM_PATH": str(LLVM)} if LLVM.exists() and "DRJIT_LIBLLVM_PATH" not in os.environ else {})}
    peer = subprocess.run(command, input=json.dumps(task), env=environment, stdout=subprocess.PIPE, text=True, check=False)
    if peer.returncode:
        raise SystemExit(f"{' '.join(command)} failed")
    return [json.loads(line) for line in peer.stdout.splitlines()]


def reference_of(name: str, scene: Path, arguments: argparse.Namespace) -> Mapping[str, FloatArray]:
    """Layers `rgb` and `stderr` of the first camera: of a reference scene, or made by Mitsuba's path tracer and kept beside the curves."""
    if name in NAMES:
        return read_picture(folder() / "reference" / f"{name}.exr").layers
    file = arguments.out / f"{scene.stem}-reference.npz"
    if not file.exists():
        task = {"scene": str(scene), "threads": arguments.threads, "times": [arguments.reference], "seed": OTHER_SEED}
        task["cameras"] = views(scene, 1)
        with tempfile.TemporaryDirectory() as temporary:
            command = [arguments.mitsuba_python, str(HERE / "peer_mitsuba.py")]
            made, *_ = run(command, {**task, "out": temporary, "integrator": "path", "variant": "llvm_ad_rgb"})
            shutil.copy(made["file"], file)
    with np.load(file) as data:
        return {"rgb": data["mean"][0], "stderr": data["stderr"][0]}


def export(scene: Path, folder: Path) -> Path:
    """The first camera and the meshes of a scene in one file, for renderers that do not read the scene's own."""
    loaded = lumel.load(scene)
    camera = loaded.cameras[0]
    about = {
        "width": camera.width,
        "height": camera.height,
        "to_world": np.asarray(camera.to_world).tolist(),
        "tan_half": min(camera.tan_half()),
        "meshes": [
            {"emission": mesh.emission, **{key: getattr(loaded.materials[mesh.material], key) for key in ("diffuse", "specular", "alpha")}}
            for mesh in loaded.meshes
        ],
    }
    arrays = {f"{key} {i}": getattr(mesh, key) for i, mesh in enumerate(loaded.meshes) for key in ("vertices", "triangles")}
    file = folder / f"{scene.stem}-meshes.npz"
    np.savez(file, about=json.dumps(about), **arrays)
    return file


def luxcore_reference(handed: Path, arguments: argparse.Namespace) -> Mapping[str, FloatArray]:
    """The mean of two long renders of LuxCore, and what their difference says of its noise."""
    task: dict[str, Any] = {"scene": str(handed), "threads": arguments.threads, "times": [arguments.reference / 2]}
    halves = []
    with tempfile.TemporaryDirectory() as temporary:
        for seed in (OTHER_SEED, OTHER_SEED + 1):
            command = [arguments.luxcore_python, str(HERE / "peer_luxcore.py")]
            made, *_ = run(command, {**task, "seed": seed, "out": temporary})
            with np.load(made["file"]) as data:
                halves.append(data["mean"][0])
    return {"rgb": (halves[0] + halves[1]) / 2, "stderr": np.abs(halves[0] - halves[1]) / 2}


def require(module: str, python: str, flag: str) -> None:
    """End with a clear message where a peer is missing."""
    if subprocess.run([python, "-c", f"import numpy, {module}"], capture_output=True, check=False).returncode:
        raise SystemExit(f"{python} has no {module}: `pip install {module}` somewhere and name that interpreter with {flag}")


def time_to(curve: Curve, target: float) -> float:
    """When the error first is `target`, between two points by the straight line in logarithms; inf where it never is."""
    for i, (seconds, error) in enumerate(curve):
        if error > target:
            continue
        if i == 0:
            return seconds
        (t0, e0), e1 = curve[i - 1], max(error, 1e-12)
        return float(t0 * (seconds / t0) ** (np.log(e0 / target) / np.log(e0 / e1)))
    return float("inf")


def expected(curve: Curve, target: float) -> float:
    """When an unbiased renderer, whose error falls as 1/time, will have come to `target`, from the last half of its curve."""
    late = curve[len(curve) // 2 :]
    return float(np.exp(np.mean([np.log(seconds * max(error, 1e-12)) for seconds, error in late])) / target)


def views(scene: Path, count: int) -> list[list[list[float]]]:
    """`count` cameras: the scene's own, then others that turn to look all around, each a little further to the middle of the scene."""
    loaded = lumel.load(scene)
    first = loaded.cameras[0].to_world
    middle = np.mean(
        [np.concatenate([m.vertices.min(axis=0), m.vertices.max(axis=0)]).reshape(2, 3).mean(axis=0) for m in loaded.meshes], axis=0
    )
    matrices = []
    for i in range(count):
        angle = 2 * np.pi * i / count
        turn = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
        matrix = np.array(first, dtype=np.float64)
        matrix[:3, :3] = turn @ matrix[:3, :3]
        matrix[[0, 2], 3] += 0.3 * i / count * (middle - matrix[:3, 3])[[0, 2]]
        matrices.append(matrix.tolist())
    return matrices


if __name__ == "__main__":
    main()
