"""Errors that a user can act on: every problem of an input at once, each with its place."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing wrong with an input: `message` says what was found and what is allowed, `file` and `line` (1-based) say where."""

    message: str
    file: str | None = None
    line: int | None = None

    def __str__(self) -> str:
        place = ":".join(str(part) for part in (self.file, self.line) if part is not None)
        return f"{place}: {self.message}" if place else self.message


class LumelError(Exception):
    """Base of all errors that lumel raises on bad input; its text is one problem a line."""

    def __init__(self, problems: Sequence[Problem] | Problem | str) -> None:
        if isinstance(problems, str):
            problems = Problem(problems)
        self.problems: tuple[Problem, ...] = (problems,) if isinstance(problems, Problem) else tuple(problems)
        super().__init__("\n".join(str(problem) for problem in self.problems))


class SceneError(LumelError):
    """The scene cannot be read, or what it says cannot be rendered."""


class SettingsError(LumelError):
    """A render setting is out of its range, or names something that does not exist."""


class OutputError(LumelError):
    """A result cannot be written; nothing that was there before has been changed."""


def nearest(name: str, valid: Iterable[str]) -> str:
    """Say which names are valid and which of them is nearest to `name`, to end an error message with."""
    names = sorted(valid)
    close = difflib.get_close_matches(name, names, n=1)
    hint = f"did you mean '{close[0]}'? " if close else ""
    return f"{hint}allowed: {', '.join(names)}"
