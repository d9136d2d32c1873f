"""Collects what a reader finds wrong, so that all of it is reported at once."""

from __future__ import annotations

from ..errors import Problem, SceneError
from .tree import Node

_MOST_SHOWN = 100  # a broken file can have a problem on every line


class Findings:
    """Problems and notes of one scene, in the order they were found.

    `wrong` is for what no scene may contain; `unsupported` for what the format allows and lumel does not read, which a lenient reader
    leaves out and lists in the notes.
    """

    def __init__(self) -> None:
        self._problems: list[Problem] = []
        self._unsupported: list[Problem] = []
        self._notes: list[str] = []

    def wrong(self, message: str, node: Node | None = None) -> None:
        """Record an error at `node`."""
        self._problems.append(_problem(message, node))

    def unsupported(self, message: str, node: Node | None = None) -> None:
        """Record something that is not read: an error, or a note when lenient."""
        self._unsupported.append(_problem(message, node))

    def note(self, message: str, node: Node | None = None) -> None:
        """Record something worth saying that is no error."""
        self._notes.append(str(_problem(message, node)))

    def add(self, error: SceneError) -> None:
        """Record all problems of another error."""
        self._problems.extend(error.problems)

    def __len__(self) -> int:
        """How many problems there are so far."""
        return len(self._problems) + len(self._unsupported)

    def conclude(self, lenient: bool) -> tuple[str, ...]:
        """The notes for the scene. Raises SceneError with all problems, unsupported things among them unless `lenient`."""
        problems = self._problems if lenient else self._problems + self._unsupported
        unique = list(dict.fromkeys(problems))
        if unique:
            unique.sort(key=lambda problem: (problem.file or "", problem.line or 0))
            hidden = len(unique) - _MOST_SHOWN
            rest = [Problem(f"and {hidden} more problems")] if hidden > 0 else []
            raise SceneError(unique[:_MOST_SHOWN] + rest)
        return tuple(dict.fromkeys([*self._notes, *(f"ignored: {problem}" for problem in self._unsupported)]))


def _problem(message: str, node: Node | None) -> Problem:
    return Problem(message, node.file, node.line) if node else Problem(message)
