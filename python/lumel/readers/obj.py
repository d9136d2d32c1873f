"""Reads Wavefront OBJ: positions, normals and faces.

trimesh, which reads the other formats, drops faces that it cannot understand; a picture with holes is worse than an error with a line.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np

from ..errors import Problem, SceneError
from .surface import Surface
from .values import numbers

_MOST_SHOWN = 20


class _Obj:
    def __init__(self) -> None:
        self.points: list[list[float]] = []
        self.normals: list[list[float]] = []
        self.corners: dict[tuple[int, int], int] = {}  # (position, normal or -1) -> vertex
        self.triangles: list[tuple[int, int, int]] = []

    def line(self, words: list[str]) -> None:
        """Take one line; raises ValueError."""
        kind, *rest = words
        if kind in ("v", "vn"):
            values = self.points if kind == "v" else self.normals
            values.append([])  # counts even if it is bad, so that faces are not blamed for it
            values[-1] = _coordinates(rest)
        elif kind == "f":
            if len(rest) < 3:
                raise ValueError(f"a face has 3 or more corners, not {len(rest)}")
            first, *others = [self._corner(word) for word in rest]
            self.triangles.extend((first, a, b) for a, b in pairwise(others))

    def _corner(self, word: str) -> int:
        """The vertex for `position`, `position/uv`, `position//normal` or `position/uv/normal`; texture coordinates are not used."""
        parts = word.split("/")
        point = _index(parts[0], len(self.points), "vertex")
        normal = _index(parts[2], len(self.normals), "normal") if len(parts) == 3 and parts[2] else -1
        return self.corners.setdefault((point, normal), len(self.corners))


def _coordinates(words: list[str]) -> list[float]:
    values = numbers(" ".join(words[:3]))
    if len(values) != 3:
        raise ValueError(f"needs 3 numbers, not {len(values)}")
    return values


def _index(word: str, count: int, what: str) -> int:
    """The 0-based number; OBJ counts from 1, and negative numbers from the last one back."""
    try:
        number = int(word)
    except ValueError:
        raise ValueError(f"'{word[:40]}' is not the number of a {what}") from None
    if not 1 <= abs(number) <= count:
        raise ValueError(f"there is no {what} {number}, only {count} come before this line")
    return number - 1 if number > 0 else count + number


def read_obj(data: bytes, name: str) -> Surface:
    """All faces of all groups as one surface; polygons are cut into fans. Normals are kept where every corner has one.

    Raises SceneError with the lines that cannot be read; `name` is the file's name in messages.
    """
    obj, problems = _Obj(), []
    text = data.decode("utf-8", errors="replace").replace("\\\n", " \0")  # a continued line still counts as one
    line = 0
    for line_text in text.split("\n"):
        line += 1
        words = line_text.split("#", 1)[0].replace("\0", " ").split()
        try:
            if words:
                obj.line(words)
        except ValueError as error:
            problems.append(Problem(str(error), name, line))
        line += line_text.count("\0")
    if problems:
        hidden = len(problems) - _MOST_SHOWN
        raise SceneError(problems[:_MOST_SHOWN] + ([Problem(f"and {hidden} more problems", name)] if hidden > 0 else []))
    corners = np.array(list(obj.corners), dtype=np.int64).reshape(-1, 2)
    points = np.array(obj.points).reshape(-1, 3)[corners[:, 0]]
    triangles = np.array(obj.triangles, dtype=np.int64).reshape(-1, 3)
    if len(corners) and (corners[:, 1] >= 0).all():
        return Surface(points, triangles, np.array(obj.normals)[corners[:, 1]])
    if (corners[:, 1] >= 0).any():  # corners that differ in the normal alone are one vertex again
        shared, inverse = np.unique(corners[:, 0], return_inverse=True)
        return Surface(np.array(obj.points)[shared], inverse.reshape(-1)[triangles])
    return Surface(points, triangles)
