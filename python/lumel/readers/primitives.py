"""Mitsuba's analytic shapes as triangles, in their own space. Curved ones have the area of the true surface and its exact normals."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from .surface import Indices, Points, Surface, unit

_DISK_SIDE = 16  # quads along the side of the square that is bent to a disk
_AROUND = 48  # quads around a cylinder
_MOST_RINGS = 16


@lru_cache
def rectangle() -> Surface:
    """-1..1 in x and y, facing +z; 2 triangles."""
    return Surface(np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]), np.array([[0, 1, 2], [0, 2, 3]]))


@lru_cache
def cube() -> Surface:
    """-1..1 in x, y and z, facing outwards; 12 triangles."""
    vertices = np.array([[x, y, z] for z in (-1.0, 1.0) for y in (-1.0, 1.0) for x in (-1.0, 1.0)])
    quads = np.array([[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
    return Surface(vertices, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))


@lru_cache
def sphere(level: int) -> Surface:
    """Radius 1, facing outwards: an icosahedron of which every triangle is cut in four, `level` times: 20 * 4^level triangles."""
    golden = (1 + 5**0.5) / 2
    corners = [(0.0, a, b * golden) for a in (-1, 1) for b in (-1, 1)]
    vertices = unit(np.array([np.roll(corner, turn) for turn in range(3) for corner in corners]))
    # Its faces are the triples of neighbours; the determinant tells how they are wound.
    near = vertices @ vertices.T > 0.4
    triples = [(i, j, k) for i in range(12) for j in range(i) for k in range(j) if near[i, j] and near[j, k] and near[k, i]]
    triangles = np.array([(i, j, k) if np.linalg.det(vertices[[i, j, k]]) > 0 else (i, k, j) for i, j, k in triples])
    for _ in range(level):
        vertices, triangles = _subdivide(vertices, triangles)
        vertices = unit(vertices)
    ball = Surface(vertices, triangles, vertices)
    return Surface(vertices * np.sqrt(4 * np.pi / ball.area()), triangles, vertices)


def _subdivide(vertices: Points, triangles: Indices) -> tuple[Points, Indices]:
    """Cut each triangle in four at the middles of its edges, which neighbours share."""
    edges = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    unique, inverse = np.unique(edges, axis=0, return_inverse=True)
    middles = len(vertices) + inverse.reshape(-1, 3)
    (a, b, c), (ab, bc, ca) = triangles.T, middles.T
    cut = [np.stack(corners, axis=1) for corners in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca))]
    return np.concatenate([vertices, vertices[unique].mean(axis=1)]), np.concatenate(cut)


def _grid(rows: int, columns: int) -> Indices:
    """The triangles of (rows + 1) x (columns + 1) points that are numbered row by row."""
    first = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    right, above = first + 1, first + columns + 1
    return np.concatenate([np.stack([first, right, above + 1], axis=1), np.stack([first, above + 1, above], axis=1)])


@lru_cache
def disk() -> Surface:
    """Radius 1 in x and y, facing +z: a square grid bent by Shirley's concentric map, so that all triangles are of like size and shape."""
    line = np.linspace(-1, 1, _DISK_SIDE + 1)
    x, y = (part.ravel() for part in np.meshgrid(line, line))
    wide = np.abs(x) >= np.abs(y)
    radius = np.where(wide, x, y)
    ratio = np.divide(np.where(wide, y, x), radius, out=np.zeros_like(x), where=radius != 0) * np.pi / 4
    angle = np.where(wide, ratio, np.pi / 2 - ratio)
    vertices = np.stack([radius * np.cos(angle), radius * np.sin(angle), np.zeros_like(x)], axis=1)
    flat = Surface(vertices, _grid(_DISK_SIDE, _DISK_SIDE))
    return Surface(vertices * np.sqrt(np.pi / flat.area()), flat.triangles)


def cylinder(p0: Points, p1: Points, radius: float) -> Surface:
    """The open tube around the segment from `p0` to `p1`, facing outwards."""
    axis = p1 - p0
    length = float(np.linalg.norm(axis))
    across = unit(np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])[None])[0]
    side = np.cross(axis / length, across)
    rings = int(np.clip(round(length * _AROUND / (2 * np.pi * radius)), 1, _MOST_RINGS))
    angles = np.linspace(0, 2 * np.pi, _AROUND + 1)
    angles[-1] = 0  # the seam closes exactly
    outward = np.cos(angles)[:, None] * across + np.sin(angles)[:, None] * side
    # The polygon is a little larger than the circle, so that it is as long.
    widened = radius * np.pi / (_AROUND * np.sin(np.pi / _AROUND))
    heights = np.linspace(0, 1, rings + 1)[:, None, None]
    vertices = (p0 + heights * axis + widened * outward).reshape(-1, 3)
    return Surface(vertices, _grid(rings, _AROUND), np.tile(outward, (rings + 1, 1)))
