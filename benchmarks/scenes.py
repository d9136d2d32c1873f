"""Where the reference scenes are, and on what machine they are rendered."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path

from generated import SCENES, write

from lumel.machine import load, processors
from lumel.scene import Scene

NAMES = ("bust", "cornell_glossy", "courtyard", "gallery", "spotlit")


def folder() -> Path:
    """`scenes` in `$LUMEL_SHARED`, or in `shared` beside the repository. Ends the program where there is none."""
    shared = Path(os.environ.get("LUMEL_SHARED", Path(__file__).resolve().parents[2] / "shared"))
    if not (shared / "scenes").is_dir():
        raise SystemExit(f"there are no reference scenes in {shared / 'scenes'}: set LUMEL_SHARED to the folder that holds them")
    return shared / "scenes"


def scene_file(name: str, out: Path) -> Path:
    """The file of a reference scene, of a generated one, which is written to `out`, or of one that is a file already."""
    if name in SCENES:
        return write(name, out)
    return Path(name) if name.endswith(".xml") else folder() / f"{name}.xml"


def matt(scene: Scene) -> Scene:
    """The scene without its gloss."""
    return replace(scene, materials={name: replace(m, specular=(0.0, 0.0, 0.0)) for name, m in scene.materials.items()})


def machine() -> str:
    """Processors that may be used, their name, and how busy they are with other work: numbers made at a load above 1 are too low."""
    return f"{processors()}; load before the start {load():.1f}"
