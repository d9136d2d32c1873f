"""The built-in scenes, made by our own code: `lumel:demo`, `lumel:cornell`, `lumel:furnace`, `lumel:cube`."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from ..errors import SceneError, nearest
from ..scene import Scene
from . import cornell, cube, demo, furnace

__all__ = ["build", "names"]

_SCENES: Mapping[str, Callable[[], Scene]] = {
    "demo": demo.scene,
    "cornell": cornell.scene,
    "furnace": furnace.scene,
    "cube": cube.scene,
}


def names() -> tuple[str, ...]:
    """The names of the built-in scenes."""
    return tuple(_SCENES)


def build(name: str) -> Scene:
    """The built-in scene `name` (without `lumel:`), the same at every call. Raises SceneError where there is none of that name."""
    if name not in _SCENES:
        raise SceneError(f"there is no built-in scene '{name}': {nearest(name, _SCENES)}")
    return _SCENES[name]()
