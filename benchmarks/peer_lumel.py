"""lumel as a peer: render one scene file anew within each of some times. Run by `peers.py`.

Reads one JSON object from stdin: `scene` (path), `threads`, `cameras` ((4, 4) matrices; the film and lens are those of the first
camera), `times` (s), `out` (folder), `options` (of `lumel.render`). Prints one JSON object a line: `time` (s from when the files are
read until the picture is complete), `file` (npz: `mean`, (cameras, h, w, 3)), `rays`.
"""

from __future__ import annotations

import json
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

import lumel


def main() -> None:
    """Do what stdin asks for."""
    task = json.load(sys.stdin)
    scene = lumel.load(task["scene"])
    if len(task["cameras"]) > 1:
        views = [np.array(matrix) for matrix in task["cameras"]]
        scene = replace(scene, cameras=tuple(replace(scene.cameras[0], name=f"c{i}", to_world=v) for i, v in enumerate(views)))
    camera = "all" if len(task["cameras"]) > 1 else None
    for budget in task["times"]:
        begin = time.monotonic()
        result = lumel.render(scene, time=budget, camera=camera, threads=task["threads"], started=begin, **task["options"])
        seconds = time.monotonic() - begin
        file = str(Path(task["out"]) / f"lumel-{budget:g}.npz")
        np.savez(file, mean=np.stack([picture["rgb"] for picture in result.pictures.values()]))
        print(json.dumps({"time": seconds, "file": file, "rays": result.stats["rays"]}), flush=True)


if __name__ == "__main__":
    main()
