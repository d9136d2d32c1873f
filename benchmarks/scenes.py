"""Where the reference scenes are, and on what machine they are rendered."""

from __future__ import annotations

import os
from collections.abc import Mapping
from pathlib import Path

from lumel.images import read_picture
from lumel.scene import FloatArray

NAMES = ("bust", "cornell_glossy", "courtyard", "gallery", "spotlit")


def folder() -> Path:
    """`scenes` in `$LUMEL_SHARED`, or in `shared` beside the repository. Ends the program where there is none."""
    shared = Path(os.environ.get("LUMEL_SHARED", Path(__file__).resolve().parents[2] / "shared"))
    if not (shared / "scenes").is_dir():
        raise SystemExit(f"there are no reference scenes in {shared / 'scenes'}: set LUMEL_SHARED to the folder that holds them")
    return shared / "scenes"


def scene_file(name: str) -> Path:
    """The file of a reference scene, or of one that is a file already."""
    return Path(name) if name.endswith(".xml") else folder() / f"{name}.xml"


def reference_of(name: str) -> Mapping[str, FloatArray]:
    """Layers `rgb` and `stderr` of the first camera of a reference scene."""
    return read_picture(folder() / "reference" / f"{name}.exr").layers


def machine() -> str:
    """Processors that may be used, their name, and how busy they are with other work: numbers made at a load above 1 are too low."""
    lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    name = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), "unknown processor")
    return f"{len(os.sched_getaffinity(0))} threads of {name}; load before the start {os.getloadavg()[0]:.1f}"
