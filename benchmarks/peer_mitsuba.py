"""Mitsuba 3 as a peer: render one scene file in passes and keep the picture at geometric time steps. Run by `peers.py`.

Needs the interpreter that Mitsuba is installed for, and numpy; nothing of lumel. Reads one JSON object from stdin:
`scene` (path), `integrator`, `variant`, `threads`, `cameras` ((4, 4) matrices; film and lens are those of the first sensor),
`times` (s), `out` (folder), `seed` (of the first pass; a reference must not share passes with what it is compared to). Prints one JSON
object a line: `time` (s of rendering alone), `file` (npz: `mean` and `stderr`, (cameras, h, w, 3)); at last `compile` (s that were spent
making kernels, which no `time` holds).
"""

from __future__ import annotations

import json
import sys
import time
from pathlib import Path

MOST_SAMPLES = 1 << 21  # camera samples in one pass: Mitsuba holds all of them in memory
FEWEST_PASSES = 2  # the standard error is that of the passes


def main() -> None:
    """Do what stdin asks for."""
    task = json.load(sys.stdin)
    try:
        import drjit as dr
        import mitsuba as mi
        import numpy as np

        mi.set_variant(task["variant"])
    except ImportError as error:
        raise SystemExit(f"Mitsuba cannot be loaded by {sys.executable}: {error}") from error
    dr.set_thread_count(task["threads"])
    dr.set_flag(dr.JitFlag.KernelHistory, True)
    scene = mi.load_file(task["scene"])
    integrator = mi.load_dict({"type": task["integrator"], "max_depth": -1})
    sensor = scene.sensors()[0]
    width, height = (int(n) for n in sensor.film().size())
    parameters = mi.traverse(scene)
    place = f"{sensor.id()}.to_world"

    def compiled() -> float:
        """Seconds spent on kernels since the last call."""
        return (
            sum(k["codegen_time"] + k["backend_time"] for k in dr.kernel_history() if "backend_time" in k and not k.get("cache_hit")) / 1e3
        )

    def render(camera: list[list[float]], spp: int, seed: int) -> np.ndarray:
        """One pass from one camera: (h, w, 3)."""
        if len(task["cameras"]) > 1:
            parameters[place] = mi.Transform4f(np.array(camera))
            parameters.update()
        return np.array(mi.render(scene, sensor=sensor, integrator=integrator, spp=spp, seed=seed), dtype=np.float64)

    # A pass that is not counted makes the kernels; what others make later is taken off.
    begin = time.monotonic()
    render(task["cameras"][0], 1, 0xFFFF)
    compile_s = compiled()
    speed = 1 / max(time.monotonic() - begin - compile_s, 1e-3) / len(task["cameras"])  # samples a pixel and second

    total, squares = np.zeros((2, len(task["cameras"]), height, width, 3))
    samples, passes, spent = 0, 0, 0.0
    for until in task["times"]:
        while spent < until or passes < FEWEST_PASSES:
            spp = int(min(MOST_SAMPLES // (width * height), max(1, (until - spent) * speed * 0.9)))
            begin = time.monotonic()
            for index, camera in enumerate(task["cameras"]):
                image = render(camera, spp, task["seed"] + passes * len(task["cameras"]) + index)
                total[index] += image * spp
                squares[index] += image**2 * spp
            seconds, extra = time.monotonic() - begin, compiled()
            compile_s, spent, samples, passes = compile_s + extra, spent + seconds - extra, samples + spp, passes + 1
            speed = samples / spent
        mean = total / samples
        stderr = np.sqrt(np.maximum(squares / samples - mean**2, 0) / (passes - 1))
        file = str(Path(task["out"]) / f"{task['variant']}-{task['integrator']}-{samples}.npz")
        np.savez(file, mean=mean.astype(np.float32), stderr=stderr.astype(np.float32))
        print(json.dumps({"time": spent, "file": file}), flush=True)
    print(json.dumps({"compile": compile_s}), flush=True)


if __name__ == "__main__":
    main()
