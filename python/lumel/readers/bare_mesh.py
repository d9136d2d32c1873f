"""A mesh file alone as a scene: the object in grey on a floor, with a lamp and a camera that fit its size."""

from __future__ import annotations

from pathlib import Path

from ..errors import SceneError
from ..scene import Mesh, Scene
from .defaults import GREY, framed_camera, studio
from .meshes import read_mesh


def read_bare_mesh(path: Path, lenient: bool) -> Scene:
    """The scene around the mesh in `path`. STL files stand on the plane of x and y, as is usual there, others on that of x and z.

    Raises SceneError as `read_mesh` does, and where that left out something unless `lenient`.
    """
    is_stl = path.suffix.lower() == ".stl"
    up = (0.0, 0.0, 1.0) if is_stl else (0.0, 1.0, 0.0)
    surface = read_mesh(path)
    if surface.left_out and not lenient:
        raise SceneError(surface.left_out)
    if not is_stl:
        surface = surface.facing_normals() if surface.normals is not None else surface.smooth()
    vertices, triangles, normals = surface.arrays()
    thing = Mesh(path.stem or "mesh", vertices, triangles, GREY.name, normals)
    around, materials = studio([thing], up)
    return Scene(
        (thing, *around),
        {GREY.name: GREY, **materials},
        cameras=(framed_camera([thing], up),),
        notes=(
            f"'{path.name}' is a mesh alone: a lamp, a grey floor and a camera are put around it; {'z' if is_stl else 'y'} is up",
            *([f"ignored: {surface.left_out}"] if surface.left_out else []),
        ),
        source=str(path),
    )
