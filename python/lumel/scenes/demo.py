"""The demo: a glossy bust on a plinth, in a room with coloured walls and a glossy floor, under two lamps."""

from __future__ import annotations

from ..scene import Camera, Scene
from .bust import bust
from .parts import LAMP, box, glossy, lamp, matte, mesh, room


def scene() -> Scene:
    """About 14,000 triangles, nearly all of them in the bust; cameras `main` and `side`."""
    plinth_top = 0.7
    sunk = 0.003  # the foot goes a little into the plinth, so that no two faces share a plane
    materials = (
        glossy("floor", (0.35, 0.3, 0.25), 0.35, 0.15),
        matte("white", (0.75, 0.75, 0.75)),
        matte("left wall", (0.55, 0.2, 0.12)),
        matte("right wall", (0.12, 0.25, 0.5)),
        matte("back wall", (0.45, 0.45, 0.45)),
        glossy("marble", (0.75, 0.7, 0.62), 0.45, 0.18),
        glossy("plinth", (0.4, 0.4, 0.4), 0.5, 0.1),
        LAMP,
    )
    known = {material.name: material for material in materials}
    meshes = (
        *(mesh(name, form, name if name in known else "white") for name, form in room(1.25, 2.5, 1.5)),
        mesh("plinth", box((0, plinth_top / 2, -0.3), (0.3, plinth_top / 2, 0.3)), "plinth"),
        mesh("bust", bust((0.0, plinth_top - sunk, -0.3), height=1.05, turn=14.0), "marble"),
        lamp("large lamp", (-0.5, 2.49, 0.2), 0.45, 0.3, (16.0, 15.0, 13.0)),
        lamp("small lamp", (0.85, 2.49, 0.9), 0.15, 0.15, (10.0, 14.0, 22.0)),
    )
    cameras = (
        Camera.look_at("main", (0.36, 1.4, 1.4), (0.03, 1.13, -0.3), fov=62, width=400, height=300),
        Camera.look_at("side", (-1.0, 1.0, 1.1), (0.0, 1.15, -0.3), fov=62, width=400, height=300),
    )
    return Scene(meshes, known, cameras=cameras, source="lumel:demo")
