"""Opens input files, and says well what is wrong with those that cannot be opened."""

from __future__ import annotations

import difflib
from pathlib import Path

from ..errors import SceneError

READABLE = (".obj", ".ply", ".stl", ".xml")  # endings that are worth a suggestion


def read_file(path: Path) -> bytes:
    """All bytes of a regular file. Raises SceneError that says why not, with the existing file name that is nearest."""
    try:
        reason = _reason(path)
        if not reason:
            return path.read_bytes()
    except OSError as error:
        reason = error.strerror or str(error)
    except ValueError as error:  # such as a null byte in the name
        reason = str(error)
    raise SceneError(f"cannot read '{path}': {reason}")


def _reason(path: Path) -> str:
    """Why there is nothing to open at `path`; '' where there is a file."""
    if path.is_dir():
        return "it is a directory, not a file"
    if path.is_file():
        return ""
    if path.exists():
        return "it is not a regular file"
    if not path.parent.is_dir():
        return f"there is no directory '{path.parent}'"
    names = sorted(entry.name for entry in path.parent.iterdir() if entry.is_file() and entry.suffix.lower() in READABLE)
    close = difflib.get_close_matches(path.name, names, n=1, cutoff=0.5)
    return f"no such file; did you mean '{path.parent / close[0]}'?" if close else "no such file"
