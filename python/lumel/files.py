"""Put finished files on the disk: all of them or none, and never half a file."""

from __future__ import annotations

import os
import secrets
from collections.abc import Mapping
from pathlib import Path

from .errors import OutputError, Problem


def problem_with_place(path: Path) -> Problem | None:
    """Say why no file could be written to `path`, or None. Leaves no trace on the disk."""
    try:
        return _problem_with_place(path)
    except OSError as error:  # a read-only disk, a name that is too long and the like
        return Problem(f"cannot write '{path}': {error.strerror}")


def _problem_with_place(path: Path) -> Problem | None:
    folder = path.resolve().parent
    if not folder.exists():
        return Problem(f"cannot write '{path}': the folder '{folder}' does not exist")
    if not folder.is_dir():
        return Problem(f"cannot write '{path}': '{folder}' is not a folder")
    if path.is_dir():
        return Problem(f"cannot write '{path}': it is a folder")
    if path.exists() and not os.access(path, os.W_OK):
        return Problem(f"cannot write '{path}': the file there is write-protected")
    # Only a real attempt tells the rest.
    attempt = _temporary(path)
    attempt.touch(exist_ok=False)
    attempt.unlink()
    return None


def write_files(contents: Mapping[Path, bytes]) -> None:
    """Write every file of `contents`: first all into temporary files beside their targets, then rename them.

    Raises OutputError (missing folder, no permission, disk full, ...); then no target has been changed.
    """
    if problems := [problem for path in contents if (problem := problem_with_place(path))]:
        raise OutputError(problems)
    staged: dict[Path, Path] = {}
    path = Path()
    try:
        for path, data in contents.items():
            staged[path] = temporary = _temporary(path)
            with temporary.open("xb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())  # a full disk must show here, not after the rename
        for path, temporary in staged.items():
            temporary.replace(path.resolve())
    except OSError as error:
        raise OutputError(f"cannot write '{path}': {error.strerror}; what was there before is unchanged") from error
    finally:
        for temporary in staged.values():
            temporary.unlink(missing_ok=True)


def _temporary(path: Path) -> Path:
    """A name beside the file that `path` means (links followed), so that the final rename stays on one disk."""
    target = path.resolve()
    return target.with_name(f".{target.name}.{secrets.token_hex(4)}.part")
