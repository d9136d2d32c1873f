"""Triangles on their way from a file to the scene: positions, perhaps normals, and what transforms do to both."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from ..scene import FloatArray, IntArray
from .transforms import Matrix

Points = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int64]


@dataclass(frozen=True)
class Surface:
    """`vertices` (n, 3) in metres, `triangles` (m, 3) counter-clockwise seen from the front, `normals` (n, 3) of length 1 or None: flat.

    `left_out` says what of a file could not be used, "" where all of it could.
    """

    vertices: Points
    triangles: Indices
    normals: Points | None = None
    left_out: str = ""

    def placed(self, matrix: Matrix) -> Surface:
        """Moved by a (4, 4) matrix. A reflection turns the winding, and so the front, to the other side; normals stay on the front."""
        linear = matrix[:3, :3]
        vertices = self.vertices @ linear.T + matrix[:3, 3]
        if self.normals is None:
            return replace(self, vertices=vertices)
        side = np.sign(np.linalg.det(linear))
        return replace(self, vertices=vertices, normals=side * unit(self.normals @ np.linalg.inv(linear)))

    def flipped(self) -> Surface:
        """With front and back exchanged."""
        return Surface(self.vertices, self.triangles[:, ::-1], None if self.normals is None else -self.normals)

    def facing_normals(self) -> Surface:
        """With the triangles wound so that their front is where the normals point."""
        if self.normals is None:
            return self
        behind = np.einsum("ij,ij->i", self.cross_products(), self.normals[self.triangles].sum(axis=1)) < 0
        return replace(self, triangles=np.where(behind[:, None], self.triangles[:, ::-1], self.triangles))

    def cross_products(self) -> Points:
        """(m, 3): along each triangle's geometric normal, twice its area long."""
        a, b, c = (self.vertices[self.triangles[:, i]] for i in range(3))
        return np.asarray(np.cross(b - a, c - a))

    def area(self) -> float:
        """In m2."""
        return float(np.linalg.norm(self.cross_products(), axis=1).sum() / 2)

    def smooth(self) -> Surface:
        """With vertex normals: the mean of the faces around each vertex, weighted by their angles there."""
        faces = unit(self.cross_products())
        sums = np.zeros_like(self.vertices)
        for corner in range(3):
            here, after, before = (self.vertices[self.triangles[:, (corner + step) % 3]] for step in range(3))
            cos = np.einsum("ij,ij->i", unit(after - here), unit(before - here))
            np.add.at(sums, self.triangles[:, corner], faces * np.arccos(np.clip(cos, -1, 1))[:, None])
        # Where the faces cancel out, any one of them stands for all; where there is none, so does +z.
        lost = np.linalg.norm(sums, axis=1) < 1e-6
        if lost.any():
            stand_in = np.tile([0.0, 0.0, 1.0], (len(sums), 1))
            real = np.linalg.norm(faces, axis=1) > 0
            for corner in range(3):
                stand_in[self.triangles[real, corner]] = faces[real]
            sums[lost] = stand_in[lost]
        return replace(self, normals=unit(sums))

    def arrays(self) -> tuple[FloatArray, IntArray, FloatArray | None]:
        """Vertices, triangles and normals as the scene keeps them."""
        normals = None if self.normals is None else np.ascontiguousarray(self.normals, dtype=np.float32)
        return np.ascontiguousarray(self.vertices, dtype=np.float32), np.ascontiguousarray(self.triangles, dtype=np.int32), normals


def unit(vectors: Points) -> Points:
    """Each row scaled to length 1; rows of length 0 stay."""
    largest = np.abs(vectors).max(axis=1, keepdims=True, initial=0)
    scaled = vectors / np.where(largest > 0, largest, 1)  # so that squares neither overflow nor vanish
    length = np.linalg.norm(scaled, axis=1, keepdims=True)
    return np.asarray(scaled / np.where(length > 0, length, 1))
