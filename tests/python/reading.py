"""How the tests of the readers write small scenes."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import numpy.typing as npt
import pytest

from lumel.errors import SceneError
from lumel.readers import load
from lumel.scene import Material, Mesh, Scene


class Reader:
    """Loads scenes made of strings, in a folder of its own."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder

    def write(self, body: str, name: str = "scene.xml") -> Path:
        """Write `<scene>` with `body`, which starts in line 2."""
        path = self.folder / name
        path.write_text(f'<scene version="3.0.0">\n{body}\n</scene>\n')
        return path

    def scene(self, body: str, *, lenient: bool = False, defines: Mapping[str, str] | None = None) -> Scene:
        """The scene with this body."""
        return load(self.write(body), lenient=lenient, defines=defines or {})

    def mesh(self, shape: str) -> Mesh:
        """The only mesh of a scene with one shape."""
        (mesh,) = self.scene(shape).meshes
        return mesh

    def material(self, bsdf: str, *, lenient: bool = False) -> Material:
        """The material of a rectangle made of this bsdf."""
        (material,) = self.scene(f'<shape type="rectangle">{bsdf}</shape>', lenient=lenient).materials.values()
        return material

    def problems(self, body: str, *, lenient: bool = False, defines: Mapping[str, str] | None = None) -> list[tuple[int | None, str]]:
        """(line, message) of each problem of a scene that cannot be read."""
        with pytest.raises(SceneError) as caught:
            self.scene(body, lenient=lenient, defines=defines)
        return [(problem.line, problem.message) for problem in caught.value.problems]

    def problem(self, body: str, *, lenient: bool = False) -> str:
        """The message of the only problem, which is in line 2."""
        ((line, message),) = self.problems(body, lenient=lenient)
        assert line == 2
        return message


def crosses(mesh: Mesh) -> npt.NDArray[np.float64]:
    """(m, 3): the geometric normal of each triangle, twice its area long."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]].astype(np.float64) for i in range(3))
    return np.asarray(np.cross(b - a, c - a))


def normals(mesh: Mesh) -> npt.NDArray[np.float32]:
    """The vertex normals, which must be there."""
    assert mesh.normals is not None
    return mesh.normals


def area(mesh: Mesh) -> float:
    """In m2."""
    return float(np.linalg.norm(crosses(mesh), axis=1).sum() / 2)
