"""A glossy Cornell box: two boxes, the tall one glossy, on a glossy floor under one lamp."""

from __future__ import annotations

from ..scene import Camera, Scene
from .parts import LAMP, box, glossy, lamp, matte, mesh, room


def scene() -> Scene:
    """A closed room, 2 m wide and high, 3.2 m long; one camera, `main`."""
    materials = (
        matte("white", (0.73, 0.73, 0.73)),
        matte("left wall", (0.63, 0.06, 0.05)),
        matte("right wall", (0.14, 0.45, 0.09)),
        glossy("floor", (0.7, 0.7, 0.7), 0.4, 0.2),
        glossy("tall box", (0.6, 0.6, 0.7), 0.5, 0.12),
        LAMP,
    )
    known = {material.name: material for material in materials}
    meshes = (
        *(mesh(name, form, name if name in known else "white") for name, form in room(1.0, 2.0, 1.6)),
        mesh("tall box", box((-0.35, 0.6, -0.9), (0.3, 0.6, 0.3), turn=18), "tall box"),
        mesh("short box", box((0.36, 0.3, -0.3), (0.3, 0.3, 0.3), turn=-17), "white"),
        lamp("lamp", (0.0, 1.995, -0.5), 0.25, 0.2, (17.0, 12.0, 7.0)),
    )
    camera = Camera.look_at("main", (0.0, 1.0, 1.55), (0.0, 0.95, -1.0), fov=62, width=256, height=256)
    return Scene(meshes, known, cameras=(camera,), source="lumel:cornell")
