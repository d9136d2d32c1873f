"""lumel renders global illumination by shooting light, and measures it in many areas at once.

    scene = lumel.load("bust.xml")
    result = lumel.render(scene, transport="rays", estimator="weighted", time=10)
    result.write("bust.exr")

Names are imported when they are first used, so that `import lumel` and `lumel --help` answer at once.
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from . import quadrature
    from .errors import LumelError, OutputError, Problem, SceneError, SettingsError
    from .progress import Progress
    from .readers import load
    from .render import render
    from .result import Patches, Result
    from .scene import Camera, Material, Mesh, PointLight, Scene

    __version__: str

__all__ = [
    "Camera",
    "LumelError",
    "Material",
    "Mesh",
    "OutputError",
    "Patches",
    "PointLight",
    "Problem",
    "Progress",
    "Result",
    "Scene",
    "SceneError",
    "SettingsError",
    "__version__",
    "load",
    "quadrature",
    "render",
]

# Where each public name lives.
_HOMES = {
    "errors": ("LumelError", "OutputError", "Problem", "SceneError", "SettingsError"),
    "progress": ("Progress",),
    "readers": ("load",),
    "render": ("render",),
    "result": ("Patches", "Result"),
    "scene": ("Camera", "Material", "Mesh", "PointLight", "Scene"),
}
_HOME_OF = {name: home for home, names in _HOMES.items() for name in names}


def _find(name: str) -> Any:
    """Import a public name from its home on first use and keep it (PEP 562)."""
    value: Any
    if name == "__version__":
        from importlib.metadata import version

        value = version("lumel")
    elif name == "quadrature":
        value = import_module(".quadrature", __name__)
    elif name in _HOME_OF:
        value = getattr(import_module(f".{_HOME_OF[name]}", __name__), name)
    else:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    globals()[name] = value
    return value


if not TYPE_CHECKING:  # type checkers know the names from above, and report all others
    __getattr__ = _find


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))


class _Package(ModuleType):
    """Keeps `lumel.render` the function: the import system binds the submodule of that name over it."""

    def __setattr__(self, name: str, value: Any) -> None:
        super().__setattr__(name, value.render if name == "render" and isinstance(value, ModuleType) else value)


sys.modules[__name__].__class__ = _Package
