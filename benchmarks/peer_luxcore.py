"""LuxCore as a peer: render one scene and keep the picture at geometric time steps. Run by `peers.py`, which hands the scene over.

Needs the interpreter that pyluxcore is installed for, and numpy; nothing of lumel. Reads one JSON object from stdin: `scene` (npz that
`peers.export` wrote), `threads`, `times` (s), `seed`, `out` (folder). Prints one JSON object a line: `time` (s since the start of
rendering), `file` (npz: `mean`, (1, h, w, 3)). LuxCore's microfacets and Fresnel terms are not those of the scene file, so
its gloss is only alike: its pictures are to be compared with its own.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np  # before pyluxcore, whose memory allocator replaces that of what is loaded later

MOMENT = 0.01  # s between two looks at the clock


def main() -> None:
    """Do what stdin asks for."""
    task = json.load(sys.stdin)
    with talking_to_stderr() as answers:
        try:
            import pyluxcore as lux
        except ImportError as error:
            raise SystemExit(f"LuxCore cannot be loaded by {sys.executable}: {error}") from error
        lux.Init()
        with np.load(task["scene"]) as data:
            about = json.loads(str(data["about"]))
            config = lux.RenderConfig(properties(lux, settings(about, task)), scene_of(lux, data, about))
        height, width = about["height"], about["width"]
        session = lux.RenderSession(config)
        begin = time.monotonic()
        session.Start()
        for until in task["times"]:
            while time.monotonic() - begin < until:
                time.sleep(MOMENT)
            image = np.zeros((height, width, 3), np.float32)
            session.GetFilm().GetOutputFloat(lux.FilmOutputType.RGB_IMAGEPIPELINE, image, 0)
            spent = time.monotonic() - begin
            file = str(Path(task["out"]) / f"luxcore-{task['seed']}-{until:g}.npz")
            np.savez(file, mean=image[None, ::-1])
            print(json.dumps({"time": spent, "file": file}), file=answers, flush=True)
        session.Stop()


@contextlib.contextmanager
def talking_to_stderr() -> Iterator[Any]:
    """LuxCore prints to stdout: give it stderr instead, and the caller what leads to stdout."""
    with os.fdopen(os.dup(1), "w") as answers:
        os.dup2(2, 1)
        yield answers


def properties(lux: Any, values: dict[str, Any]) -> Any:
    """Values by name as LuxCore wants them."""
    made = lux.Properties()
    for name, value in values.items():
        made.Set(lux.Property(name, value if isinstance(value, list) else [value]))
    return made


def settings(about: dict[str, Any], task: dict[str, Any]) -> dict[str, Any]:
    """Path tracing on the processor, pictures without tone mapping or filter."""
    return {
        "renderengine.type": "PATHCPU",
        "renderengine.seed": task["seed"] + 1,
        "sampler.type": "SOBOL",
        "native.threads.count": task["threads"],
        "path.pathdepth.total": 64,
        "path.pathdepth.diffuse": 64,
        "path.pathdepth.glossy": 64,
        "path.pathdepth.specular": 64,
        "film.width": about["width"],
        "film.height": about["height"],
        "film.filter.type": "NONE",
        "film.imagepipelines.0.0.type": "NOP",
        "film.outputs.0.type": "RGB_IMAGEPIPELINE",
        "film.outputs.0.filename": "unused.exr",
    }


def scene_of(lux: Any, data: Any, about: dict[str, Any]) -> Any:
    """The meshes of `data` with the camera and the materials of `about`."""
    scene = lux.Scene()
    values: dict[str, Any] = {"scene.camera.type": "perspective", "scene.camera.autofocus.enable": False}
    to_world = np.array(about["to_world"])
    values["scene.camera.lookat.orig"] = to_world[:3, 3].tolist()
    values["scene.camera.lookat.target"] = (to_world[:3, 3] + to_world[:3, 2]).tolist()
    values["scene.camera.up"] = to_world[:3, 1].tolist()
    # LuxCore's field of view is that of the shorter side.
    values["scene.camera.fieldofview"] = math.degrees(2 * math.atan(about["tan_half"]))
    for i, mesh in enumerate(about["meshes"]):
        vertices, triangles = data[f"vertices {i}"].astype(float), data[f"triangles {i}"]
        scene.DefineMesh(f"mesh{i}", [tuple(v) for v in vertices.tolist()], [tuple(t) for t in triangles.tolist()], None, None, None, None)
        values.update(material(f"material{i}", mesh))
        values[f"scene.objects.object{i}.shape"] = f"mesh{i}"
        values[f"scene.objects.object{i}.material"] = f"material{i}"
    scene.Parse(properties(lux, values))
    return scene


def material(name: str, mesh: dict[str, Any]) -> dict[str, Any]:
    """A matt material, or a mix of it and metal; with the light that it emits."""
    at = f"scene.materials.{name}"
    share = max(mesh["specular"])
    matt = [min(1.0, d / (1 - share)) if share < 1 else 0.0 for d in mesh["diffuse"]]
    if not share > 0:
        return {f"{at}.type": "matte", f"{at}.kd": matt, **({f"{at}.emission": mesh["emission"]} if max(mesh["emission"]) > 0 else {})}
    return {
        f"{at}-matt.type": "matte",
        f"{at}-matt.kd": matt,
        f"scene.textures.{name}.type": "fresnelcolor",
        f"scene.textures.{name}.kr": [s / share for s in mesh["specular"]],
        f"{at}-metal.type": "metal2",
        f"{at}-metal.fresnel": name,
        f"{at}-metal.uroughness": mesh["alpha"],
        f"{at}-metal.vroughness": mesh["alpha"],
        f"{at}.type": "mix",
        f"{at}.material1": f"{name}-matt",
        f"{at}.material2": f"{name}-metal",
        f"{at}.amount": share,
    }


if __name__ == "__main__":
    main()
