"""Triangles of an implicit solid by naive surface nets (Gibson 1998): one vertex in each grid cell that the surface passes through.

The grid may be bent and graded: its nodes are given as points. Only cells near the surface are evaluated.
"""

from __future__ import annotations

from itertools import product

import numpy as np
import numpy.typing as npt

from .implicit import Field, Points, Values, Vec, probe

Nodes = npt.NDArray[np.float64]  # (nx, ny, nz, 3)
Indices = npt.NDArray[np.int64]
_BLUR = 0.27  # the form is seen through a filter of this share of a cell, so that no detail is finer than the mesh can show
_BLOCK = 4  # nodes along the side of a block that is evaluated or skipped as a whole


def fisheye(lo: Vec, hi: Vec, center: Vec, step: float, spread: float) -> Nodes:
    """A grid over the box from `lo` to `hi`, with cells `step` wide at `center` and about 1 + r/`spread` times that at distance r."""

    def shrink(distance: float) -> float:
        # The map below sends rho to rho + rho^2/(2 spread); this is its inverse, sign kept.
        return float(np.copysign(spread * (np.sqrt(1 + 2 * abs(distance) / spread) - 1), distance))

    lines = [
        step * np.arange(np.floor(shrink(a - c) / step), np.ceil(shrink(b - c) / step) + 1) for a, b, c in zip(lo, hi, center, strict=True)
    ]
    u = np.stack(np.meshgrid(*lines, indexing="ij"), axis=-1)
    rho = np.linalg.norm(u, axis=-1, keepdims=True)
    return np.asarray(center + u * (1 + rho / (2 * spread)))


def polygonise(field: Field, nodes: Nodes, relax: int = 2) -> tuple[Points, Indices, Points]:
    """Vertices (n, 3), triangles (m, 3) counter-clockwise from outside, and unit normals (n, 3) of the surface field = 0.

    The surface must lie inside the grid and be smooth at its scale, or edges may join more than two triangles. `relax`
    rounds slide the vertices along the surface towards the middle of their neighbours, for well-shaped triangles.
    """
    values = _sample(field, nodes)
    points, cell_vertex, size = _place(values, nodes)
    quads = _connect(values < 0, cell_vertex)
    for _ in range(relax):
        points, normals = _settle(field, points, size)
        points = _slide(points, quads, normals)
    points, _ = _settle(field, points, size)
    points, normals = _settle(field, points, size)
    return points, _split(points, quads), normals


def _sample(field: Field, nodes: Nodes) -> Nodes:
    """Field values (nx, ny, nz) at the nodes; blocks of nodes far from the surface hold the value at their centre."""
    shape = nodes.shape[:3]
    first = [np.arange(0, n, _BLOCK) for n in shape]
    last = [np.minimum(f + _BLOCK, n - 1) for f, n in zip(first, shape, strict=True)]
    corners = np.stack([nodes[np.ix_(*ends)] for ends in product(*zip(first, last, strict=True))])
    centers = corners.mean(axis=0)
    reach = np.linalg.norm(corners - centers, axis=-1).max(axis=0)
    values = field(centers.reshape(-1, 3)).reshape(reach.shape)
    # The fields are only about distances, so look half as far again as the corner of the block.
    near = np.abs(values) < 1.5 * reach
    for axis, n in enumerate(shape):
        values, near = (np.repeat(v, _BLOCK, axis=axis).take(np.arange(n), axis=axis) for v in (values, near))
    diagonal = np.linalg.norm(nodes[1:, 1:, 1:] - nodes[:-1, :-1, :-1], axis=-1)
    size = np.pad(diagonal, (0, 1), mode="edge") / np.sqrt(3)
    values[near], _ = probe(field, nodes[near], _BLUR * size[near])
    return values


def _place(values: Nodes, nodes: Nodes) -> tuple[Points, Indices, Values]:
    """One vertex per crossed cell: the mean of the crossings of its edges; also cell -> vertex (-1: none) and the size of each cell."""
    sign = values < 0
    nx, ny, nz = (n - 1 for n in values.shape)
    corners = list(product((0, 1), repeat=3))
    count = np.zeros((nx, ny, nz), dtype=np.int8)
    for a, b, c in corners:
        count += sign[a : a + nx, b : b + ny, c : c + nz]
    cell = np.stack(np.nonzero((count > 0) & (count < 8)), axis=1)
    total, hits = np.zeros((len(cell), 3)), np.zeros(len(cell))
    for corner, axis in product(corners, range(3)):
        if corner[axis]:
            continue
        n0 = cell + corner
        n1 = n0 + np.eye(3, dtype=np.int64)[axis]
        f0, f1 = values[tuple(n0.T)], values[tuple(n1.T)]
        crossed = (f0 < 0) != (f1 < 0)
        t = (f0[crossed] / (f0[crossed] - f1[crossed]))[:, None]
        total[crossed] += (1 - t) * nodes[tuple(n0[crossed].T)] + t * nodes[tuple(n1[crossed].T)]
        hits[crossed] += 1
    vertex = np.full((nx, ny, nz), -1, dtype=np.int64)
    vertex[tuple(cell.T)] = np.arange(len(cell), dtype=np.int64)
    size = np.linalg.norm(nodes[tuple((cell + 1).T)] - nodes[tuple(cell.T)], axis=1) / np.sqrt(3)
    return total / hits[:, None], vertex, size


def _connect(sign: npt.NDArray[np.bool_], vertex: Indices) -> Indices:
    """A quad (4 vertices, counter-clockwise from outside) around every grid edge that the surface crosses."""
    quads = []
    for axis in range(3):
        order = (axis, (axis + 1) % 3, (axis + 2) % 3)
        below = sign.transpose(order)[:, 1:-1, 1:-1]
        cells = vertex.transpose(order)
        i, j, k = np.nonzero(below[:-1] != below[1:])
        around = np.stack([cells[i, j, k], cells[i, j + 1, k], cells[i, j + 1, k + 1], cells[i, j, k + 1]], axis=1)
        # With the inside below, the normal points up the axis; else the order turns round.
        quads.append(np.where(below[i, j, k][:, None], around, around[:, ::-1]))
    return np.concatenate(quads)


def _settle(field: Field, points: Points, size: Values) -> tuple[Points, Points]:
    """Move the vertices onto the surface by a Newton step of at most half a cell; also the normals that were used."""
    distance, normals = probe(field, points, _BLUR * size)
    return points - np.clip(distance, -0.5 * size, 0.5 * size)[:, None] * normals, normals


def _slide(points: Points, quads: Indices, normals: Points) -> Points:
    """Move each vertex half way to the mean of its neighbours, along the surface only."""
    total, count = np.zeros_like(points), np.zeros(len(points))
    for side in range(4):
        a, b = quads[:, side], quads[:, (side + 1) % 4]
        total += np.stack([np.bincount(a, points[b, d], len(points)) for d in range(3)], axis=1)
        count += np.bincount(a, minlength=len(points))
    move = total / count[:, None] - points
    move -= np.einsum("ij,ij->i", move, normals)[:, None] * normals
    return np.asarray(points + 0.5 * move)


def _split(points: Points, quads: Indices) -> Indices:
    """Two triangles a quad, along its shorter diagonal."""
    p = points[quads]
    straight = np.linalg.norm(p[:, 0] - p[:, 2], axis=1) <= np.linalg.norm(p[:, 1] - p[:, 3], axis=1)
    even, odd = quads[:, [0, 1, 2, 0, 2, 3]], quads[:, [1, 2, 3, 1, 3, 0]]
    return np.where(straight[:, None], even, odd).reshape(-1, 3)
