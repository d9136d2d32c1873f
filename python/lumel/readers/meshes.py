"""Reads OBJ, PLY and STL files as surfaces."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from ..errors import SceneError, nearest
from .obj import read_obj
from .paths import read_file
from .surface import Surface, unit


def read_mesh(path: Path) -> Surface:
    """The triangles of a mesh file, larger polygons cut into fans; normals where the file has one for each vertex.

    Triangles with a vertex that is not finite are left out, and `left_out` says so. Degenerate triangles pass. Raises SceneError that
    names the file and says how many vertices, indices or lines are bad.
    """
    data = read_file(path)
    ending = path.suffix.lower()
    if ending not in _READERS:
        raise SceneError(f"cannot read '{path}': '{ending}' is not the ending of a mesh file; {nearest(ending, _READERS)}")
    return _checked(_READERS[ending](data, path), path)


def _obj(data: bytes, path: Path) -> Surface:
    return read_obj(data, str(path))


def _ply(data: bytes, path: Path) -> Surface:
    from trimesh.exchange.ply import load_ply

    if data.startswith(b"ply") and b"end_header" not in data:
        raise SceneError(f"cannot read '{path}' as PLY: its header has no end")
    content = _guarded(load_ply, data, path, fix_texture=False)
    declared = content.get("metadata", {}).get("_ply_raw", {})
    faces = content.get("faces")
    for element, found in (("vertex", content.get("vertices")), ("face", faces)):
        expected, count = declared.get(element, {}).get("length", 0), 0 if found is None else len(found)
        if count < expected:
            raise SceneError(f"cannot read '{path}': {count} of {expected} elements '{element}' are there")
    return Surface(_floats(content.get("vertices"), path), _triangles(faces, path), _normals(content.get("vertex_normals"), path))


def _stl(data: bytes, path: Path) -> Surface:
    from trimesh.exchange.stl import load_stl

    content = _guarded(load_stl, data, path)
    return Surface(_floats(content.get("vertices"), path), _triangles(content.get("faces"), path))


def _guarded(load: Any, data: bytes, path: Path, **options: Any) -> dict[str, Any]:
    """What trimesh reads from `data`; broken files make it raise nearly anything."""
    try:
        with np.errstate(all="ignore"):
            content = load(io.BytesIO(data), **options)
    except Exception as error:  # there is no list of what it raises
        reason = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
        raise SceneError(f"cannot read '{path}' as {path.suffix[1:].upper()}: {reason}") from error
    return content if isinstance(content, dict) else {}


def _floats(values: Any, path: Path) -> npt.NDArray[np.float64]:
    try:
        return np.asarray([] if values is None else values, dtype=np.float64).reshape(-1, 3)
    except (TypeError, ValueError) as error:
        raise SceneError(f"cannot read '{path}': a vertex is not made of 3 numbers") from error


def _normals(values: Any, path: Path) -> npt.NDArray[np.float64] | None:
    return None if values is None else _floats(values, path)


def _triangles(faces: Any, path: Path) -> npt.NDArray[np.int64]:
    """(m, 3) from polygons of three or more corners."""
    rows = [] if faces is None else faces
    if isinstance(rows, np.ndarray) and rows.ndim == 2 and rows.shape[1] == 3:
        return np.asarray(rows, dtype=np.int64)
    try:
        polygons = np.asarray(rows, dtype=np.int64)
        if polygons.size == 0:
            return np.zeros((0, 3), dtype=np.int64)
        if polygons.ndim != 2 or polygons.shape[1] < 3:
            raise ValueError
    except (TypeError, ValueError) as error:
        raise SceneError(f"cannot read '{path}': a face has fewer than 3 corners, or one that is not a number") from error
    fans = [polygons[:, [0, corner, corner + 1]] for corner in range(1, polygons.shape[1] - 1)]
    return np.asarray(np.stack(fans, axis=1).reshape(-1, 3), dtype=np.int64)


_READERS = {".obj": _obj, ".ply": _ply, ".stl": _stl}


def _checked(surface: Surface, path: Path) -> Surface:
    vertices, triangles = surface.vertices, surface.triangles
    if not len(vertices) or not len(triangles):
        raise SceneError(f"'{path}' is empty: {len(vertices)} vertices, {len(triangles)} triangles")
    outside = ((triangles < 0) | (triangles >= len(vertices))).any(axis=1)
    if outside.any():
        found = f"{outside.sum()} of {len(triangles)} triangles have an index outside 0..{len(vertices) - 1}"
        raise SceneError(f"'{path}': {found}, the first is {triangles[outside][0].tolist()}")
    bad = ~(np.abs(vertices) < np.finfo(np.float32).max).all(axis=1)
    sound = ~bad[triangles].any(axis=1)
    left_out = ""
    if bad.any():
        left_out = f"'{path}': {bad.sum()} of {len(vertices)} vertices are NaN, infinite or beyond the range of float32"
        if not sound.any():
            raise SceneError(left_out)
        # Nothing uses them any more: let them be anywhere among the others.
        vertices = np.where(bad[:, None], vertices[~bad][0], vertices)
    normals = surface.normals
    has_normals = normals is not None and np.isfinite(normals).all() and bool(np.abs(normals).max(axis=1).all())
    return Surface(vertices, triangles[sound], unit(normals) if normals is not None and has_normals else None, left_out)
