"""Meshes of simple forms, each (vertices, triangles, normals).

Vertices and normals are float64 (n, 3); triangles are int32 (m, 3), counter-clockwise from the front.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Indices = npt.NDArray[np.int32]
Form = tuple[Floats, Indices, Floats]
Vec = tuple[float, float, float]


def rectangle(center: Vec, half_u: Vec, half_v: Vec) -> Form:
    """Two triangles that span `center` +- `half_u` +- `half_v`; the front faces along half_u x half_v."""
    c, u, v = (np.asarray(x, dtype=np.float64) for x in (center, half_u, half_v))
    normal = np.cross(u, v)
    vertices = np.stack([c - u - v, c + u - v, c + u + v, c - u + v])
    return vertices, np.array([(0, 1, 2), (0, 2, 3)], dtype=np.int32), np.tile(normal / np.linalg.norm(normal), (4, 1))


def box(center: Vec, half: Vec, turn: float = 0.0) -> Form:
    """A closed box with half sides `half`, turned by `turn` degrees about the y axis through its centre; six faces of four vertices."""
    sides = []
    for axis in range(3):
        for sign in (1.0, -1.0):
            face, u, v = np.zeros((3, 3))
            face[axis], u[(axis + 1) % 3], v[(axis + 2) % 3] = sign * half[axis], half[(axis + 1) % 3], sign * half[(axis + 2) % 3]
            sides.append((face, u, v))
    cos, sin = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    rotate = np.array([(cos, 0, sin), (0, 1, 0), (-sin, 0, cos)])
    parts = [rectangle(*(_vec(rotate @ x) for x in side)) for side in sides]
    vertices = np.concatenate([part[0] for part in parts]) + np.asarray(center)
    triangles = np.concatenate([part[1] + 4 * i for i, part in enumerate(parts)]).astype(np.int32)
    return vertices, triangles, np.concatenate([part[2] for part in parts])


def icosphere(center: Vec, radius: float, level: int, *, inward: bool = False) -> Form:
    """A closed sphere of 20 * 4**`level` nearly equal triangles with exact normals; `inward` turns its front to the centre."""
    # The twelve corners of an icosahedron are those of three golden rectangles; its faces are the triples of mutual neighbours.
    g = (1 + np.sqrt(5)) / 2
    points = np.array([np.roll((0.0, a, b * g), k) for k in range(3) for a in (-1, 1) for b in (-1, 1)])
    close = [t for t in combinations(range(12), 3) if all(np.sum((points[i] - points[j]) ** 2) < 4.1 for i, j in combinations(t, 2))]
    outward = [t if np.linalg.det(points[list(t)]) > 0 else t[::-1] for t in close]
    triangles = np.array(outward, dtype=np.int32)
    points = points / np.linalg.norm(points, axis=1, keepdims=True)
    for _ in range(level):
        points, triangles = _subdivide(points, triangles)
    vertices = np.asarray(center) + radius * points
    return (vertices, triangles[:, ::-1].copy(), -points) if inward else (vertices, triangles, points)


def _subdivide(points: Floats, triangles: Indices) -> tuple[Floats, Indices]:
    """Split each triangle in four, with the new vertices on the unit sphere."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    unique, index = np.unique(edges, axis=0, return_inverse=True)
    middle = points[unique].sum(axis=1)
    middle /= np.linalg.norm(middle, axis=1, keepdims=True)
    ab, bc, ca = (index.reshape(3, -1) + len(points)).astype(np.int32)
    a, b, c = triangles.T
    split = np.concatenate([np.stack(t, axis=1) for t in ((a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca))])
    return np.concatenate([points, middle]), split


def _vec(v: Floats) -> Vec:
    return float(v[0]), float(v[1]), float(v[2])
