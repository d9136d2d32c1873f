"""`lumel info`: what is in a scene, before it is rendered."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

from ..errors import Problem, SettingsError
from . import options, text, values
from .errors import reporting

if TYPE_CHECKING:
    from ..scene import Camera, Material, Scene

PROBLEMS = {
    "degenerate": "without area",
    "duplicate": "there twice",
    "huge": "too large to trace",
    "nonfinite": "with coordinates that are not finite",
}
"""What can be wrong with a triangle: key in the JSON -> what to say of it."""


def info(
    scene: options.Scene,
    as_json: options.Json = False,
    patches: options.Patches = None,
    define: options.Define = None,
    lenient: options.Lenient = False,
) -> None:
    """Show what is in SCENE: triangles, patches, lights, materials, cameras, memory, and what was ignored."""
    problems: list[Problem] = []
    defines = values.defines(define or [], problems)
    count = values.count("--patches", patches, problems)
    with reporting():
        if problems:
            raise SettingsError(problems)
        from ..readers import load
        from ..render import describe

        loaded = load(scene, defines=defines, lenient=lenient)
        found = collect(loaded, describe(loaded, patches=count))
        print(text.to_json(found, indent=2) if as_json else tell(found))


def collect(scene: Scene, described: dict[str, Any]) -> dict[str, Any]:
    """Everything that `--json` prints, from the scene and what the core says of it (see docs/cli.md for the keys)."""
    return {
        "scene": scene.source,
        "triangles": described["triangles"],
        "patches": described["patches"],
        "surface_area": described["surface_area"],
        "memory_bytes": described["memory_bytes"],
        "problems": {key: described[key] for key in PROBLEMS},
        "power": list(described["power"]),
        "lights": [{**light, "power": list(light["power"])} for light in described["lights"]],
        "materials": [_material(material) for material in scene.materials.values()],
        "meshes": [{"name": mesh.name, "triangles": len(mesh.triangles), "material": mesh.material} for mesh in scene.meshes],
        "cameras": [_camera(camera) for camera in scene.cameras],
        "notes": list(scene.notes),
    }


def tell(found: dict[str, Any]) -> str:
    """The same for people."""
    lines = [
        f"scene      {found['scene']}",
        f"triangles  {found['triangles']:,} in {len(found['meshes']):,} meshes, {found['surface_area']:.4g} m2",
        f"patches    {found['patches']:,}",
        f"memory     about {math.ceil(found['memory_bytes'] / 2**20):,} MB",
        f"lights     {len(found['lights'])}, {text.rgb(found['power'])} W in all",
        *(f"  {light['name']} ({light['kind']}): {text.rgb(light['power'])} W" for light in found["lights"]),
        f"materials  {len(found['materials'])}",
        *(f"  {material['name']}: {_shares(material)}" for material in found["materials"]),
        f"cameras    {len(found['cameras'])}",
        *(f"  {c['name']}: {c['width']}x{c['height']}, {c['fov']:g} degrees ({c['fov_axis']})" for c in found["cameras"]),
        *(f"problem: {count:,} triangles {PROBLEMS[key]}" for key, count in found["problems"].items() if count),
        *(f"note: {note}" for note in found["notes"]),
    ]
    return "\n".join(lines)


def _material(material: Material) -> dict[str, Any]:
    return {
        "name": material.name,
        "diffuse": list(material.diffuse),
        "specular": list(material.specular),
        "mirror": list(material.mirror),
        "alpha": material.alpha,
        "eta": None if material.eta is None else list(material.eta),
        "k": None if material.eta is None else list(material.k),
        "two_sided": material.two_sided,
    }


def _shares(material: dict[str, Any]) -> str:
    """`diffuse 0.5 0.5 0.5, specular 0.2 0.2 0.2 (alpha 0.1), one-sided`, of those parts that reflect."""
    parts = [f"{part} {text.rgb(material[part])}" for part in ("diffuse", "specular", "mirror") if any(material[part])]
    if any(material["specular"]):
        parts.append(f"alpha {material['alpha']:g}")
    if not material["two_sided"]:
        parts.append("one-sided")
    return ", ".join(parts) or "black"


def _camera(camera: Camera) -> dict[str, Any]:
    return {
        "name": camera.name,
        "width": camera.width,
        "height": camera.height,
        "fov": camera.fov,
        "fov_axis": camera.fov_axis,
        "position": [float(x) for x in camera.to_world[:3, 3]],
        "forward": [float(x) for x in camera.to_world[:3, 2]],
    }
