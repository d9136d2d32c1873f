"""Scenes from files and by name."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType

from ..errors import SceneError, nearest
from ..scene import Scene
from .paths import read_file

BUILT_IN = "lumel:"
_MESHES = (".obj", ".ply", ".stl")
_NONE: Mapping[str, str] = MappingProxyType({})


def load(path_or_name: str | Path, *, defines: Mapping[str, str] = _NONE, lenient: bool = False) -> Scene:
    """The scene in a file (Mitsuba 3 XML, OBJ, PLY, STL), or the built-in one of that name, such as `lumel:demo`.

    `defines` gives values to the `$name`s of an XML file. `lenient` goes on without what is not supported, and lists it in `Scene.notes`.
    Raises SceneError with all that is wrong, each with its file and line.
    """
    text = str(path_or_name)
    if text.startswith(BUILT_IN):
        _refuse(defines, text)
        from ..scenes import build

        return build(text.removeprefix(BUILT_IN))
    path = Path(path_or_name)
    ending = path.suffix.lower()
    if ending == ".xml":
        from .mitsuba import read_mitsuba

        return read_mitsuba(path, defines, lenient)
    if ending in _MESHES:
        _refuse(defines, text)
        from .bare_mesh import read_bare_mesh

        return read_bare_mesh(path, lenient)
    read_file(path)  # a missing file is the better news than its ending
    raise SceneError(f"cannot read '{path}': unknown ending '{ending}'; {nearest(ending, ['.xml', *_MESHES])}")


def _refuse(defines: Mapping[str, str], name: str) -> None:
    if defines:
        raise SceneError(f"-D {next(iter(defines))}: only .xml scenes have names to define, '{name}' has none")
