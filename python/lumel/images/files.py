"""Where pictures may be written: files whose ending names a format, in places that take them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from .. import files
from ..errors import LumelError, OutputError, Problem, nearest

ENDINGS = (".exr", ".png")


class ImageError(LumelError):
    """A picture cannot be read, or cannot be compared with another."""


def problem_with(path: Path) -> Problem | None:
    """Say why a picture could not be written to `path`, or None. Leaves no trace on the disk."""
    return files.problem_with_place(path) if path.suffix.lower() in ENDINGS else wrong_ending(path)


def wrong_ending(path: Path) -> Problem:
    """What to say of a path that ends in no picture format."""
    return Problem(f"cannot write '{path}': its ending '{path.suffix}' names no picture format; {nearest(path.suffix.lower(), ENDINGS)}")


def problems_with(paths: Sequence[Path]) -> list[Problem]:
    """Every reason why `paths` could not be written, to find out before any work is spent on them."""
    problems = [problem for path in paths if (problem := problem_with(path))]
    targets = [path.resolve() for path in paths]
    twice = {path for path, target in zip(paths, targets, strict=True) if targets.count(target) > 1}
    return problems + [Problem(f"cannot write '{path}' twice") for path in sorted(twice)]


def write_pictures(contents: Mapping[Path, bytes]) -> None:
    """Write every picture of `contents`, as `lumel.files.write_files` does.

    Raises OutputError, also for an ending that names no picture format; then no target has been changed.
    """
    if problems := problems_with(list(contents)):
        raise OutputError(problems)
    files.write_files(contents)
